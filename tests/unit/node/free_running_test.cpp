// SPDX-License-Identifier: Apache-2.0
// A free-running node without its partner's samples and without io's ticks; the test plays both.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "node/physics_node.h"
#include "tests/support/played_session.h"

namespace slew::node {
namespace free_running_test {

using testing::kMs;
using testing::PlayedSession;
using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::TickFlag;
using wire::Topic;

// Calls of the subsystem by the node.
struct Done {
  StepIndex step = 0;
  StepIndex age = 0;
  double control = 0;
};

class Witness final : public testing::StillSubsystem {
 public:
  explicit Witness(std::vector<Done>& done, std::vector<std::pair<StepIndex, std::string>>& changes)
      : done_(done), changes_(changes) {}
  StepReport step(StepIndex n, const coupling::PartnerSamples& partners, std::span<const double> controls,
                  coupling::OwnSample&) noexcept override {
    done_.push_back({n, partners.actuators_age, controls.empty() ? -1 : controls[0]});
    return {};
  }
  bool change_parameter(StepIndex n, const coupling::ParameterChange& change) noexcept override {
    changes_.emplace_back(n, change.path);
    return true;
  }

 private:
  std::vector<Done>& done_;
  std::vector<std::pair<StepIndex, std::string>>& changes_;
};

constexpr StepIndex kWindow = 3;

class FreeRunning : public ::testing::Test {
 protected:
  void SetUp() override {
    played.session.window = kWindow;
    played.join(node, now_ns, {Topic::mechanism});
    played.publish_actuators(0);
    poll(kMs);
    ASSERT_EQ(node.member().state(), NodeState::ready);
    played.publish_status(Role::hydraulics, NodeState::ready, 0);
    played.publish_status(Role::io, NodeState::running, 0);
    poll();
    publish_tick(0, 0.5);
    poll();
    ASSERT_EQ(done.size(), 1u);
  }
  void poll(std::int64_t after_ns = 0) { node.poll(now_ns += after_ns); }
  void publish_tick(StepIndex step, double control, const char* parameter = nullptr, std::uint32_t flags = 0) {
    wire::Tick tick;
    tick.header = played.header(Role::io, step);
    tick.flags = flags;
    tick.controls.push_back(control);
    if (parameter != nullptr) tick.commands.push_back({0, parameter, 1, 0});
    played.publish(Topic::tick, tick);
  }
  std::vector<wire::MechanismMessage> samples() { return played.received<wire::MechanismMessage>(Topic::mechanism); }

  std::vector<Done> done;
  std::vector<std::pair<StepIndex, std::string>> changes;
  PlayedSession played{bit(Role::io) | bit(Role::mechanics) | bit(Role::hydraulics)};
  PhysicsNode node{Role::mechanics, played.transport(), [this](const wire::SessionDescription&, BuiltSubsystem& built) {
                     built.subsystem = std::make_unique<Witness>(done, changes);
                     built.session.mode = scene::ExchangeMode::free_running;
                     built.session.wait_budget = 0.5e-3;
                     return Status::ok();
                   }};
  std::int64_t now_ns = 1000 * kMs;
};

TEST_F(FreeRunning, WaitsForASampleNoLongerThanItsBudget) {
  samples();
  publish_tick(1, 0.6);
  poll(kMs);
  EXPECT_EQ(done.size(), 1u);
  EXPECT_EQ(node.next_deadline(now_ns), now_ns + kMs / 2);
  poll(kMs / 2);
  ASSERT_EQ(done.size(), 2u);
  EXPECT_EQ(done[1].age, 1);
  EXPECT_EQ(done[1].control, 0.6);
  const auto published = samples();
  ASSERT_EQ(published.size(), 1u);
  EXPECT_EQ(published[0].header.step, 2);
  EXPECT_EQ(published[0].state.used_step, 0);
  EXPECT_EQ(published[0].state.quality, coupling::Quality::extrapolated);
}

TEST_F(FreeRunning, TakesASampleThatIsThereAtOnce) {
  samples();
  played.publish_actuators(1);
  publish_tick(1, 0.6);
  poll(kMs);
  ASSERT_EQ(done.size(), 2u);
  EXPECT_EQ(done[1].age, 0);
  const auto published = samples();
  ASSERT_EQ(published.size(), 1u);
  EXPECT_EQ(published[0].state.used_step, 1);
  EXPECT_EQ(published[0].state.quality, coupling::Quality::ok);
  EXPECT_EQ(published[0].state.lost, 0u);
}

TEST_F(FreeRunning, UsesTheNewestSampleAndCountsThoseThatNoStepUsed) {
  for (StepIndex step = 1; step <= 3; ++step) {
    publish_tick(step, 0);
    poll(kMs);
    poll(kMs / 2);
  }
  ASSERT_EQ(done.size(), 4u);
  EXPECT_EQ(done[3].age, 3);
  // sample 2 comes late, sample 1 never
  played.publish_actuators(2);
  publish_tick(4, 0);
  poll(kMs);
  poll(kMs / 2);
  ASSERT_EQ(done.size(), 5u);
  EXPECT_EQ(done[4].age, 2);
  EXPECT_EQ(samples().back().state.lost, 1u);
}

TEST_F(FreeRunning, GoesOnWithoutATickAtItsTimeByTheLastInputs) {
  played.publish_actuators(1);
  poll(kMs);  // tick 1 would come now
  EXPECT_EQ(done.size(), 1u);
  poll(kMs / 2);
  ASSERT_EQ(done.size(), 2u);
  EXPECT_EQ(done[1].control, 0.5);
}

TEST_F(FreeRunning, AppliesTheCommandsOfALateTickOnceInTheNextStep) {
  played.publish_actuators(1);
  poll(kMs + kMs / 2);
  ASSERT_EQ(done.size(), 2u);
  publish_tick(1, 0.7, "Bag.mass");
  publish_tick(1, 0.7, "Bag.mass");
  poll(kMs / 4);
  played.publish_actuators(2);
  publish_tick(2, 0.8);
  poll(kMs / 4);
  ASSERT_EQ(done.size(), 3u);
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_EQ(changes[0], std::pair(StepIndex{2}, std::string("Bag.mass")));
}

TEST_F(FreeRunning, BeginsAnEpochWithNothingOfTheFormer) {
  poll(3 * kMs / 2);  // step 1 without its tick
  publish_tick(1, 0.7, "Bag.mass");
  wire::Tick init;
  init.header = played.header(Role::io, kJoinStep, Phase::init, 1);
  played.publish(Topic::tick, init);
  played.publish_actuators(0, Phase::running, 1);
  poll(kMs);
  poll(kMs);
  ASSERT_EQ(node.member().state(), NodeState::ready);
  wire::NodeStatus io = played.status(Role::io, NodeState::running, 0);
  io.header.epoch = 1;
  played.publish(Topic::node_status, io);
  samples();
  done.clear();
  wire::Tick tick;
  tick.header = played.header(Role::io, 0, Phase::running, 1);
  played.publish(Topic::tick, tick);
  poll(kMs);
  ASSERT_EQ(done.size(), 1u);
  EXPECT_EQ(done[0].step, 0);
  EXPECT_EQ(done[0].control, -1) << "no control of the former epoch";
  EXPECT_TRUE(changes.empty());
  const auto published = samples();
  ASSERT_EQ(published.size(), 1u);
  EXPECT_EQ(published[0].state.used_step, 0);
  EXPECT_EQ(published[0].state.lost, 0u);
}

TEST_F(FreeRunning, RequestsAMissedTick) {
  poll(kMs + kMs / 2);
  poll(kMs / 2);
  ASSERT_EQ(done.size(), 2u);
  static_cast<void>(played.received<wire::ResendRequest>(Topic::resend));
  poll(4 * kMs);
  poll(4 * kMs);
  const auto requests = played.received<wire::ResendRequest>(Topic::resend);
  ASSERT_FALSE(requests.empty());
  EXPECT_EQ(requests[0].role, Role::io);
  EXPECT_EQ(requests[0].header.step, 1);
}

TEST_F(FreeRunning, IsNotFurtherAheadOfTheTicksThanTheWindow) {
  for (int i = 0; i < 20; ++i) poll(kMs);
  EXPECT_EQ(done.size(), 1u + static_cast<std::size_t>(kWindow));
}

TEST_F(FreeRunning, StandsStillWhileIoWithholdsTicks) {
  wire::NodeStatus holding = played.status(Role::io, NodeState::holding, 1);
  played.publish(Topic::node_status, holding);
  for (int i = 0; i < 20; ++i) poll(kMs);
  EXPECT_EQ(done.size(), 1u);
}

TEST_F(FreeRunning, EndsAtAnEndThatComesAfterItsStep) {
  played.publish_actuators(1);
  poll(kMs + kMs / 2);
  ASSERT_EQ(done.size(), 2u);
  publish_tick(1, 0, nullptr, static_cast<std::uint32_t>(TickFlag::end));
  poll(kMs / 4);
  EXPECT_EQ(node.member().state(), NodeState::ended);
  EXPECT_EQ(node.member().exit_code(), ExitCode::ok);
}

TEST_F(FreeRunning, CatchesUpWithoutWaitingWhenItIsBehindTheTicks) {
  for (StepIndex step = 1; step <= 5; ++step) publish_tick(step, 0);
  played.publish_actuators(3);
  poll(5 * kMs);
  // the last one has time to wait for its sample
  ASSERT_EQ(done.size(), 5u);
  EXPECT_EQ(done[2].age, 2);
  EXPECT_EQ(done[3].age, 0);
  EXPECT_EQ(done[4].age, 1);
}

}  // namespace free_running_test
}  // namespace slew::node
