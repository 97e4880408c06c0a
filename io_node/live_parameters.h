// SPDX-License-Identifier: Apache-2.0
// Present values of the parameters that may change while the session runs.
//
// The changes take the same steps as in the nodes that apply them (coupling/parameter_ramps.h), so that io_node can
// publish the values that the nodes compute with at any time, also while the session is paused.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/state_bytes.h"
#include "core/time.h"
#include "coupling/parameter_ramps.h"
#include "scene/live_course.h"
#include "transport/wire.h"

namespace slew::io_node {

struct LiveParameter {
  std::string path;  // "Bag.mass"
  double value = 0;  // SI, in the scene
};

class LiveParameters {
 public:
  LiveParameters(const std::vector<LiveParameter>& parameters, SimDuration step);

  // Index by path; -1: none.
  [[nodiscard]] int find(std::string_view path) const noexcept;
  // SI, at the step of the last advance().
  [[nodiscard]] double value(int parameter) const noexcept { return values_[static_cast<std::size_t>(parameter)]; }
  [[nodiscard]] bool is_changing(int parameter) const noexcept { return ramps_.is_under_way(parameter); }

  // All values, at the step of the last advance().
  [[nodiscard]] std::vector<std::pair<std::string, double>> all() const;
  // The rest of each change under way, from step n on.
  [[nodiscard]] std::vector<scene::LiveChange> under_way(StepIndex n) const;

  // A change in the tick of step n.
  void begin(const wire::Command& command, StepIndex n) noexcept;
  // The values with which the nodes compute step n.
  void advance(StepIndex n) noexcept;
  // As in the scene.
  void reset() noexcept;
  // Another set of the same parameters, as in the scene.
  [[nodiscard]] LiveParameters fresh() const { return {scene_, step_}; }
  void save(StateWriter& bytes) const;
  void load(StateReader& bytes) noexcept;

 private:
  std::map<std::string, int, std::less<>> index_;
  std::vector<LiveParameter> scene_;
  std::vector<double> values_;
  coupling::ParameterRamps ramps_;
  SimDuration step_;
};

}  // namespace slew::io_node
