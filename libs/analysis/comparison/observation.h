// SPDX-License-Identifier: Apache-2.0
// One run of a scene: its samples at the instants that all runs of a comparison share, and its cost.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "analysis/comparison/played_scene.h"
#include "core/time.h"
#include "multibody/joints/joint_gauge.h"
#include "scene/scene.h"

namespace slew::analysis {

// Called with the share of the run that is done, 0 to 1; false ends it.
using GoesOn = std::function<bool(double share)>;

struct Observation {
  SimDuration sample;                 // sample i is at i times this
  std::size_t variables = 0;          // values of a sample
  std::vector<double> values;         // samples x variables; a run in longer steps leaves samples out: NaN
  std::vector<double> energy;         // J, kinetic and potential, by sample; NaN without a mechanism of its own
  double largest_kinetic_energy = 0;  // J
  multibody::JointGap gap;            // largest of all samples
  StepIndex steps = 0;                // done
  std::int64_t iterations = 0;        // iterations of the mechanics' port problem, all steps
  std::int64_t not_converged = 0;     // steps of either side
  std::string failure;                // how it ended early; empty: it did not
  double failed_at = 0;               // s
  StateHashes state_hashes;           // at the end
  bool is_interrupted = false;

  [[nodiscard]] std::size_t samples() const noexcept { return energy.size(); }
};

// Runs the scene to the time `until`. Throws Failure when it has no start state, or no such variable.
[[nodiscard]] Observation observe_run(const scene::Scene& scene, std::span<const std::string> variables,
                                      SimDuration until, SimDuration sample, const GoesOn& goes_on);

// Microseconds per simulated millisecond. All runs do the same work, so that of each step the fastest run is taken: it
// excludes other load of the machine.
struct Cost {
  double mechanics = 0;             // mean of all steps
  double mechanics_slowest = 0;     // the slowest step
  double whole = 0;                 // all physics, mean of all steps
  double mechanics_run_median = 0;  // median of the runs' wall times, interruptions included
  double whole_run_median = 0;
  bool is_repeatable = true;  // every run ended in the same state, bit for bit
  bool is_interrupted = false;
};

constexpr int kMostTimedRuns = 1000;

// Repeats the same scene and reads only the clock between the steps.
[[nodiscard]] Cost time_runs(const scene::Scene& scene, StepIndex steps, int repeats, const StateHashes& state_hashes,
                             const GoesOn& goes_on);

}  // namespace slew::analysis
