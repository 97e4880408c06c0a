// SPDX-License-Identifier: Apache-2.0
// A session played by a test: one real node on the bus of one process; the test publishes the messages of its partners
// and sets the time.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <vector>

#include "coupling/subsystem.h"
#include "node/node.h"
#include "transport/cdr/codec.h"
#include "transport/in_process/in_process_bus.h"
#include "transport/roles.h"
#include "transport/wire.h"

namespace slew::testing {

inline constexpr std::int64_t kMs = 1'000'000;

// A subsystem without motion: every step succeeds.
class StillSubsystem : public coupling::Subsystem {
 public:
  bool first_sample(coupling::OwnSample&) noexcept override { return true; }
  Status start(const coupling::PartnerSamples&, coupling::OwnSample&) override { return Status::ok(); }
  StepReport step(StepIndex, const coupling::PartnerSamples&, std::span<const double>,
                  coupling::OwnSample&) noexcept override {
    return {};
  }
  bool change_parameter(StepIndex, const coupling::ParameterChange&) noexcept override { return false; }
  void reset() override {}
  [[nodiscard]] std::uint64_t state_hash() const noexcept override { return 1; }
  [[nodiscard]] Status can_save() const override { return Status::ok(); }
  void save(std::vector<std::byte>&) const override {}
  Status load(std::span<const std::byte> state, coupling::OwnSample&) override {
    return state.empty() ? Status::ok() : Status::error(ExitCode::bad_input, "what does not move has no state");
  }
  [[nodiscard]] coupling::Level level() const noexcept override { return coupling::Level::two; }
  [[nodiscard]] std::span<const ElementVariable> variables() const noexcept override { return {}; }
  void read_variables(std::span<double>) const noexcept override {}
  [[nodiscard]] std::string_view offender_name(std::int32_t) const noexcept override { return ""; }
};

// The same with one variable.
class ObservedSubsystem final : public StillSubsystem {
 public:
  [[nodiscard]] std::span<const ElementVariable> variables() const noexcept override { return variables_; }
  void read_variables(std::span<double> values) const noexcept override { values[0] = 7; }

 private:
  std::vector<ElementVariable> variables_{{"Bag.mass", Dimension::mass}};
};

// A transport that fails to send on a topic after break_down().
class BreakableTransport final : public transport::Transport {
 public:
  explicit BreakableTransport(transport::Transport& transport) : transport_(transport) {}
  void break_down(wire::Topic topic) { broken_.insert(topic); }
  Status publish(wire::Topic topic, std::span<const std::byte> bytes) noexcept override {
    if (!broken_.contains(topic)) return transport_.publish(topic, bytes);
    return Status::error(ExitCode::failed, "message not sent");
  }
  bool take(transport::Received& message) override { return transport_.take(message); }
  void wait_until(std::int64_t monotonic_deadline_ns) override { transport_.wait_until(monotonic_deadline_ns); }
  [[nodiscard]] std::vector<std::string> discovered_writers(wire::Topic topic) override {
    return transport_.discovered_writers(topic);
  }
  [[nodiscard]] std::vector<std::string> misfits() override { return transport_.misfits(); }
  [[nodiscard]] std::size_t matched_readers(wire::Topic topic) const override {
    return transport_.matched_readers(topic);
  }

 private:
  transport::Transport& transport_;
  transport::TopicSet broken_;
};

class PlayedSession {
 public:
  explicit PlayedSession(std::uint32_t required_roles) {
    session.header.session[0] = 42;
    session.header.role = wire::Role::io;
    session.header.incarnation = incarnation(wire::Role::io);
    session.header.phase = wire::Phase::running;
    session.name = "s";
    session.scene_name = "still";
    session.step_ns = kMs;
    session.required_roles = required_roles;
    session.host = "elsewhere#1";
    session.pid = 77;
  }

  [[nodiscard]] transport::Transport& transport() { return node_; }
  [[nodiscard]] static std::uint32_t incarnation(wire::Role role) { return 10 + static_cast<std::uint32_t>(role); }

  [[nodiscard]] wire::Header header(wire::Role role, StepIndex step, wire::Phase phase = wire::Phase::running,
                                    std::uint32_t epoch = 0) const {
    return {session.header.session, role, incarnation(role), epoch, phase, step};
  }

  template <typename Message>
  void publish(wire::Topic topic, const Message& message) {
    std::vector<std::byte> bytes;
    ASSERT_TRUE(transport::encode(message, bytes));
    ASSERT_TRUE(played_.publish(topic, bytes).is_ok());
  }

  void publish_bytes(wire::Topic topic, std::span<const std::byte> bytes) {
    ASSERT_TRUE(played_.publish(topic, bytes).is_ok());
  }

  [[nodiscard]] wire::NodeStatus status(wire::Role role, wire::NodeState state, StepIndex step = kJoinStep) const {
    wire::NodeStatus status;
    status.header = header(role, step);
    status.state = state;
    status.host = "elsewhere#1";
    status.pid = 1000 + static_cast<std::uint32_t>(role);
    status.started_ns = 1;
    return status;
  }
  void publish_status(wire::Role role, wire::NodeState state, StepIndex step = kJoinStep) {
    publish(wire::Topic::node_status, status(role, state, step));
  }
  // Publishes that the role has received from the node under test on these topics.
  void acknowledge(wire::Role role, wire::NodeState state, const wire::Header& node,
                   std::initializer_list<wire::Topic> topics) {
    wire::NodeStatus message = status(role, state);
    for (const wire::Topic topic : topics) {
      message.heard.push_back({node.role, node.incarnation, static_cast<std::uint8_t>(topic)});
    }
    publish(wire::Topic::node_status, message);
  }
  void publish_tick(StepIndex step, std::uint32_t flags = 0) {
    wire::Tick tick;
    tick.header = header(wire::Role::io, step);
    tick.flags = flags;
    publish(wire::Topic::tick, tick);
  }
  void publish_mechanism(StepIndex step, wire::Phase phase = wire::Phase::running, std::uint32_t epoch = 0) {
    wire::MechanismMessage message;
    message.header = header(wire::Role::mechanics, step, phase, epoch);
    publish(wire::Topic::mechanism, message);
  }
  void publish_actuators(StepIndex step, wire::Phase phase = wire::Phase::running, std::uint32_t epoch = 0) {
    wire::ActuatorMessage message;
    message.header = header(wire::Role::hydraulics, step, phase, epoch);
    publish(wire::Topic::actuators, message);
  }

  // Takes the node under test through JOIN: every other required role acknowledges these topics in this state.
  void join(node::Node& node, std::int64_t& now_ns, std::initializer_list<wire::Topic> topics,
            wire::NodeState state = wire::NodeState::joining) {
    publish(wire::Topic::session, session);
    node.poll(now_ns);
    const wire::Header own = node.member().header(wire::Phase::join, kJoinStep);
    for (const wire::Role role : transport::node_roles()) {
      const bool is_played = role != own.role && (session.required_roles & wire::bit(role)) != 0;
      if (is_played) acknowledge(role, state, own, topics);
    }
    node.poll(now_ns += kMs);
    node.poll(now_ns += kMs);
  }

  // Messages that the node under test has published on a topic since the last call.
  template <typename Message>
  [[nodiscard]] std::vector<Message> received(wire::Topic topic) {
    listen();
    std::vector<Message> messages;
    for (const std::vector<std::byte>& bytes : received_[topic]) {
      messages.emplace_back();
      EXPECT_TRUE(transport::decode(bytes, messages.back()));
    }
    received_[topic].clear();
    return messages;
  }

  void forget() {
    listen();
    received_.clear();
  }

  wire::SessionDescription session;

 private:
  void listen() {
    transport::Received received;
    while (played_.take(received)) received_[received.topic].emplace_back(received.bytes.begin(), received.bytes.end());
  }

  transport::InProcessBus bus_;
  transport::InProcessEndpoint node_{bus_, {"node", transport::TopicSet::all(), transport::TopicSet::all()}};
  transport::InProcessEndpoint played_{bus_, {"played", transport::TopicSet::all(), transport::TopicSet::all()}};
  std::map<wire::Topic, std::vector<std::vector<std::byte>>> received_;
};

}  // namespace slew::testing
