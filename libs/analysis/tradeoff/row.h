// SPDX-License-Identifier: Apache-2.0
// One run of a tradeoff in a process of its own: the cost of a setting, and its distance from the reference.
//
// The reference of a row is the whole scene as one system (libs/monolith) in the same communication step: the input is
// held alike in both, so that the difference comes from coupling, integrators and left-out parts. Where the monolith
// cannot run (shapes that touch) it is the split scene in a sixteenth of the step with tight tolerances. Both have the
// same variables at the same instants.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/comparison/observation.h"
#include "core/json.h"
#include "scene/scene_options.h"

namespace slew::analysis {

enum class RunKind { row, reference };

struct RowJob {
  scene::SceneOptions scene;           // with the row's settings
  std::vector<std::string> variables;  // names
  RunKind kind = RunKind::row;
  double row_step = 0;     // s, communication step of the row; a reference has that of its row
  std::string samples;     // file of the reference's samples: written by a reference, read by a row
  int repeats = 3;         // timed runs
  double time_limit = 60;  // s of wall time for one run
};

// Error over the samples that both have.
struct VariableError {
  double largest = 0, rms = 0;
  bool operator==(const VariableError&) const = default;
};

// Microseconds per simulated millisecond of all physics in one process; each step at the fastest of the runs.
struct StepCost {
  double median = 0, mean = 0, worst = 0;
  bool operator==(const StepCost&) const = default;
};

struct RowResult {
  std::string refusal{};                               // why it cannot run; empty: it ran
  std::string failure{};                               // how it ended early; empty: it did not
  double failed_at = 0;                                // s
  std::vector<std::optional<VariableError>> errors{};  // by variable; none: the row has no such variable
  std::optional<double> eta{}, net{};                  // worst of all ports; none: no ports
  double gap = 0;                                      // joints, m or rad
  std::string open_joint{};                            // name of the most open joint
  std::int64_t not_converged = 0;                      // steps
  StepCost cost{};
  // of a reference only
  std::vector<double> low{}, high{};  // range of each variable
  bool operator==(const RowResult&) const = default;
};

// Instants that rows and reference of one communication step share.
[[nodiscard]] SimDuration sample_interval(SimDuration H, SimDuration until) noexcept;

// Runs it; wrong input and failures become refusal and failure. Throws Failure for files alone.
[[nodiscard]] RowResult compute(const RowJob& job);

[[nodiscard]] Json to_json(const RowJob& job);
[[nodiscard]] RowJob job_from(const Json& json);
[[nodiscard]] Json to_json(const RowResult& result);
[[nodiscard]] RowResult result_from(const Json& json);

// Median, mean and largest of the steps' times [ns], as a cost for steps of H.
[[nodiscard]] StepCost cost_of(std::vector<std::int64_t> step_ns, SimDuration H);

}  // namespace slew::analysis
