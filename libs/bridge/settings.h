// SPDX-License-Identifier: Apache-2.0
// Settings of the bridge to LCM and of the export of a log: channels, signal lists, and the scene of the session.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/time.h"
#include "lcm_log/signal_list.h"
#include "observer/session_view.h"

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

// The signal lists of the settings. Throws Failure (bad_input).
[[nodiscard]] std::vector<lcm_log::SignalList> read_lists(const Settings& settings);

// The prefix of the channels, with which LCM can carry the longest of them. Throws Failure (bad_input): a shortened
// name would be found by no one.
[[nodiscard]] std::string prefix_of(const Settings& settings, const std::string& session,
                                    std::span<const lcm_log::SignalList> lists);

// Throws Failure (bad_input) where the scene has no variables at these steps.
void check_every(const Settings& settings, const SceneView& scene);

// Throws Failure (bad_input) for a variable that no node has, with the one that was probably meant. source: "the
// session", "the recording".
void check_names(std::span<const lcm_log::SignalList> lists, const observer::SessionView& view,
                 std::string_view source);

}  // namespace slew::bridge
