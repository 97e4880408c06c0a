// SPDX-License-Identifier: Apache-2.0
// Command-line options with which a node or a verb finds its session.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "node/session_member.h"
#include "options/options.h"
#include "transport/network.h"
#include "transport/roles.h"

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

struct NodeOptions {
  SessionOptions session;
  bool is_real_time = false;
  int priority = transport::kPhysicsPriority;  // SCHED_FIFO, 1..99
  int cpu = -1;                                // processor to run on; -1: any
  double added_work_us = 0;                    // CPU time that each step of a physics node burns beside its own
  double join_timeout = 10;                    // s
  // for nodes that look for their session
  double session_timeout = 30;  // s
  std::string session_id;       // 32 hexadecimal digits; empty: the first session of the name
  std::string assets = ".";     // folder of the scene's assets

  [[nodiscard]] node::JoinOptions join() const;
};

// --domain, --interface, --peer, --keys, --identity, --insecure-lan, --middleware.
void add_network_options(options::Command& app, SessionOptions& options);
// --session and the network; without a name the verb takes its scene's.
void add_session_options(options::Command& app, SessionOptions& options, bool is_required);
// The above and --rt, --priority, --cpu: for every node.
void add_node_options(options::Command& app, NodeOptions& options);
// Range of --join-timeout.
inline constexpr double kShortestJoin = 0.1, kLongestJoin = 86400;  // s
// --join-timeout: for a node that waits for others.
void add_join_timeout(options::Command& app, NodeOptions& options);
// --session-timeout, --session-id: for a node that looks for its session.
void add_finding_options(options::Command& app, NodeOptions& options);
// All of these, --assets and --add-work.
void add_physics_node_options(options::Command& app, NodeOptions& options);

// The same as command-line arguments, for a child process.
[[nodiscard]] std::vector<std::string> network_arguments(const SessionOptions& options);

// Checks a session's name: 1 to 63 letters, digits, '_', '-', '.'. Empty when the name is valid, else the problem.
[[nodiscard]] std::string problem_of_session_name(const std::string& name);
// A scene's name made into a session's name.
[[nodiscard]] std::string session_name_of(const std::string& scene);

}  // namespace slew::node
