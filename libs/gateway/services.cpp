// SPDX-License-Identifier: Apache-2.0
#include "gateway/services.h"

#include <array>
#include <utility>

namespace slew::gateway {
namespace {

constexpr std::array kSessionCalls = {Call::pause, Call::resume, Call::step,  Call::reset,  Call::set_parameter,
                                      Call::save,  Call::load,   Call::lease, Call::release};
constexpr std::array kContinuedCalls = {Call::play, Call::pause,  Call::speed,
                                        Call::seek, Call::curves, Call::take_over};

Json member(const char* type, const char* description) {
  return {{"type", type}, {"description", description}};
}

Json object_schema(Json properties, const std::vector<std::string>& required = {}) {
  return {{"type", "object"}, {"properties", std::move(properties)}, {"required", required}};
}

Json answer_schema() {
  return object_schema({{"accepted", member("boolean", "")},
                        {"step", member("integer", "first step with the change; -1: none")},
                        {"reason", member("string", "of a refusal")}});
}

Json playback_schema() {
  return object_schema({{"status", member("string", "playing, paused or ended")},
                        {"time", member("number", "s")},
                        {"speed", member("number", "over real time")}});
}

Json continuation_schema() {
  return object_schema({{"accepted", member("boolean", "")},
                        {"reason", member("string", "of a refusal")},
                        {"session", member("string", "name of the live session")},
                        {"page", member("string", "address of its window")},
                        {"foxglove", member("string", "the same for the protocol")}});
}

Json curves_schema() {
  const Json numbers = {{"type", "array"}, {"items", {{"type", "number"}}}};
  const Json names = {{"type", "array"}, {"items", {{"type", "string"}}}};
  Json curve = object_schema({{"name", member("string", "of the variable")},
                              {"unit", member("string", "SI")},
                              {"times", numbers},
                              {"values", numbers}});
  return object_schema({{"accepted", member("boolean", "")},
                        {"reason", member("string", "of a refusal")},
                        {"unknown", names},
                        {"samples", member("integer", "whose least and largest values are there; 1: all samples are")},
                        {"curves", {{"type", "array"}, {"items", std::move(curve)}}}});
}

Json response_schema(Call call) {
  if (call == Call::take_over) return continuation_schema();
  return call == Call::curves ? curves_schema() : playback_schema();
}

ServiceInfo info_of(Call call) {
  const auto make = [&](const char* name, Json request) {
    return ServiceInfo{static_cast<std::uint32_t>(call), name, std::move(request), answer_schema()};
  };
  switch (call) {
    case Call::pause:
      return make("pause", object_schema(Json::object()));
    case Call::resume:
      return make("resume", object_schema(Json::object()));
    case Call::step:
      return make("step", object_schema({{"steps", member("integer", "1 without it")}}));
    case Call::reset:
      return make("reset", object_schema(Json::object()));
    case Call::set_parameter:
      return make("set_parameter",
                  object_schema({{"name", member("string", "Element.key")},
                                 {"value", member("number", "SI; or a text such as 1500kg")},
                                 {"over", member("number", "s, over which the change is spread; without it its own")}},
                                {"name", "value"}));
    case Call::save:
      return make("save", object_schema({{"name", member("string", "of the file in the window's folder")}}, {"name"}));
    case Call::load:
      return make("load", object_schema({{"name", member("string", "of a file that was saved")}}, {"name"}));
    case Call::lease:
      return make("lease", object_schema({{"input", member("string", "")},
                                          {"take_over", member("boolean", "also from its holder, for its supervisor")}},
                                         {"input"}));
    case Call::release:
      return make("release", object_schema({{"input", member("string", "")}}, {"input"}));
    case Call::play:
      return make("play", object_schema(Json::object()));
    case Call::speed:
      return make("speed", object_schema({{"factor", member("number", "over real time, 0.01 to 100")}}, {"factor"}));
    case Call::seek:
      return make("seek", object_schema({{"time", member("number", "s")}}, {"time"}));
    case Call::curves:
      return make(
          "curves",
          object_schema({{"names", {{"type", "array"}, {"items", member("string", "of a variable")}}},
                         {"from", member("number", "s")},
                         {"to", member("number", "s")},
                         {"most", member("integer", "values of a curve, 2 to 200000; 4000 without it")},
                         {"recording", member("integer", "number among the recordings of the window; 0 without it")}},
                        {"names", "from", "to"}));
    case Call::take_over:
      return make(
          "take_over",
          object_schema({{"time", member("number", "s, of the recording")},
                         {"input", member("string", "none (as without it), or script: the recorded scene's")},
                         {"duration", member("number", "s, end of the session's time; 0, as without it: none")}},
                        {"time"}));
  }
  return {};
}

}  // namespace

bool is_plain_name(std::string_view name) noexcept {
  constexpr std::size_t kLongest = 63;
  return !name.empty() && name.size() <= kLongest &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") ==
             std::string_view::npos;
}

std::span<const Call> session_calls() noexcept {
  return kSessionCalls;
}

std::span<const Call> recording_calls() noexcept {
  return std::span(kContinuedCalls).first<kContinuedCalls.size() - 1>();
}

std::span<const Call> continued_calls() noexcept {
  return kContinuedCalls;
}

std::vector<ServiceInfo> service_infos(std::span<const Call> calls) {
  std::vector<ServiceInfo> infos;
  const bool is_recording = calls.data() == kContinuedCalls.data();
  for (const Call call : calls) {
    infos.push_back(info_of(call));
    if (is_recording) infos.back().response = response_schema(call);
  }
  return infos;
}

}  // namespace slew::gateway
