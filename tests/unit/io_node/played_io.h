// SPDX-License-Identifier: Apache-2.0
// The owner of a session; the test plays the physics nodes and the clock.
#pragma once

#include <gtest/gtest.h>

#include <map>

#include "io_node/io_node.h"
#include "tests/support/played_session.h"

namespace slew::io_node {

using testing::kMs;
using testing::PlayedSession;
using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

class Io : public ::testing::Test {
 protected:
  static IoConfig config() {
    IoConfig config;
    config.session_name = "s";
    config.session.duration = 0;  // until it is stopped
    config.session.start_grace = 0;
    config.session.controller_timeout = 0.2;
    config.scene_name = "still";
    config.required_roles = bit(Role::io) | bit(Role::mechanics) | bit(Role::hydraulics);
    config.name_check = {};
    return config;
  }
  void poll(std::int64_t after_ns = 0) { node->poll(now_ns += after_ns); }
  void restart(IoConfig with) { node = std::make_unique<IoNode>(played.transport(), std::move(with)); }
  // so many milliseconds in which the others give signs of life
  void live(std::int64_t ms) {
    for (const std::int64_t end_ns = now_ns + ms * kMs; now_ns < end_ns;) {
      played.publish_status(Role::mechanics, NodeState::running, 1);
      played.publish_status(Role::hydraulics, NodeState::running, 1);
      poll(100 * kMs);
    }
  }

  // every node is ready and has its first sample
  void join_all() {
    poll();
    const auto sessions = played.received<wire::SessionDescription>(Topic::session);
    ASSERT_FALSE(sessions.empty());
    played.session.header = sessions.back().header;
    for (const Role role : {Role::mechanics, Role::hydraulics}) {
      played.acknowledge(role, NodeState::joining, node->member().header(Phase::join, kJoinStep), {Topic::tick});
    }
    poll(kMs);
    played.publish_status(Role::mechanics, NodeState::ready, 0);
    played.publish_status(Role::hydraulics, NodeState::ready, 0);
    publish_samples(0);
    poll(kMs);
  }
  // the session runs: tick 0 is out
  void get_running() {
    join_all();
    poll();
    ASSERT_EQ(node->next_step(), 1);
  }
  void publish_samples(StepIndex step) {
    played.publish_mechanism(step, Phase::running, node->member().epoch());
    played.publish_actuators(step, Phase::running, node->member().epoch());
  }
  // steps in time: each tick is answered at once
  void run_to(StepIndex step) {
    while (node->next_step() < step) {
      publish_samples(node->next_step());
      poll(kMs);
    }
  }
  wire::ControlReply request(wire::ControlAction action, double value = 0) {
    wire::ControlRequest request;
    request.session = "s";
    request.request = ++requests_;
    request.action = action;
    request.value = value;
    played.publish(Topic::control_request, request);
    poll();
    const auto replies = played.received<wire::ControlReply>(Topic::control_reply);
    EXPECT_EQ(replies.size(), 1u);
    return replies.empty() ? wire::ControlReply{} : replies.back();
  }

  // a node that ends with this reason
  wire::NodeStatus publish_fault(Role role, StepIndex step, ExitCode code, std::string reason) {
    wire::NodeStatus fault = played.status(role, NodeState::fault, step);
    fault.exit_code = static_cast<std::int32_t>(code);
    fault.reason = std::move(reason);
    played.publish(Topic::node_status, fault);
    return fault;
  }
  // the last values that were published, by their names
  std::map<std::string, double> last_variables() {
    std::map<std::string, double> values;
    const auto directory = played.received<wire::VariableDirectory>(Topic::variable_directory);
    const auto blocks = played.received<wire::VariableBlock>(Topic::variables);
    EXPECT_FALSE(directory.empty() || blocks.empty());
    if (directory.empty() || blocks.empty()) return values;
    EXPECT_EQ(directory.back().entries.size(), blocks.back().values.size());
    for (std::size_t i = 0; i < blocks.back().values.size(); ++i) {
      values[directory.back().entries[i].name] = blocks.back().values[i];
    }
    return values;
  }

  PlayedSession played{0};
  std::unique_ptr<IoNode> node = std::make_unique<IoNode>(played.transport(), config());
  std::int64_t now_ns = 1000 * kMs;
  std::uint64_t requests_ = 0;
};

}  // namespace slew::io_node
