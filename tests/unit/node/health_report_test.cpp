// SPDX-License-Identifier: Apache-2.0
// The health message, and that nodes on one thread send it as well.
#include "node/health_report.h"

#include <gtest/gtest.h>

#include "core/time.h"
#include "node/driver.h"
#include "tests/support/played_session.h"

namespace slew::node {
namespace health_report_test {

using testing::PlayedSession;
using wire::Role;
using wire::Topic;

// A node without work that finishes when its health message has arrived.
class IdleNode final : public Node {
 public:
  explicit IdleNode(PlayedSession& played) : played_(played), member_(Role::mechanics, played.transport(), {}) {}
  void join() {
    ASSERT_TRUE(member_.adopt(played_.session, 0).is_ok());
    health().has_session = true;
  }
  bool poll(std::int64_t) override {
    is_finished_ = !played_.received<wire::Health>(Topic::health).empty() || monotonic_ns() > deadline_ns_;
    return false;
  }
  [[nodiscard]] std::int64_t next_deadline(std::int64_t now_ns) const override { return now_ns + testing::kMs; }
  [[nodiscard]] bool is_finished() const override { return is_finished_; }
  void request_stop(ExitCode) override { is_finished_ = true; }
  [[nodiscard]] SessionMember& member() override { return member_; }
  [[nodiscard]] bool is_late() const { return monotonic_ns() > deadline_ns_; }

 private:
  PlayedSession& played_;
  SessionMember member_;
  bool is_finished_ = false;
  std::int64_t deadline_ns_ = monotonic_ns() + 30'000'000'000;
};

TEST(HealthReport, PublishesNothingBeforeTheNodeHasASession) {
  PlayedSession played{0};
  IdleNode node(played);
  HealthReport report(node);
  report.send();
  EXPECT_TRUE(played.received<wire::Health>(Topic::health).empty());
}

TEST(HealthReport, GivesTheMeanAndTheLargestStepTimeSinceTheLastOne) {
  PlayedSession played{0};
  IdleNode node(played);
  node.join();
  HealthReport report(node);
  HealthState& h = node.health();
  h.step = 7;
  h.slip_ns = 5;
  h.refused = 3;
  h.steps_done = 10;
  h.step_time_sum_ns = 10'000'000;
  h.step_time_max_ns = 3'000'000;
  report.send();
  h.steps_done = 14;
  h.step_time_sum_ns = 18'000'000;
  h.step_time_max_ns = 2'500'000;
  report.send();
  report.send();
  const auto published = played.received<wire::Health>(Topic::health);
  ASSERT_EQ(published.size(), 3u);
  EXPECT_EQ(published[0].header.step, 7);
  EXPECT_EQ(published[0].slip_ns, 5);
  EXPECT_EQ(published[0].refused_messages, 3u);
  EXPECT_DOUBLE_EQ(published[0].step_time_mean, 1e-3);
  EXPECT_DOUBLE_EQ(published[0].step_time_max, 3e-3);
  EXPECT_DOUBLE_EQ(published[1].step_time_mean, 2e-3);
  EXPECT_DOUBLE_EQ(published[1].step_time_max, 2.5e-3);
  EXPECT_EQ(published[2].step_time_mean, 0);
  EXPECT_EQ(published[2].step_time_max, 0);
}

// Number of polls without an alarm before the first one, at most `most`.
int polls_until_it_stands(LoopWatch& watch, int most = 100) {
  int polls = 0;
  while (polls < most && !watch.poll()) ++polls;
  return polls;
}

constexpr auto kPolls = static_cast<int>(kLoopStalled.ns / kHealthInterval.ns);

TEST(LoopWatch, SeesALoopThatDoesNotComeRound) {
  HealthState loop;
  loop.state = static_cast<std::uint8_t>(wire::NodeState::running);
  LoopWatch watch(loop);
  for (int i = 0; i < 50; ++i) {
    loop.turn();
    EXPECT_FALSE(watch.poll());
  }
  EXPECT_EQ(polls_until_it_stands(watch), kPolls - 1);
  EXPECT_EQ(watch.stood_for().ns, kLoopStalled.ns);
  EXPECT_TRUE(watch.poll());
  // each step is a sign of life too: a node that catches up does many of them in one turn
  ++loop.steps_done;
  EXPECT_FALSE(watch.poll());
  EXPECT_EQ(watch.stood_for().ns, 0);
}

TEST(LoopWatch, LetsALoopStandWhereItMay) {
  HealthState loop;
  LoopWatch watch(loop);
  for (const wire::NodeState state : {wire::NodeState::checking, wire::NodeState::joining,
                                      wire::NodeState::initialising, wire::NodeState::ended, wire::NodeState::fault}) {
    loop.state = static_cast<std::uint8_t>(state);
    EXPECT_EQ(polls_until_it_stands(watch), 100) << static_cast<int>(state);
  }
  loop.state = static_cast<std::uint8_t>(wire::NodeState::running);
  {
    const DiskWait outer(loop);
    { const DiskWait inner(loop); }
    EXPECT_EQ(polls_until_it_stands(watch), 100);
  }
  EXPECT_EQ(polls_until_it_stands(watch), kPolls - 1);
}

TEST(LoopWatch, GoesByTheStepsOfALargeModel) {
  HealthState loop;
  loop.state = static_cast<std::uint8_t>(wire::NodeState::running);
  loop.steps_done = 10;
  loop.step_time_sum_ns = 10 * 200'000'000ll;
  LoopWatch watch(loop);
  EXPECT_FALSE(watch.poll());
  EXPECT_EQ(polls_until_it_stands(watch), kStepsOfALoop * 2 - 1);
}

TEST(RunTogether, SendsTheHealthOfItsNodes) {
  PlayedSession played{0};
  IdleNode node(played);
  node.join();
  Node* const nodes[] = {&node};
  EXPECT_EQ(run_together(nodes, {}), ExitCode::ok);
  EXPECT_FALSE(node.is_late()) << "no health message arrived";
}

}  // namespace health_report_test
}  // namespace slew::node
