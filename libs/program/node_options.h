// SPDX-License-Identifier: Apache-2.0
// Options of the command line of every node.
#pragma once

#include <string>

#include "node/session_member.h"
#include "node/session_options.h"
#include "options/options.h"
#include "transport/roles.h"

namespace slew::program {

struct NodeOptions {
  node::SessionOptions session;
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

// Those of add_session_options() and --rt, --priority, --cpu: for every node.
void add_node_options(options::Command& app, NodeOptions& options);
// Range of --join-timeout.
inline constexpr double kShortestJoin = 0.1, kLongestJoin = 86400;  // s
// --join-timeout: for a node that waits for others.
void add_join_timeout(options::Command& app, NodeOptions& options);
// --session-timeout, --session-id: for a node that looks for its session.
void add_finding_options(options::Command& app, NodeOptions& options);
// All of these, --assets and --add-work.
void add_physics_node_options(options::Command& app, NodeOptions& options);

}  // namespace slew::program
