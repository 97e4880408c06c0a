// SPDX-License-Identifier: Apache-2.0
// A run of a session: its options, the two ways to run, and its outcome.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/status.h"
#include "io_node/session_scene.h"
#include "node/session_options.h"
#include "observer/observer.h"
#include "scene/scene_options.h"
#include "session/device_processes.h"
#include "session/tally.h"

namespace slew::session {

// Follows a run: a status line, a keyboard, a measurement. This one reports messages alone.
class RunWatcher {
 public:
  RunWatcher() = default;
  virtual ~RunWatcher() = default;
  RunWatcher(const RunWatcher&) = delete;
  RunWatcher& operator=(const RunWatcher&) = delete;

  // Its observer needs the values of variables.
  [[nodiscard]] virtual bool reads_values() const { return false; }
  // All nodes are started.
  virtual void begin() {}
  // A message of the run or of one of its nodes: a line on standard error.
  virtual void report(const std::string& message);
  // Called some 50 times a second. False requests the end of the session; is_ending: the request was sent.
  virtual bool update(observer::Observer& observer, std::int64_t now_ns, bool is_ending);
  // The last node has ended.
  virtual void end() {}
};

struct RunOptions {
  scene::SceneOptions scene;
  node::SessionOptions session;
  std::string runs = "runs";           // folder of the recordings
  double keep_free_mb = 256;           // disk space that a recording leaves free
  std::vector<std::string> remote;     // roles that are started elsewhere
  std::optional<double> join_timeout;  // s, longest wait for nodes and lockstep controllers; none: the nodes' own
  bool is_in_process = false;
  bool is_monolithic = false;
  std::string rtol;  // relative tolerance of a monolithic run; empty: the scene's
  bool is_real_time = false;
  bool is_refusal_reported = false;   // that it was refused: not once more
  std::string cpus;                   // "mechanics=1, hydraulics=0"; empty: as in the scene
  double added_work_us = 0;           // CPU time that every step of a physics node burns beside its own
  std::vector<std::string> kept;      // patterns of variables whose curves the outcome's tally keeps
  bool is_without_devices = false;    // does not start the devices of the scene
  bool are_devices_insecure = false;  // they may receive and send beyond this machine
  bool is_json = false;
  bool is_quiet = false;

  // Folder of the scene file and its assets.
  [[nodiscard]] std::string assets() const;
};

// Wall time of a run, measured repeatedly. Time in which a paused session does no step is counted apart.
class RunClock {
 public:
  void measure(std::int64_t now_ns, StepIndex step, bool is_paused) noexcept;
  [[nodiscard]] double running() const noexcept { return static_cast<double>(running_ns_) * 1e-9; }  // s
  [[nodiscard]] double paused() const noexcept { return static_cast<double>(paused_ns_) * 1e-9; }    // s

 private:
  std::int64_t last_ns_ = 0;
  StepIndex last_step_ = 0;
  std::int64_t running_ns_ = 0, paused_ns_ = 0;
};

struct RunOutcome {
  ExitCode code = ExitCode::ok;
  bool has_begun = false;             // the session came into being
  bool is_refusal_reported = false;   // a refusal of real-time scheduling or locked memory was reported
  std::vector<std::string> messages;  // causes of a failure, the first cause first
  std::string recording;              // path; empty: none
  std::vector<DeviceOutcome> devices;
  observer::SessionView view;  // as seen while it ran
  Tally tally{{{}, {}}};       // of the same messages
  double wall_time = 0;        // s, from the first tick to the last, without pauses
  double paused_time = 0;      // s
  StepIndex begin = 0;         // step that the session began with
  StepIndex steps = 0;
};

// Starts the nodes that the scene needs as processes, watches over them, and ends them in order.
[[nodiscard]] RunOutcome run_distributed(const RunOptions& options, const io_node::SessionScene& session,
                                         RunWatcher& watcher);

// All nodes on one thread of this process: for the debugger, for speed, and as the reference that a distributed run
// must equal bit for bit.
[[nodiscard]] RunOutcome run_in_process(const RunOptions& options, const io_node::SessionScene& session,
                                        RunWatcher& watcher);

// Messages "program: reason" without those that only repeat the reason of another, in the order given.
[[nodiscard]] std::vector<std::string> without_echoes(const std::vector<std::string>& messages);

}  // namespace slew::session
