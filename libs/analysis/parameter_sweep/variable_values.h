// SPDX-License-Identifier: Apache-2.0
// The variables of a run in this process and their values: those of the physics nodes, then raw value, control value
// and age of every input, as `slewring variables SCENE` lists them and a recording has them. An input's loop_delay and
// loop_time_ms are left out: they belong to a controller, which no such run has.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analysis/comparison/played_scene.h"
#include "core/element_variable.h"
#include "scene/scene.h"

namespace slew::analysis {

// session: of this scene.
[[nodiscard]] std::vector<ElementVariable> variables_of_run(const scene::Scene& scene,
                                                            const session::DirectSession& session);

class VariableValues {
 public:
  // The run must outlive it.
  explicit VariableValues(const PlayedScene& played);

  // Values now, SI, in the order of variables_of_run(); valid until the next call.
  [[nodiscard]] std::span<const double> read();

  // Of the last step.
  [[nodiscard]] bool has_failed() const noexcept;
  [[nodiscard]] bool has_converged() const noexcept;

 private:
  const PlayedScene& played_;
  std::vector<double> values_;
};

}  // namespace slew::analysis
