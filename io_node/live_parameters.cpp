// SPDX-License-Identifier: Apache-2.0
#include "io_node/live_parameters.h"

#include <algorithm>
#include <cmath>

namespace slew::io_node {

LiveParameters::LiveParameters(const std::vector<LiveParameter>& parameters, SimDuration step)
    : scene_(parameters), ramps_(parameters.size()), step_(step) {
  for (const LiveParameter& parameter : scene_) {
    index_.emplace(parameter.path, static_cast<int>(values_.size()));
    values_.push_back(parameter.value);
  }
}

int LiveParameters::find(std::string_view path) const noexcept {
  const auto found = index_.find(path);
  return found == index_.end() ? -1 : found->second;
}

std::vector<std::pair<std::string, double>> LiveParameters::all() const {
  std::vector<std::pair<std::string, double>> values;
  for (std::size_t i = 0; i < scene_.size(); ++i) values.emplace_back(scene_[i].path, values_[i]);
  return values;
}

std::vector<scene::LiveChange> LiveParameters::under_way(StepIndex n) const {
  std::vector<scene::LiveChange> changes;
  ramps_.follow(n, [&](int parameter, double to, StepIndex steps) {
    changes.push_back({scene_[static_cast<std::size_t>(parameter)].path, to, n, steps});
  });
  return changes;
}

void LiveParameters::begin(const wire::Command& command, StepIndex n) noexcept {
  const int parameter = find(command.path);
  if (parameter >= 0) ramps_.begin(parameter, value(parameter), command.value, n, {command.over_ns}, step_);
}

void LiveParameters::advance(StepIndex n) noexcept {
  ramps_.apply(n, [this](int parameter, double value) { values_[static_cast<std::size_t>(parameter)] = value; });
}

void LiveParameters::save(StateWriter& bytes) const {
  bytes.numbers(std::span<const double>(values_));
  ramps_.save(bytes);
}

void LiveParameters::load(StateReader& bytes) noexcept {
  bytes.numbers(std::span<double>(values_));
  if (!std::all_of(values_.begin(), values_.end(), [](double value) { return std::isfinite(value); })) bytes.refuse();
  ramps_.load(bytes,
              [this](int parameter) { return parameter >= 0 && static_cast<std::size_t>(parameter) < values_.size(); });
}

void LiveParameters::reset() noexcept {
  ramps_.clear();
  std::ranges::transform(scene_, values_.begin(), &LiveParameter::value);
}

}  // namespace slew::io_node
