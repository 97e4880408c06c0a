// SPDX-License-Identifier: Apache-2.0
#include "gateway/live_parameters.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "scene/field_reader.h"

namespace slew::gateway {
namespace {

std::string range_of(const scene::ParameterInfo& parameter) {
  return parameter.is_choice() ? scene::choice_list(parameter.choices)
                               : scene::range_text(parameter.range, parameter.dimension);
}

}  // namespace

LiveParameters::LiveParameters(const scene::Scene& scene, Requests& requests, Changed changed)
    : directory_(scene), requests_(requests), changed_(std::move(changed)) {
  for (const scene::ParameterInfo& parameter : directory_.all()) {
    if (parameter.change == Change::live) live_.insert({parameter.path, {&parameter, parameter.value, kJoinStep}});
  }
  refresh();
}

Json LiveParameters::to_json(const Present& present) const {
  const scene::ParameterInfo& parameter = *present.about;
  Json json = {{"name", parameter.path},
               {"unit", info(parameter.dimension).si_unit},
               {"range", range_of(parameter)},
               {"doc", parameter.doc}};
  if (parameter.is_choice()) {
    json["value"] = parameter.choice_of(present.value);
    json["choices"] = std::vector<std::string>(parameter.choices.begin(), parameter.choices.end());
  } else {
    json["value"] = present.value;
    json["type"] = "float64";
    if (std::isfinite(parameter.range.min)) json["minimum"] = parameter.range.min;
    if (std::isfinite(parameter.range.max)) json["maximum"] = parameter.range.max;
  }
  if (present.step >= 0) json["step"] = present.step;
  return json;
}

Json LiveParameters::values(const std::vector<std::string>& names) const {
  Json list = Json::array();
  if (names.empty()) {
    for (const auto& [path, present] : live_) list.push_back(to_json(present));
  }
  for (const std::string& name : names) {
    if (const auto found = live_.find(name); found != live_.end()) list.push_back(to_json(found->second));
  }
  return list;
}

void LiveParameters::set(const std::string& name, const std::variant<double, std::string>& value,
                         std::optional<SimDuration> over, Requests::Owner owner, const Done& done,
                         std::int64_t now_ns) {
  const auto* const text = std::get_if<std::string>(&value);
  constexpr auto kBeside = scene::Beside::session;
  const scene::Assignment assignment = text != nullptr ? directory_.parse_assignment(name + "=" + *text, over, kBeside)
                                                       : directory_.check(name, std::get<double>(value), over, kBeside);
  if (!assignment.status.is_ok()) return done(assignment.status.text, kJoinStep);
  wire::ControlRequest request;
  request.action = wire::ControlAction::set_parameter;
  request.path = assignment.path;
  request.value = assignment.value;
  request.over_ns = assignment.over.ns;
  requests_.send(
      request, owner,
      [this, path = assignment.path, target = assignment.value, done](const Requests::Answer& answer) {
        if (answer.is_accepted) take_value(path, target, answer.step);
        done(answer.is_accepted ? "" : answer.reason, answer.step);
      },
      now_ns);
}

void LiveParameters::take_value(const std::string& name, double value, StepIndex step) {
  const auto found = live_.find(name);
  if (found == live_.end()) return;
  const bool is_other = found->second.value != value;
  found->second.value = value;
  found->second.step = step;
  if (is_other) changed_(name);
}

void LiveParameters::refresh() {
  to_request_.clear();
  for (const auto& [path, present] : live_) to_request_.push_back(path);
}

// "set Bag.mass to 1500 over 1 s" (node/identity.h)
void LiveParameters::take(const wire::ControlReply& reply) {
  constexpr std::string_view kSet = "set ";
  if (!reply.is_accepted || !reply.asked.starts_with(kSet)) return;
  const std::string path = reply.asked.substr(kSet.size(), reply.asked.find(' ', kSet.size()) - kSet.size());
  if (live_.contains(path) && std::ranges::find(to_request_, path) == to_request_.end()) to_request_.push_front(path);
}

void LiveParameters::poll(std::int64_t now_ns) {
  while (!to_request_.empty() && requests_.waiting_of(Requests::kGateway) < Requests::kMostOfOwner) {
    wire::ControlRequest request;
    request.action = wire::ControlAction::get_parameter;
    request.path = to_request_.front();
    to_request_.pop_front();
    requests_.send(
        request, Requests::kGateway,
        [this, path = request.path](const Requests::Answer& answer) {
          if (answer.is_accepted) take_value(path, answer.value, answer.step);
        },
        now_ns);
  }
}

}  // namespace slew::gateway
