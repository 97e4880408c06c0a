// SPDX-License-Identifier: Apache-2.0
// One row of a parameter sweep, computed in a process of its own: its measures, or how it failed, and the fingerprint
// of the program and machine that computed it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/json.h"
#include "core/status.h"
#include "scene/scene_options.h"

namespace slew::analysis {

// What all rows of a sweep share.
struct SweepJob {
  scene::SceneOptions scene;
  std::vector<std::string> measures;
};

// Rows with equal fingerprints of equal scenes are equal bit for bit.
struct Fingerprint {
  std::string build;      // build id of the program, with compiler and instruction set
  std::string self_test;  // arithmetic_self_test(), hexadecimal
  bool operator==(const Fingerprint&) const = default;
};
[[nodiscard]] Fingerprint own_fingerprint();

struct RowOutcome {
  ExitCode code = ExitCode::ok;  // of a run of the scene alone: bad_input for a refused scene, diverged, ...
  std::string message{};         // of a code other than ok
  std::vector<std::optional<double>> values{};  // SI, by measure; none in a row that failed
  std::int64_t steps = 0, not_converged = 0;
  std::string state_hash{};  // of the state at the end, hexadecimal
  Fingerprint fingerprint{};
  bool operator==(const RowOutcome&) const = default;
};

// Runs the job's scene with further settings. Wrong input and failures of the run become code and message.
[[nodiscard]] RowOutcome run_row(const SweepJob& job, const scene::Overrides& settings);

[[nodiscard]] Json to_json(const SweepJob& job);
[[nodiscard]] SweepJob sweep_job_from(const Json& json);
[[nodiscard]] Json to_json(const RowOutcome& outcome);
[[nodiscard]] RowOutcome row_outcome_from(const Json& json);

}  // namespace slew::analysis
