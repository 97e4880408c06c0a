// SPDX-License-Identifier: Apache-2.0
// Runs one device of a scene against a session, from its first tick to its end.
#pragma once

#include <functional>
#include <string>

#include "core/json.h"
#include "core/status.h"
#include "node/session_options.h"

namespace slew::device_node {

struct DeviceOptions {
  node::SessionOptions session;
  std::string device;           // name in the scene
  std::string file;             // with sections devices and outputs, in the place of those of the session's scene
  std::string assets = ".";     // folder of the recorded files that the session's scene names
  double session_timeout = 30;  // s
  bool is_insecure = false;     // may receive and send beyond this machine
  bool is_supervised = false;   // publishes signs of life and its summary for `slewring run`
};

// Lines of a supervised device for its supervisor.
inline constexpr std::string_view kAliveLine = "alive";
inline constexpr std::string_view kRestLine = "comes to rest";  // after the session, in the place of "alive"
inline constexpr std::string_view kSummaryPrefix = "summary: ";

// Until the session ends or a signal comes. report: takes lines for the user. Result: what it did. Throws Failure or
// scene::LoadError.
[[nodiscard]] Json run_device(const DeviceOptions& options, const std::function<void(const std::string&)>& report);

// The counts of run_device() in one line.
[[nodiscard]] std::string summary_text(const Json& summary);

}  // namespace slew::device_node
