// SPDX-License-Identifier: Apache-2.0
#include "free_running.h"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <string_view>
#include <thread>

#include "namespaces.h"

namespace slew::testing {

using coupling::Quality;
using wire::Role;

double largest_eta(const RecordedSession& recorded) {
  double largest = -1;
  for (const auto& [name, value] : recorded.largest) {
    if (name.find(".coupling_eta") != std::string::npos) largest = std::max(largest, value);
  }
  return largest;
}

RecordedSession run_with_a_partner_that_stands_still() {
  Session session({"--pace", "real", "--duration", "3s", "--set", "session.mode=free_running"});
  session.start_all();
  EXPECT_TRUE(session.observer().wait_for_step(1000)) << session.errors();
  session.node(Role::hydraulics).send(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  session.node(Role::hydraulics).send(SIGCONT);
  EXPECT_EQ(session.wait_all(), all_ok()) << session.errors();
  return session.recorded();
}

LossyRun run_over_a_lossy_cable(std::int64_t seconds) {
  NamespacePair cable;
  if (!cable.problem().empty()) return {"network namespaces are not possible here: " + cable.problem(), {}, 0};
  Session session(
      {"--pace", "real", "--duration", std::to_string(seconds) + "s", "--set", "session.mode=free_running"});
  for (const Role role : kAllNodes) {
    const bool is_left = role == Role::mechanics || role == Role::recorder;
    const NamespacePair::Side& here = is_left ? cable.left() : cable.right();
    const NamespacePair::Side& there = is_left ? cable.right() : cable.left();
    std::vector<std::string> arguments = {"--interface", here.interface, "--peer", there.address, "--insecure-lan"};
    if (std::string_view(SLEWRING_SANITIZER).empty()) arguments.emplace_back("--rt");
    session.run_under(role, here.command(), arguments);
  }
  if (!cable.lose(1)) return {"packets cannot be lost here: " + cable.problem(), {}, 0};
  session.start_all();
  EXPECT_EQ(session.wait_all(1'000'000'000 * (seconds + 60)), all_ok()) << session.errors();
  EXPECT_GT(cable.lost(cable.left()), 0u) << "nothing was lost: the test shows nothing";
  EXPECT_GT(cable.lost(cable.right()), 0u) << "nothing was lost: the test shows nothing";
  LossyRun run{"", session.recorded(), 0};
  EXPECT_EQ(run.recorded.problem, "");
  run.late =
      count(run.recorded.mechanisms, Quality::extrapolated) + count(run.recorded.actuators, Quality::extrapolated);
  ::testing::Test::RecordProperty("late", std::to_string(run.late));
  ::testing::Test::RecordProperty("degraded", std::to_string(count(run.recorded.mechanisms, Quality::degraded)));
  ::testing::Test::RecordProperty("eta", std::to_string(largest_eta(run.recorded)));
  EXPECT_GE(largest_eta(run.recorded), 0);
  return run;
}

}  // namespace slew::testing
