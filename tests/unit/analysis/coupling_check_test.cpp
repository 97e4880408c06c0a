// SPDX-License-Identifier: Apache-2.0
// Warnings about the step and the coupling levels before a run.
#include "analysis/start_check.h"

#include <gtest/gtest.h>

#include <string>

#include "build_paths.h"
#include "coupling/indicator.h"

namespace slew::analysis {
namespace coupling_check_test {

std::vector<std::string> warnings(const std::string& file, const scene::Overrides& overrides) {
  return start_warnings(scene::load_file(SLEWRING_SOURCE_DIR "/scenes/" + file, overrides));
}

TEST(CouplingCheck, HasNoWarningForTheScenes) {
  for (const char* file :
       {"truck_crane.yaml", "single_cylinder.yaml", "tipper.yaml", "four_bar.yaml", "truck_crane_flexible.yaml"}) {
    EXPECT_EQ(warnings(file, {}), std::vector<std::string>()) << file;
  }
}

TEST(CouplingCheck, NamesThePortAndAStepThatSuitsTheLevel) {
  // the crane's omega_H is 0.1 at 1 ms (docs/coupling-results.md)
  const auto two = warnings("truck_crane.yaml", {"session.step=20 ms"});
  ASSERT_EQ(two.size(), 1u);
  EXPECT_NE(two[0].find("Cyl_Jib: omega_H"), std::string::npos) << two[0];
  EXPECT_NE(two[0].find("level 'two' is valid up to 1"), std::string::npos) << two[0];
  EXPECT_NE(two[0].find("use session.step"), std::string::npos) << two[0];
  EXPECT_EQ(warnings("truck_crane.yaml", {"session.step=5 ms"}).size(), 0u);
  EXPECT_EQ(warnings("truck_crane.yaml", {"session.step=10 ms", "session.coupling=linear"}).size(), 1u);
  EXPECT_EQ(warnings("truck_crane.yaml", {"session.step=2 ms", "session.coupling=linear"}).size(), 0u);
}

TEST(CouplingCheck, TheStepThatItNamesIsBelowTheLimit) {
  const auto before = warnings("truck_crane.yaml", {"session.step=20 ms"});
  ASSERT_EQ(before.size(), 1u);
  const std::size_t from = before[0].find("session.step ") + 13;
  const std::string step = before[0].substr(from, before[0].find(" or less") - from);
  EXPECT_EQ(warnings("truck_crane.yaml", {"session.step=" + step}).size(), 0u) << step;
}

TEST(CouplingCheck, LooksAtEveryLevelForItself) {
  // hold is beyond its limit on any machine that swings; a line is heavy at long steps
  const auto mixed =
      warnings("truck_crane.yaml", {"session.step=10 ms", "Cyl_Jib.coupling=hold", "Cyl_Lift.coupling=tlm"});
  ASSERT_EQ(mixed.size(), 2u);
  EXPECT_NE(mixed[0].find("Cyl_Jib: omega_H"), std::string::npos) << mixed[0];
  EXPECT_NE(mixed[0].find("level 'hold'"), std::string::npos) << mixed[0];
  EXPECT_NE(mixed[1].find("Cyl_Lift: level 'tlm' gives it a parasitic mass of"), std::string::npos) << mixed[1];
  EXPECT_EQ(warnings("truck_crane.yaml", {"session.coupling=tlm", "session.step=0.2 ms"}).size(), 0u);
}

TEST(CouplingCheck, FreeRunningIsWarnedOfTheStepForItsLateSamples) {
  // omega_H of the flexible crane is 0.37 at its start in steps of 1 ms, of the rigid one 0.1
  EXPECT_EQ(warnings("truck_crane.yaml", {"session.mode=free_running"}).size(), 0u);
  const auto flexible =
      warnings("truck_crane_flexible.yaml", {"session.mode=free_running", "session.coupling_alarm=warn"});
  ASSERT_EQ(flexible.size(), 1u);
  EXPECT_NE(flexible[0].find("free_running works with samples that are a step or more late"), std::string::npos)
      << flexible[0];
  EXPECT_NE(flexible[0].find("use session.step 800 us or less, or session.mode lockstep"), std::string::npos)
      << flexible[0];
  EXPECT_EQ(warnings("truck_crane_flexible.yaml", {"session.mode=free_running", "session.step=0.5 ms"}).size(), 0u);
}

std::string refusal(const std::string& file, const scene::Overrides& overrides) {
  const scene::Scene scene = scene::load_file(SLEWRING_SOURCE_DIR "/scenes/" + file, overrides);
  return session::DirectSession(scene).start().text;
}

TEST(CouplingCheck, WhatNoExchangeCanFollowDoesNotStart) {
  const char* const crane = "two_dof_crane.yaml";  // 210 rad/s on its oil
  const std::string fast = refusal(crane, {"session.step=20 ms"});
  EXPECT_NE(fast.find("session.coupling: the oil-spring oscillation has omega_H = 4.2"), std::string::npos) << fast;
  EXPECT_NE(fast.find("above the Nyquist limit of the exchange"), std::string::npos) << fast;
  EXPECT_EQ(refusal(crane, {"session.step=10 ms"}), "");
  EXPECT_EQ(refusal(crane, {"session.step=20 ms", "session.coupling_alarm=warn"}), "");
  for (const char* level : {"hold", "tlm"}) {
    EXPECT_EQ(refusal(crane, {"session.step=20 ms", std::string("session.coupling=") + level}), "") << level;
  }
  const std::string seldom = refusal(crane, {"session.step=1 ms", "session.exchange_every=20"});
  EXPECT_NE(seldom.find("Set the time between two exchanges below 15 ms"), std::string::npos) << seldom;
}

TEST(CouplingCheck, FreeRunningDoesNotStartWhereCopiesAreNoGood) {
  const std::string late = refusal("truck_crane_flexible.yaml", {"session.mode=free_running"});
  EXPECT_NE(late.find("omega_H = 0.37"), std::string::npos) << late;
  EXPECT_NE(late.find("session.mode: lockstep"), std::string::npos) << late;
  EXPECT_EQ(refusal("truck_crane_flexible.yaml", {"session.mode=free_running", "session.step=0.5 ms"}), "");
  EXPECT_EQ(refusal("truck_crane.yaml", {"session.mode=free_running"}), "");
}

TEST(OmegaLimit, GrowsFromHoldToTlm) {
  using coupling::Level;
  EXPECT_LT(coupling::omega_limit(Level::hold, 0.02), coupling::omega_limit(Level::linear, 0.02));
  EXPECT_LT(coupling::omega_limit(Level::linear, 0.02), coupling::omega_limit(Level::two, 0.02));
  EXPECT_GT(coupling::omega_limit(Level::tlm, 0.02), 1e9);
}

}  // namespace coupling_check_test
}  // namespace slew::analysis
