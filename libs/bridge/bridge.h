// SPDX-License-Identifier: Apache-2.0
// `slewring bridge lcm` and `slewring export --lcm`: a session, live or recorded, towards LCM. A live one takes inputs
// and parameter requests from there.
//
// The bridge is an observer of the session and a controller in it, in a process of its own: LCM loses messages, so
// nothing of it may be part of a step.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/json.h"
#include "core/time.h"
#include "observer/observer.h"

namespace slew::bridge {

inline constexpr const char* kDefaultUrl = "udpm://239.255.76.67:7667?ttl=0";

struct Settings {
  std::string prefix;                // of the channels; empty: SLEWRING_<session>
  std::vector<std::string> signals;  // NAME=var,var...
  StepIndex every = 0;               // blocks of steps that are multiples of it; 0: all
  std::string url = kDefaultUrl;
  std::vector<std::string> controllers;  // whose inputs are accepted
  bool takes_parameters = false;
  bool is_insecure_lan = false;
};

// An input of the scene.
struct Channel {
  std::string name;
  bool is_digital = false;
  bool is_lockstep = false;
};

// What the bridge needs from the scene of a session.
struct SceneView {
  std::vector<Channel> channels;
  StepIndex variables_every = 1;
  SimDuration neutral_after = milliseconds(500);
};

// Throws Failure (resources) where this program was built without LCM.
void require_lcm();

class Bridge {
 public:
  // Checks the settings before anything is opened. Throws Failure.
  explicit Bridge(Settings settings);
  ~Bridge();

  // Of the observer that is given to the others.
  [[nodiscard]] observer::Receiver& receiver() noexcept;
  // It sends into the session.
  [[nodiscard]] bool is_door() const noexcept;

  // The types of the signal lists, with the units of the session. Throws Failure.
  [[nodiscard]] std::string types(observer::Observer& observer);
  // Until the session ends or a stop is requested. report: takes a line for the user. Throws Failure.
  void run(observer::Observer& observer, const SceneView& scene, const std::function<void(const std::string&)>& report);
  // What it did, for programs and as text.
  [[nodiscard]] Json summary() const;
  [[nodiscard]] std::string summary_text() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Writes a session that a view is fed with as an LCM event log. Times are those of the session; the first event is at
// 0.
class LogExport {
 public:
  // write: takes the next bytes of the log. Throws Failure.
  LogExport(const Settings& settings, const std::string& session, SceneView scene,
            std::function<void(std::string_view)> write);
  ~LogExport();

  // Leaves out blocks outside; both included.
  void choose(std::uint64_t from_ns, std::uint64_t to_ns);
  // Throws Failure from its calls when the session was reset.
  [[nodiscard]] observer::Receiver& receiver(const observer::SessionView& view);
  [[nodiscard]] std::int64_t events() const noexcept;
  // Steps of signal lists of which the recording has not all values.
  [[nodiscard]] std::uint64_t incomplete() const noexcept;
  // Inputs of the scene whose raw value the recording does not have.
  [[nodiscard]] std::vector<std::string> missing_inputs() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slew::bridge
