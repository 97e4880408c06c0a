// SPDX-License-Identifier: Apache-2.0
// Configuration of io_node: the settings of the session, and the parts that its scene is built into.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io_node/input_gate.h"
#include "io_node/input_sources.h"
#include "io_node/live_parameters.h"
#include "io_node/saved_session.h"
#include "node/session_member.h"
#include "node/step_timing.h"
#include "scene/defs.h"
#include "scene/live_course.h"

namespace slew::io_node {

// Answer of the scene's parameter directory to a requested change.
struct ParameterCheck {
  bool is_accepted = false;
  std::string reason;
  std::int64_t over_ns = 0;  // duration of the change: the requested one, or the parameter's own
};

// State from which a session continues another one.
struct ResumeState {
  StepIndex step = 0;
  std::vector<SavedState> states;      // states of io and of every physics node
  std::vector<wire::Command> changes;  // parameter changes at this step
};

// Values of live parameters from a step on.
struct LiveCourse {
  std::vector<std::pair<std::string, double>> present;
  std::vector<scene::LiveChange> changes;  // in order of steps
};

struct IoConfig {
  std::string session_name;
  scene::SessionDef session;
  std::string scene_name;
  std::string scene_text;
  std::vector<wire::Asset> assets;
  std::uint32_t required_roles = 0;  // bits, with io itself
  std::vector<ChannelConfig> channels;
  std::vector<std::unique_ptr<InputSource>> sources;  // in order of precedence
  std::vector<TimedChange> changes;                   // in order of time
  // Check of a requested change; over_ns: -1 if the request leaves it open.
  std::function<ParameterCheck(const std::string& path, double value, std::int64_t over_ns)> check_parameter;
  // Reason against a value that check_parameter accepts, with the values before step n and all changes from then on;
  // empty: none.
  std::function<std::string(const wire::Command& change, const LiveCourse& course)> check_course;
  std::vector<LiveParameter> parameters;       // parameters that may change while the session runs
  StepIndex variables_every = 10;              // steps between two blocks of variables
  StepIndex flexible_every = 1;                // steps between two samples of flexible bodies
  StepIndex exchange_unit = 1;                 // steps after which all nodes have exchanged: a state can be saved
  SimDuration name_check = milliseconds(300);  // wait for another session of the name; 0 in one process
  SimDuration join_timeout = node::kJoinTimeout;
  bool starts_paused = false;
  std::string save_obstacle{};  // reason why the session's state cannot be saved; empty: it can
  std::optional<ResumeState> resume{};
  // Clock of the controllers' time stamps: the same on loopback, so that the stamp dates a value.
  node::WriterClock controllers_clock = node::WriterClock::other;

  [[nodiscard]] GateConfig gate() const {
    return {.neutral_after = duration_of_seconds(session.controller_timeout), .variables_every = variables_every};
  }
};

}  // namespace slew::io_node
