// SPDX-License-Identifier: Apache-2.0
// Mechanics and flex node in a session with flexible bodies: when each waits for the other.
#include <gtest/gtest.h>

#include "node/physics_node.h"
#include "tests/support/played_session.h"

namespace slew::node {
namespace flexible_nodes_test {

using coupling::ElasticExchange;
using testing::kMs;
using testing::PlayedSession;
using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::TickFlag;
using wire::Topic;

constexpr StepIndex kEvery = 10;

class WithFlexibleBodies : public ::testing::Test {
 protected:
  [[nodiscard]] static SubsystemFactory built_for(ElasticExchange exchange) {
    return [exchange](const wire::SessionDescription&, BuiltSubsystem& built) {
      built.subsystem = std::make_unique<testing::ObservedSubsystem>();
      built.published_variables = {0};
      built.variables_every = kEvery;
      built.exchange = {
          .port_every = 1, .flexible_every = exchange == ElasticExchange::once ? kEvery : 1, .elastic = exchange};
      return Status::ok();
    };
  }
  void publish_elastic(StepIndex step, Phase phase = Phase::running) {
    wire::ElasticMessage message;
    message.header = played.header(Role::flex, step, phase);
    played.publish(Topic::elastic, message);
  }
  void publish_flexible(StepIndex step) {
    wire::FlexibleMessage message;
    message.header = played.header(Role::mechanics, step);
    played.publish(Topic::flexible, message);
  }
  template <typename Message>
  std::vector<StepIndex> steps_of(Topic topic) {
    std::vector<StepIndex> steps;
    for (const Message& message : played.received<Message>(topic)) steps.push_back(message.header.step);
    return steps;
  }

  PlayedSession played{bit(Role::io) | bit(Role::mechanics) | bit(Role::flex)};
};

class Mechanics : public WithFlexibleBodies {
 protected:
  void get_ready(ElasticExchange exchange) {
    node = std::make_unique<PhysicsNode>(Role::mechanics, played.transport(), built_for(exchange));
    played.join(*node, now_ns, {Topic::mechanism, Topic::flexible});
    ASSERT_EQ(node->member().state(), NodeState::initialising);
    publish_elastic(kJoinStep, Phase::init);
    poll(kMs);
    ASSERT_EQ(node->member().state(), NodeState::ready);
    played.publish_status(Role::flex, NodeState::ready, 0);
    played.publish_status(Role::io, NodeState::running, 0);
    poll(0);
    played.forget();
  }
  void poll(std::int64_t after_ns) { node->poll(now_ns += after_ns); }

  std::unique_ptr<PhysicsNode> node;
  std::int64_t now_ns = 1000 * kMs;
};

TEST_F(Mechanics, StartsWithTheElasticForcesOfTheFlexNode) {
  node = std::make_unique<PhysicsNode>(Role::mechanics, played.transport(), built_for(ElasticExchange::once));
  played.publish(Topic::session, played.session);
  poll(0);
  const wire::Header own = node->member().header(Phase::join, kJoinStep);
  played.acknowledge(Role::io, NodeState::joining, own, {Topic::mechanism});
  // the mechanics' samples must be acknowledged as well
  played.acknowledge(Role::flex, NodeState::joining, own, {});
  poll(kMs);
  poll(kMs);
  EXPECT_EQ(node->member().state(), NodeState::joining);
  played.acknowledge(Role::flex, NodeState::joining, own, {Topic::flexible});
  poll(kMs);
  poll(kMs);
  EXPECT_EQ(node->member().state(), NodeState::initialising);
  played.forget();
  poll(4 * kMs);
  const auto requests = played.received<wire::ResendRequest>(Topic::resend);
  ASSERT_EQ(requests.size(), 1u);
  EXPECT_EQ(requests[0].role, Role::flex);
  EXPECT_EQ(requests[0].topic, static_cast<std::uint8_t>(Topic::elastic));
  EXPECT_EQ(requests[0].header.step, kJoinStep);
}

TEST_F(Mechanics, DoesNotWaitForFlexWhenItsForcesArePublishedOnce) {
  get_ready(ElasticExchange::once);
  for (StepIndex step = 0; step < 25; ++step) {
    played.publish_tick(step);
    poll(kMs);
  }
  EXPECT_EQ(steps_of<wire::MechanismMessage>(Topic::mechanism).size(), 25u);
  EXPECT_EQ(steps_of<wire::FlexibleMessage>(Topic::flexible), (std::vector<StepIndex>{10, 20}));
  // samples that arrive all the same are dropped without being counted as refused
  publish_elastic(20);
  poll(kMs);
  EXPECT_EQ(node->member().refusals().refused(), 0u);
}

TEST_F(Mechanics, WaitsForTheFlexNodeWhenTheyAreStatedEveryStep) {
  get_ready(ElasticExchange::every_step);
  played.publish_tick(0);
  poll(kMs);
  EXPECT_TRUE(steps_of<wire::MechanismMessage>(Topic::mechanism).empty());
  publish_elastic(0);
  poll(kMs);
  EXPECT_EQ(steps_of<wire::MechanismMessage>(Topic::mechanism), std::vector<StepIndex>{1});
  EXPECT_EQ(steps_of<wire::FlexibleMessage>(Topic::flexible), std::vector<StepIndex>{1});
  // it names the node it waits for, and requests the sample
  played.publish_tick(1);
  poll(10 * kMs);
  poll(kMs);
  EXPECT_TRUE(node->health().is_waiting.load());
  EXPECT_EQ(static_cast<Role>(node->health().waiting_for.load()), Role::flex);
  const auto requests = played.received<wire::ResendRequest>(Topic::resend);
  ASSERT_FALSE(requests.empty());
  EXPECT_EQ(requests.back().role, Role::flex);
}

TEST_F(Mechanics, ResendsTheStateOfItsModesOnRequest) {
  get_ready(ElasticExchange::once);
  for (StepIndex step = 0; step < 25; ++step) played.publish_tick(step);
  poll(kMs);
  played.forget();
  wire::ResendRequest request;
  request.header = played.header(Role::flex, 10);
  request.role = Role::mechanics;
  request.topic = static_cast<std::uint8_t>(Topic::flexible);
  request.last_step = 20;
  played.publish(Topic::resend, request);
  poll(kMs);
  EXPECT_EQ(steps_of<wire::FlexibleMessage>(Topic::flexible), (std::vector<StepIndex>{10, 20}));
  EXPECT_TRUE(steps_of<wire::MechanismMessage>(Topic::mechanism).empty());
}

class FlexNode : public WithFlexibleBodies {
 protected:
  void get_ready(ElasticExchange exchange) {
    node = std::make_unique<PhysicsNode>(Role::flex, played.transport(), built_for(exchange));
    played.join(*node, now_ns, {Topic::elastic});
    // its first sample needs no partner
    EXPECT_EQ(steps_of<wire::ElasticMessage>(Topic::elastic).back(), kJoinStep);
    EXPECT_EQ(node->member().state(), NodeState::initialising);
    publish_flexible(0);
    poll(kMs);
    ASSERT_EQ(node->member().state(), NodeState::ready);
    played.publish_status(Role::mechanics, NodeState::ready, 0);
    played.publish_status(Role::io, NodeState::running, 0);
    poll(0);
  }
  void poll(std::int64_t after_ns) { node->poll(now_ns += after_ns); }

  std::unique_ptr<PhysicsNode> node;
  std::int64_t now_ns = 1000 * kMs;
};

TEST_F(FlexNode, FollowsTheMechanicsWithoutTicks) {
  get_ready(ElasticExchange::once);
  EXPECT_EQ(steps_of<wire::ElasticMessage>(Topic::elastic), std::vector<StepIndex>{0});
  publish_flexible(20);
  poll(kMs);
  EXPECT_TRUE(steps_of<wire::ElasticMessage>(Topic::elastic).empty());
  publish_flexible(10);
  poll(kMs);
  EXPECT_EQ(steps_of<wire::ElasticMessage>(Topic::elastic), (std::vector<StepIndex>{10, 20}));
  EXPECT_EQ(node->member().refusals().refused(), 0u);
}

TEST_F(FlexNode, StatesEveryStep) {
  get_ready(ElasticExchange::every_step);
  for (StepIndex step = 1; step <= 3; ++step) publish_flexible(step);
  poll(kMs);
  EXPECT_EQ(steps_of<wire::ElasticMessage>(Topic::elastic), (std::vector<StepIndex>{0, 1, 2, 3}));
}

TEST_F(FlexNode, EndsWhenItHasSeenTheLastStep) {
  get_ready(ElasticExchange::once);
  played.publish_tick(25, static_cast<std::uint32_t>(TickFlag::end));
  publish_flexible(10);
  poll(kMs);
  EXPECT_NE(node->member().state(), NodeState::ended);
  publish_flexible(20);
  poll(kMs);
  EXPECT_EQ(node->member().state(), NodeState::ended);
  EXPECT_EQ(node->member().exit_code(), ExitCode::ok);
}

TEST_F(FlexNode, StatesThatItUsedTheSampleOfTheSameStep) {
  get_ready(ElasticExchange::once);
  publish_flexible(10);
  poll(kMs);
  const auto samples = played.received<wire::ElasticMessage>(Topic::elastic);
  ASSERT_EQ(samples.size(), 2u);
  for (const auto& sample : samples) EXPECT_EQ(sample.state.used_step, sample.header.step);
}

TEST_F(FlexNode, ShedsTheValuesOfItsVariablesFirst) {
  get_ready(ElasticExchange::once);
  const auto view = static_cast<std::uint32_t>(TickFlag::shed_view);
  const auto variables = static_cast<std::uint32_t>(TickFlag::shed_variables);
  const std::uint32_t flags[] = {0, view, view | variables, 0};
  for (StepIndex exchange = 0; exchange < 4; ++exchange) {
    played.publish_tick(exchange * kEvery, flags[exchange]);
    publish_flexible((exchange + 1) * kEvery);
    poll(kMs);
  }
  std::vector<std::size_t> values;
  for (const auto& block : played.received<wire::VariableBlock>(Topic::variables)) {
    if (block.header.phase == Phase::running) values.push_back(block.values.size());
  }
  EXPECT_EQ(values, (std::vector<std::size_t>{1, 1, 0, 0, 1}));
}

TEST_F(FlexNode, FollowsToTheLastStepAfterAFaultAndRequestsNothing) {
  get_ready(ElasticExchange::once);
  played.publish_tick(25, static_cast<std::uint32_t>(TickFlag::end) | static_cast<std::uint32_t>(TickFlag::fault));
  played.publish_status(Role::io, NodeState::running, 25);
  poll(kMs);
  played.forget();
  for (int i = 0; i < 10; ++i) poll(20 * kMs);
  EXPECT_TRUE(played.received<wire::ResendRequest>(Topic::resend).empty());
  publish_flexible(10);
  publish_flexible(20);
  publish_flexible(30);
  poll(kMs);
  EXPECT_EQ(steps_of<wire::ElasticMessage>(Topic::elastic), (std::vector<StepIndex>{10, 20}));
  EXPECT_EQ(node->member().state(), NodeState::running) << "the reason follows in the status of io";
}

TEST_F(FlexNode, RequestsAStateThatIsOverdue) {
  get_ready(ElasticExchange::once);
  played.forget();
  poll(9 * kMs);
  EXPECT_TRUE(played.received<wire::ResendRequest>(Topic::resend).empty());
  publish_flexible(10);
  poll(kMs);
  for (int i = 0; i < 12; ++i) poll(kMs);
  EXPECT_TRUE(played.received<wire::ResendRequest>(Topic::resend).empty());
  poll(3 * kMs);
  const auto requests = played.received<wire::ResendRequest>(Topic::resend);
  ASSERT_EQ(requests.size(), 1u);
  EXPECT_EQ(requests[0].role, Role::mechanics);
  EXPECT_EQ(requests[0].header.step, 20);
}

TEST_F(FlexNode, BeginsAgainAfterAReset) {
  get_ready(ElasticExchange::once);
  publish_flexible(10);
  poll(kMs);
  played.forget();
  wire::Tick init;
  init.header = played.header(Role::io, kJoinStep, Phase::init, 1);
  played.publish(Topic::tick, init);
  poll(kMs);
  EXPECT_EQ(node->member().epoch(), 1u);
  wire::FlexibleMessage message;
  message.header = played.header(Role::mechanics, 0, Phase::running, 1);
  played.publish(Topic::flexible, message);
  poll(kMs);
  EXPECT_EQ(steps_of<wire::ElasticMessage>(Topic::elastic), (std::vector<StepIndex>{kJoinStep, 0}));
}

TEST(NodesWithoutFlexibleBodies, ProveNoTopicOfTheirs) {
  PlayedSession played{bit(Role::io) | bit(Role::mechanics)};
  PhysicsNode node(Role::mechanics, played.transport(), [](const wire::SessionDescription&, BuiltSubsystem& built) {
    built.subsystem = std::make_unique<testing::StillSubsystem>();
    return Status::ok();
  });
  std::int64_t now_ns = 1000 * kMs;
  played.join(node, now_ns, {Topic::mechanism});
  EXPECT_GE(node.member().state(), NodeState::initialising);
  EXPECT_TRUE(played.received<wire::FlexibleMessage>(Topic::flexible).empty());
}

}  // namespace flexible_nodes_test
}  // namespace slew::node
