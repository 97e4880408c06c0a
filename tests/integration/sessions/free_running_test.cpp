// Free-running sessions of real processes: nobody waits longer than the budget.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <string_view>
#include <thread>

#include "coupling/indicator.h"
#include "namespaces.h"
#include "node/identity.h"
#include "session.h"

namespace slew::testing {
namespace {

using coupling::Quality;
using wire::Role;

const char* seconds() {
  return std::getenv("SLEWRING_NIGHTLY") != nullptr ? "600" : "6";
}

template <typename Messages>
std::int64_t count(const Messages& messages, Quality quality) {
  return std::count_if(messages.begin(), messages.end(),
                       [&](const auto& message) { return message.state.quality == quality; });
}

double largest_eta(const RecordedSession& recorded) {
  double largest = -1;
  for (const auto& [name, value] : recorded.largest) {
    if (name.find(".coupling_eta") != std::string::npos) largest = std::max(largest, value);
  }
  return largest;
}

TEST(FreeRunning, BridgesAPartnerThatStandsStillForAWhile) {
  Session session({"--pace", "real", "--duration", "3s", "--set", "session.mode=free_running"});
  session.start_all();
  ASSERT_TRUE(session.observer().wait_for_step(1000)) << session.said();
  session.node(Role::hydraulics).send(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  session.node(Role::hydraulics).send(SIGCONT);
  ASSERT_EQ(session.wait_all(), all_ok()) << session.said();
  const RecordedSession recorded = session.recorded();
  EXPECT_EQ(recorded.problem, "");
  EXPECT_EQ(recorded.last_complete_step(), 3000);
  // the mechanics went on by its copy, and took up the samples again
  EXPECT_GT(count(recorded.mechanisms, Quality::extrapolated) + count(recorded.mechanisms, Quality::degraded), 5);
  EXPECT_GT(count(recorded.mechanisms, Quality::ok), 1000);
  for (const wire::MechanismMessage& sample : recorded.mechanisms) {
    EXPECT_LE(sample.state.used_step, sample.header.step - 1);
  }
  EXPECT_GE(recorded.largest.at("mechanics.partner_age"), 5);
}

TEST(FreeRunning, OverACableThatLosesOnePercentIsGreenOrAmber) {
  const bool is_fast = std::string_view(SLEWRING_SANITIZER).empty();
  NamespacePair cable;
  if (!cable.problem().empty()) GTEST_SKIP() << "network namespaces are not possible here: " << cable.problem();
  Session session({"--pace", "real", "--duration", std::string(seconds()) + "s", "--set", "session.mode=free_running"});
  for (const Role role : kAllNodes) {
    const bool is_left = role == Role::mechanics || role == Role::recorder;
    const NamespacePair::Side& here = is_left ? cable.left() : cable.right();
    const NamespacePair::Side& there = is_left ? cable.right() : cable.left();
    std::vector<std::string> arguments = {"--interface", here.interface, "--peer", there.address, "--insecure-lan"};
    // beside other tests the processor would be what is lost; with a sanitizer nobody else would get any
    if (is_fast) arguments.emplace_back("--rt");
    session.run_under(role, here.command(), arguments);
  }
  if (!cable.lose(1)) GTEST_SKIP() << "packets cannot be lost here: " << cable.problem();
  session.start_all();
  ASSERT_EQ(session.wait_all(std::int64_t{1'000'000'000} * (std::atoi(seconds()) + 60)), all_ok()) << session.said();
  const RecordedSession recorded = session.recorded();
  EXPECT_EQ(recorded.problem, "");
  const std::int64_t late =
      count(recorded.mechanisms, Quality::extrapolated) + count(recorded.actuators, Quality::extrapolated);
  RecordProperty("late", std::to_string(late));
  RecordProperty("degraded", std::to_string(count(recorded.mechanisms, Quality::degraded)));
  RecordProperty("eta", std::to_string(largest_eta(recorded)));
  EXPECT_GT(late, 0) << "nothing was lost: the test shows nothing";
  EXPECT_GE(largest_eta(recorded), 0);
  // with a sanitizer the nodes themselves are later than what the cable loses
  if (is_fast) {
    EXPECT_LT(largest_eta(recorded), coupling::kAmberBelow);
  }
}

}  // namespace
}  // namespace slew::testing
