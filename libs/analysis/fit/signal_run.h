// SPDX-License-Identifier: Apache-2.0
// One run of a fit in a process of its own: signals of the scene at the instants of the measured ones.
#pragma once

#include <string>
#include <vector>

#include "core/json.h"
#include "core/status.h"
#include "scene/scene_options.h"

namespace slew::analysis {

struct SignalJob {
  scene::SceneOptions scene;               // with the settings of the row
  std::vector<std::string> expressions;    // of variables, by signal
  std::vector<std::vector<double>> times;  // s, ascending, by signal
};

struct SignalOutcome {
  ExitCode code = ExitCode::ok;
  std::string message{};
  std::vector<double> values{};  // SI: all instants of the first signal, then of the second; linear between steps
};

// Wrong input and failures of the run become code and message.
[[nodiscard]] SignalOutcome run_signals(const SignalJob& job);

[[nodiscard]] Json to_json(const SignalJob& job);
[[nodiscard]] SignalJob signal_job_from(const Json& json);
[[nodiscard]] Json to_json(const SignalOutcome& outcome);
[[nodiscard]] SignalOutcome signal_outcome_from(const Json& json);

}  // namespace slew::analysis
