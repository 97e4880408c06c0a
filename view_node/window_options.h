// SPDX-License-Identifier: Apache-2.0
// Options of `slewring window` and view_node for the gateway.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "node/session_options.h"
#include "options/options.h"

namespace slew::view_node {

// The line by which a window requests another session with its scene from the command that started both.
inline constexpr std::string_view kRestartLine = "the page requests a restart with the saved scene";

inline constexpr std::uint32_t kDefaultPort = 8765;  // the one that Foxglove and Lichtblick propose

struct WindowOptions {
  node::SessionOptions session;     // a live one
  std::string recording;            // in its place; empty: none
  std::vector<std::string> beside;  // recordings whose curves are shown beside those of the recording
  double session_timeout = 30;      // s
  std::uint32_t port = kDefaultPort;
  std::string listen = "127.0.0.1";
  std::string token_file;            // its first line is the token; empty: none
  std::vector<std::string> hosts;    // gateway::DoorDef
  std::vector<std::string> origins;  // gateway::DoorDef
  std::string web;                   // folder of the page; empty: the built one
  std::string saves = "saved";       // folder of saved states
  std::string assets;                // folder of the scene's files; empty: the scene's or recording's own, or this one
  std::string scene;                 // file of the session's scene, which the page may edit; empty: none
  std::vector<std::string> set;      // settings over it
  bool opens_browser = true;         // where there is a desktop
  bool is_looking_only = false;
  bool is_json = false;
};

// All but those of the session, the recording and the scene.
void add_window_options(options::Command& verb, WindowOptions& options);

// The same as command-line arguments, for a child process: with those of the session, the recording and the scene.
[[nodiscard]] std::vector<std::string> window_arguments(const WindowOptions& options);

}  // namespace slew::view_node
