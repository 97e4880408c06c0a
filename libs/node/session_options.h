// SPDX-License-Identifier: Apache-2.0
// What a node or a verb needs to find its session: the session and its network, as options of the command line
// (program/add_session_options.h) give it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "transport/network.h"

namespace slew::node {

struct SessionOptions {
  std::string session;             // name
  std::uint32_t domain = 0;        // DDS domain
  std::string interface = "lo";    // network interface that messages are sent on
  std::vector<std::string> peers;  // addresses of the other machines; empty: this machine only
  std::string keys;                // folder of a key store, see transport/protection.h; empty: none
  std::string identity;            // name of the keys in it; empty: those of the role
  bool is_insecure_lan = false;    // sends beyond this machine without keys
  std::string middleware = transport::kMiddlewares[0];
};

// The options of the network as command-line arguments, for a child process.
[[nodiscard]] std::vector<std::string> network_arguments(const SessionOptions& options);

// Checks a session's name: 1 to 63 letters, digits, '_', '-', '.'. Empty when the name is valid, else the problem.
[[nodiscard]] std::string problem_of_session_name(const std::string& name);
// A scene's name made into a session's name.
[[nodiscard]] std::string session_name_of(const std::string& scene);

}  // namespace slew::node
