// SPDX-License-Identifier: Apache-2.0
// The services: calls of clients, and their answers.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/failure.h"
#include "gateway/body_shapes.h"
#include "gateway/gateway.h"

namespace slew::gateway {
namespace {

constexpr double kLongestChange = 3600;  // s
constexpr double kLongestSession = 1e9;  // s
constexpr std::int64_t kMostSteps = 1'000'000'000;
constexpr std::size_t kMostCurves = 32;  // of a request
constexpr std::int64_t kMostValues = 200'000;

const char* to_text(PlaybackStatus status) noexcept {
  switch (status) {
    case PlaybackStatus::playing:
      return "playing";
    case PlaybackStatus::paused:
      return "paused";
    case PlaybackStatus::buffering:
      return "buffering";
    case PlaybackStatus::ended:
      return "ended";
  }
  return "";
}

std::optional<SimDuration> over_of(const Json& request) {
  const Json* over = request.find("over");
  if (over == nullptr) return std::nullopt;
  const double seconds = over->number();
  if (!(seconds >= 0 && seconds <= kLongestChange))
    throw Failure(ExitCode::bad_input, "'over' is not from 0 to 3600 s; nothing was changed");
  return duration_of_seconds(seconds);
}

}  // namespace

void Gateway::fail(const CallPlace& place, const std::string& message) {
  if (const auto client = clients_.find(place.client); client != clients_.end())
    push(client->second, text_frame(service_failure_text(place.service, place.call, message)));
}

void Gateway::respond(const CallPlace& place, const Json& response) {
  if (const auto client = clients_.find(place.client); client != clients_.end())
    push(client->second, binary_frame(service_response_bytes(place.service, place.call, response)));
}

void Gateway::respond(const CallPlace& place, const std::string& problem, StepIndex step) {
  respond(place, Json({{"accepted", problem.empty()}, {"step", step}, {"reason", problem}}));
}

void Gateway::take(ClientId id, Client&, const ServiceCall& message, std::int64_t now_ns) {
  const CallPlace place{id, message.service, message.call};
  const auto service = std::ranges::find(services_, message.service, &ServiceInfo::id);
  if (service == services_.end())
    return fail(place, "there is no service of this number; advertiseServices lists them");
  if (message.encoding != "json") return fail(place, "the encoding of the call is not json");
  const DecodedObject decoded = decode_object(message.bytes);
  if (!decoded.object) return fail(place, decoded.problem);
  try {
    run_call(place, static_cast<Call>(message.service), *decoded.object, now_ns);
  } catch (const Failure& failure) {  // a member is missing, or of another kind
    fail(place, failure.what());
  }
}

void Gateway::run_call(const CallPlace& place, Call call, const Json& request, std::int64_t now_ns) {
  using Acquire = observer::InputLeases::Acquire;
  const auto answer = [this, place](const std::string& problem) { respond(place, problem, newest_step_); };
  switch (call) {
    case Call::pause:
      if (def_.playback != nullptr) return play(place, {.is_paused = true, .speed = 0}, now_ns);
      return control(place, wire::ControlAction::pause, 0, now_ns);
    case Call::resume:
      return control(place, wire::ControlAction::resume, 0, now_ns);
    case Call::step: {
      const std::int64_t steps = request.find("steps") != nullptr ? request.at("steps").integer() : 1;
      if (steps < 1 || steps > kMostSteps)
        return fail(place, "'steps' is not from 1 to 1000000000; nothing was changed");
      return control(place, wire::ControlAction::step, static_cast<double>(steps), now_ns);
    }
    case Call::reset:
      return control(place, wire::ControlAction::reset, 0, now_ns);
    case Call::set_parameter: {
      const Json& value = request.at("value");
      const auto wanted = value.is_number() ? std::variant<double, std::string>(value.number())
                                            : std::variant<double, std::string>(value.text());
      return parameters_.set(
          request.at("name").text(), wanted, over_of(request), place.client,
          [this, place](const std::string& problem, StepIndex step) { respond(place, problem, step); }, now_ns);
    }
    case Call::save:
    case Call::load:
      return keep(place, call, request.at("name").text());
    case Call::lease: {
      const Json* take_over = request.find("take_over");
      const auto acquire = take_over != nullptr && take_over->boolean() ? Acquire::take_over : Acquire::free;
      const std::string problem = inputs_.lease(place.client, request.at("input").text(), acquire, answer, now_ns);
      if (!problem.empty()) answer(problem);
      return;
    }
    case Call::release:
      return answer(inputs_.release(place.client, request.at("input").text()));
    case Call::play:
      return play(place, {.is_paused = false, .speed = 0}, now_ns);
    case Call::speed: {
      PlaybackControl wanted;
      wanted.is_paused = def_.playback->state(now_ns).status != PlaybackStatus::playing;
      wanted.speed = static_cast<float>(request.at("factor").number());
      // play() keeps the present one for 0
      if (wanted.speed == 0) return fail(place, "'factor' is not from 0.01 to 100; nothing was changed");
      return play(place, wanted, now_ns);
    }
    case Call::seek: {
      const double seconds = request.at("time").number();
      if (!(seconds >= 0 && seconds < 9e9))
        return fail(place, "'time' is no time of the recording; nothing was changed");
      PlaybackControl wanted{.is_paused = def_.playback->state(now_ns).status != PlaybackStatus::playing, .speed = 0};
      wanted.seek_ns = static_cast<std::uint64_t>(std::llround(seconds * 1e9));
      return play(place, wanted, now_ns);
    }
    case Call::curves:
      return read_curves(place, request);
    case Call::take_over:
      return take_over(place, request);
  }
}

void Gateway::read_curves(const CallPlace& place, const Json& request) {
  if (def_.curves == nullptr) return fail(place, "this window has no curves of its recording; nothing was read");
  CurvesRequest wanted;
  wanted.names = request.at("names").texts();
  wanted.from = request.at("from").number();
  wanted.to = request.at("to").number();
  if (wanted.names.empty() || wanted.names.size() > kMostCurves)
    return fail(place, "'names' are not 1 to 32 variables; nothing was read");
  if (!(wanted.from >= 0 && wanted.from <= wanted.to && wanted.to <= kLongestSession))
    return fail(place, "'from' and 'to' are no times of a recording; nothing was read");
  if (const Json* most = request.find("most")) {
    if (most->integer() < 2 || most->integer() > kMostValues)
      return fail(place, "'most' is not from 2 to 200000; nothing was read");
    wanted.most_values = static_cast<std::size_t>(most->integer());
  }
  if (const Json* recording = request.find("recording")) {
    if (recording->integer() < 0 || recording->integer() >= static_cast<std::int64_t>(def_.curves->names().size()))
      return fail(place, "'recording' is no number of a recording of this window; nothing was read");
    wanted.recording = static_cast<std::size_t>(recording->integer());
  }
  def_.curves->read(std::move(wanted), [this, place](RecordedCurves::Answer answer) {
    respond(place, Json({{"accepted", answer.problem.empty()},
                         {"reason", answer.problem},
                         {"unknown", answer.unknown},
                         {"samples", answer.samples},
                         {"curves", std::move(answer.curves)}}));
  });
}

void Gateway::take_over(const CallPlace& place, const Json& request) {
  ContinuationRequest wanted;
  wanted.time = request.at("time").number();
  const double end = def_.range ? static_cast<double>(def_.range->to_ns) * 1e-9 : 0;
  if (!(wanted.time >= 0 && wanted.time <= end))
    return fail(place, "'time' is no time of the recording; nothing was started");
  const std::string input = request.text_or("input", "none");
  if (input != "none" && input != "script") return fail(place, "'input' is not none or script; nothing was started");
  if (input == "script") wanted.input = ContinuationInput::script;
  if (const Json* duration = request.find("duration")) wanted.duration = duration->number();
  if (!(wanted.duration >= 0 && wanted.duration <= kLongestSession))
    return fail(place, "'duration' is no time from 0 to 1e9 s; nothing was started");
  def_.continuation->start(wanted, [this, place](const Continuation::Answer& answer) {
    respond(place, Json({{"accepted", answer.problem.empty()},
                         {"reason", answer.problem},
                         {"session", answer.session},
                         {"page", answer.page},
                         {"foxglove", answer.foxglove}}));
  });
}

void Gateway::keep(const CallPlace& place, Call call, const std::string& name) {
  if (!is_plain_name(name)) {
    return fail(place, "'name' is not of 1 to 63 letters, digits, '_' and '-'; nothing was done; choose another");
  }
  if (def_.saved == nullptr) return fail(place, "this window has no folder for saved states; nothing was done");
  const auto done = [this, place](const std::string& problem, StepIndex step) { respond(place, problem, step); };
  call == Call::save ? def_.saved->save(name, done) : def_.saved->load(name, done);
}

void Gateway::control(const CallPlace& place, wire::ControlAction action, double value, std::int64_t now_ns) {
  wire::ControlRequest request;
  request.action = action;
  request.value = value;
  requests_.send(
      request, place.client,
      [this, place](const Requests::Answer& answer) {
        respond(place, answer.is_accepted ? "" : answer.reason, answer.step);
      },
      now_ns);
}

// A speed of 0 keeps the present one.
void Gateway::play(const CallPlace& place, const PlaybackControl& request, std::int64_t now_ns) {
  PlaybackControl wanted = request;
  if (wanted.speed == 0) wanted.speed = def_.playback->state(now_ns).speed;
  const Status status = def_.playback->control(wanted, now_ns);
  if (!status.is_ok()) return fail(place, status.text);
  const PlaybackState state = def_.playback->state(now_ns);
  respond(place, Json({{"status", to_text(state.status)},
                       {"time", static_cast<double>(state.time_ns) * 1e-9},
                       {"speed", static_cast<double>(state.speed)}}));
  publish_playback(now_ns);
}

// ---- /session.json

Json Gateway::description(const observer::SessionView& view) const {
  Json variables = Json::array(), inputs = Json::array(), calls = Json::array(), graphics = Json::array();
  for (const observer::VariableView* variable : view.variables())
    variables.push_back({{"name", variable->name}, {"unit", variable->unit}});
  for (const InputChannel& input : inputs_.channels()) {
    inputs.push_back({{"name", input.name},
                      {"topic", "/inputs/" + input.name},
                      {"is_digital", input.is_digital},
                      {"is_lockstep", input.is_lockstep}});
  }
  for (const scene::GraphicDef& graphic : scene_.graphics) {
    const std::string name = asset_name(graphic);
    if (!def_.assets.contains(name)) continue;
    const math::Quaternion orientation = math::quaternion_of(math::rotation_zxz(graphic.orientation));
    graphics.push_back({{"name", graphic.name},
                        {"body", graphic.body},
                        {"path", "/assets/" + name},
                        {"pose", pose_json(math::Vec3(graphic.position), orientation)}});
  }
  for (const ServiceInfo& service : services_) calls.push_back({{"name", service.name}, {"request", service.request}});
  return {{"session", def_.name},
          {"scene", scene_.name},
          {"is_recording", def_.playback != nullptr},
          {"recordings", def_.curves != nullptr ? Json(def_.curves->names()) : Json::array()},
          {"may_steer", is_steering()},
          {"variables", std::move(variables)},
          {"inputs", std::move(inputs)},
          {"services", std::move(calls)},
          {"graphics", std::move(graphics)},
          {"parameters", is_steering() ? parameters_.values({}) : Json::array()}};
}

}  // namespace slew::gateway
