// SPDX-License-Identifier: Apache-2.0
// A recorder whose session, other nodes and clock are played by the test.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <set>
#include <string>

#include "recorder_node/recorder_node.h"
#include "recording/reader.h"
#include "tests/support/played_session.h"

namespace slew::recorder_node {

using testing::kMs;
using testing::PlayedSession;
using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

class RecorderBench {
 public:
  explicit RecorderBench(RecorderConfig config = {}) {
    std::string name = (std::filesystem::temp_directory_path() / "slewring_recorder_XXXXXX").string();
    folder = ::mkdtemp(name.data());
    config.runs_directory = folder;
    node = std::make_unique<RecorderNode>(played.transport(), std::move(config));
  }
  ~RecorderBench() { std::filesystem::remove_all(folder); }
  RecorderBench(const RecorderBench&) = delete;
  RecorderBench& operator=(const RecorderBench&) = delete;

  void poll(std::int64_t after_ns = 0) { node->poll(now_ns += after_ns); }
  void publish_probe() {
    wire::Tick probe;
    probe.header = played.header(Role::io, kJoinStep, Phase::join);
    played.publish(Topic::tick, probe);
  }
  void join() {
    played.publish(Topic::session, played.session);
    poll();
    for (const Role role : {Role::io, Role::mechanics, Role::hydraulics})
      played.publish_status(role, NodeState::joining);
    poll(kMs);
    publish_probe();
    poll(kMs);
    ASSERT_EQ(node->member().state(), NodeState::joining) << "io has not chosen it";
    choose(node->member().header(Phase::join, kJoinStep), NodeState::joining);
    ASSERT_EQ(node->member().state(), NodeState::ready);
  }
  // io took the status of this process first
  void choose(const wire::Header& process, NodeState state) {
    played.acknowledge(Role::io, state, process, {Topic::node_status});
    poll(kMs);
  }
  // ticks and samples of [from, to]
  void publish_steps(StepIndex from, StepIndex to) {
    for (StepIndex step = from; step <= to; ++step) {
      played.publish_tick(step);
      played.publish_mechanism(step);
      played.publish_actuators(step);
    }
    poll(101 * kMs);
  }
  // mechanics' variables at a step
  void publish_block(StepIndex step) {
    wire::VariableBlock block;
    block.header = played.header(Role::mechanics, step);
    block.values.resize(3);
    played.publish(Topic::variables, block);
    poll();
  }
  void publish_end(StepIndex last, NodeState state = NodeState::ended) {
    for (const Role role : {Role::io, Role::mechanics, Role::hydraulics}) played.publish_status(role, state, last);
    poll(kMs);
  }
  // another process of the role
  wire::NodeStatus other_recorder(NodeState state, StepIndex recorded, std::int64_t started_ns) const {
    wire::NodeStatus status = played.status(Role::recorder, state);
    status.header.incarnation = 999;
    status.recorded_step = recorded;
    status.started_ns = started_ns;
    return status;
  }

  // ---- contents of the file
  // steps of a topic by epoch
  [[nodiscard]] std::set<StepIndex> recorded(Topic topic, std::uint32_t epoch = 0) const {
    std::unique_ptr<recording::Reader> reader;
    EXPECT_TRUE(recording::Reader::open(node->recording(), reader).is_ok());
    std::set<StepIndex> steps;
    if (reader == nullptr) return steps;
    EXPECT_TRUE(reader
                    ->for_each({},
                               [&](const recording::RecordedMessage& message) {
                                 wire::Header header;
                                 const bool is_wanted = message.channel->topic == node::to_text(topic);
                                 if (is_wanted && transport::decode_header(message.payload, header) &&
                                     header.epoch == epoch) {
                                   steps.insert(header.step);
                                 }
                                 return recording::Reader::Visit::go_on;
                               })
                    .is_ok());
    return steps;
  }
  [[nodiscard]] std::string summary(const std::string& key) const {
    std::unique_ptr<recording::Reader> reader;
    EXPECT_TRUE(recording::Reader::open(node->recording(), reader).is_ok());
    const recording::TextMap* entries = reader == nullptr ? nullptr : reader->find_metadata("slewring.summary");
    if (entries == nullptr || entries->count(key) == 0) return "none";
    return entries->at(key);
  }

  PlayedSession played{bit(Role::io) | bit(Role::mechanics) | bit(Role::hydraulics) | bit(Role::recorder)};
  std::filesystem::path folder;
  std::unique_ptr<RecorderNode> node;
  std::int64_t now_ns = 1000 * kMs;
};

}  // namespace slew::recorder_node
