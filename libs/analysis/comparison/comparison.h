// SPDX-License-Identifier: Apache-2.0
// Compares configurations of one scene with one input with a reference: opening of the joints, energy drift, difference
// of the motion from the reference's, and cost.
//
// The reference is the same scene and communication step with short sub-steps: formulation recursive where the scene
// allows it, and the default integrator of scenes. A second one with twice its sub-step estimates its error: their
// difference is at least the error of any method of order one or more where the motion is smooth; near singular
// positions shorter steps may be worse, which the energies show. A row's difference below the estimate means only that.
//
// Energy (kinetic and potential, multibody/results/observe.h), relative to the largest kinetic energy of the reference:
//   kept      the reference keeps it: a row's drift is max |E(t) - E(0)|
//   compared  the scene is driven, loses energy or stores it elsewhere: a row's drift is max |E(t) - E_ref(t)|
// Coupling errors of H are equal in all rows; benchmarks and docs/coupling-results.md judge them.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/comparison/configuration.h"
#include "analysis/comparison/observation.h"

namespace slew::analysis {

// The chosen variables of one dimension.
struct VariableClass {
  std::string unit{};                  // SI
  std::vector<std::size_t> columns{};  // columns of Observation::values
  double extent = 0;                   // largest range of one of them in the reference
  double reference_error = 0;          // estimated: largest difference
  double reference_rms = 0;            // RMS of the same difference
};

struct Difference {
  double largest = 0;
  double rms = 0;  // over all samples and variables
};

struct ComparedRow {
  Configuration configuration{};
  std::string refusal{};  // why it cannot run; empty: it ran
  std::string failure{};  // how its run ended early; empty: it did not
  double failed_at = 0;
  multibody::JointGap gap{};
  std::string open_joint{};               // name of the most open joint
  std::optional<double> energy_drift{};   // none: nothing moves
  std::vector<Difference> differences{};  // by class
  std::optional<double> parted_at{};      // s, time from which the difference exceeds the extent of the motion
  double iterations = 0;                  // iterations of the port problem, mean of a step
  std::int64_t not_converged = 0;         // steps
  Cost cost{};
  StateHashes state_hashes{};  // at the end

  [[nodiscard]] bool has_run() const noexcept { return refusal.empty(); }
  [[nodiscard]] bool is_stable() const noexcept { return has_run() && failure.empty() && !parted_at; }
};

enum class EnergyRule { kept, compared };

struct Comparison {
  std::string scene;
  double until = 0;               // s
  double communication_step = 0;  // s
  bool has_hydraulics = false;
  int repeats = 0;
  Configuration reference;
  double reference_energy_drift = 0;  // relative to E(0)
  EnergyRule energy_rule = EnergyRule::kept;
  double largest_kinetic_energy = 0;  // J, in the reference
  std::vector<std::string> variables;
  std::vector<VariableClass> classes;
  std::vector<ComparedRow> rows;
  std::size_t wanted_rows = 0;  // more than there are rows: interrupted
};

// Receives the present activity and the share of all work that is done; false ends the comparison with the finished
// rows.
using Progress = std::function<bool(std::string_view doing, double share)>;

// Throws LoadError for a wrong scene, Failure for options that cannot be met or a reference that fails.
[[nodiscard]] Comparison compare(const ComparisonOptions& options, const Progress& progress);

// Largest and mean-square difference of one class; samples that one of the two lacks are left out.
[[nodiscard]] Difference difference(const Observation& run, const Observation& reference, const VariableClass& of);

}  // namespace slew::analysis
