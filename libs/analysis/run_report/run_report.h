// SPDX-License-Identifier: Apache-2.0
// The summary of a run: how it went, what it cost, how good the coupling was, and where everything is.
#pragma once

#include <string>
#include <vector>

#include "core/json.h"
#include "scene/scene.h"
#include "session/run.h"

namespace slew::analysis {

struct NodeReport {
  std::string role;
  observer::StepTimes times;
  std::uint64_t resends_asked = 0;
  std::uint64_t resends_answered = 0;
  std::uint64_t refused_messages = 0;
  wire::Health health;  // the last one: what its steps took
};

struct PortReport {
  std::string name;
  double eta = 0;  // largest energy residual
  double net = 0;  // lowest net energy
  std::string lamp;
  std::string meaning;  // of a lamp that is not green
};

struct VariableReport {
  std::string name, unit;  // SI
  double min = 0, max = 0, last = 0;
};

struct RunReport {
  ExitCode code = ExitCode::ok;
  std::string scene, session, pace;
  double step = 0;  // s
  StepIndex steps = 0;
  double simulated_time = 0;  // s
  double wall_time = 0;       // s, without pauses
  double paused_time = 0;     // s
  double slip = 0;            // s
  std::string books;          // of a paced session: what does not balance; empty: all does
  std::vector<NodeReport> nodes;
  std::string lost;  // "tick 0, mechanism 0, ..."; empty: not recorded
  std::vector<PortReport> ports;
  double omega_H = 0;  // largest
  std::vector<VariableReport> variables;
  std::vector<session::DeviceOutcome> devices;
  std::vector<std::string> notes;     // remarkable: a load that could not be lifted, and why
  std::vector<std::string> messages;  // why it did not end well
  std::string plots;                  // path of the picture
  std::string recording;              // path
  bool is_read_back = false;          // the recording was read for this, and not its summary alone
};

// Collects the report and writes the scene's plots and copies of its files beside the recording, where there is one.
// What was seen of the session counts when the recorder has the same blocks of variables, and what the recorder counted
// while it wrote; else the recording is read. assets: folder of the files.
[[nodiscard]] RunReport make_report(const session::RunOutcome& outcome, const scene::Scene& scene,
                                    const std::string& assets);

// Names and patterns of the variables whose curves the report needs.
[[nodiscard]] std::vector<std::string> report_variables(const scene::Scene& scene);

// The table; messages and paths are not in it. width [characters]: of its lines; 0: no limit.
[[nodiscard]] std::string report_text(const RunReport& report, std::size_t width = 0);
[[nodiscard]] Json report_json(const RunReport& report);

}  // namespace slew::analysis
