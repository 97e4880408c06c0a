// SPDX-License-Identifier: Apache-2.0
// Cylinders on common volumes: start, liftable load and load chart by the balance of forces and moments, and by runs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "analysis/description/instant.h"
#include "analysis/description/liftable_load.h"
#include "analysis/load_chart/load_chart.h"
#include "analysis/start_check.h"
#include "build_paths.h"
#include "core/failure.h"

namespace slew::analysis {
namespace common_volume_loads_test {

const std::string kFolder = SLEWRING_SOURCE_DIR "/tests/unit/analysis/";
const std::string kPair = kFolder + "boom_on_two_cylinders.yaml", kSeries = kFolder + "lifts_in_series.yaml";

double disc(double diameter) {
  return std::numbers::pi / 4 * diameter * diameter;
}

// Load [kg] of boom_on_two_cylinders.yaml, balance of moments about the foot: the cylinders' common line acts on
// (1, -0.1) m along (0.5, 1). The pump holds 180 bar over the tank's 2 bar in A, B is at tank. Friction at 50 mm/s.
double by_hand(double right_diameter) {
  double sum = 0;
  for (const double diameter : {0.08, right_diameter}) {
    const double F = 182e5 * disc(diameter) - 2e5 * (disc(diameter) - disc(0.045));
    const double f = 0.5 + 0.5 * (0.05 - 1e-4) / (0.5 - 1e-4);
    sum += F - (F * (1 - 0.92) * f + 700);
  }
  const double arm = (1.0 * 1.0 + 0.1 * 0.5) / std::hypot(0.5, 1.0);
  return (sum * arm / 9.81 - 300 * 1.5) / 3;
}

double foot(const PlayedScene& played) {
  const coupling::Subsystem& mechanics = *played.session().subsystem(wire::Role::mechanics);
  std::vector<double> values(mechanics.variables().size());
  mechanics.read_variables(values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (mechanics.variables()[i].name == "Foot.position") return values[i];
  }
  ADD_FAILURE() << "Foot.position";
  return 0;
}

// angle that the boom rises by from 1 s to 5 s, its lever pushed
double rise(const std::string& right, double mass) {
  const scene::Scene scene = scene::load_file(kPair, {"right=" + right, "Load.mass=" + std::to_string(mass)});
  PlayedScene played(scene);
  play_to(played, 1);
  const double before = foot(played);
  play_to(played, 5);
  return std::fabs(foot(played) - before);
}

TEST(CommonVolumeLoads, OfAPairOfAnySizeAreTheBalanceOfMomentsAtThePumpsCutOff) {
  for (const auto& [right, diameter] : {std::pair("60 mm", 0.06), std::pair("80 mm", 0.08)}) {
    scene::Scene scene = scene::load_file(kPair, {std::string("right=") + right});
    const LiftableLoad found = find_liftable(scene, {}, ListedSettings::named);
    ASSERT_TRUE(found.has_answer()) << found.refusal;
    const LiftingPort& port = found.limit();
    EXPECT_NEAR(port.load, by_hand(diameter), 0.003 * port.load) << right;
    EXPECT_NEAR(port.pressure, 182e5, 0.3e5) << "the cut-off, no overshoot up to the relief valve's 230 bar";
    ASSERT_FALSE(port.settings.empty());
    EXPECT_EQ(port.settings[0].path, "Pump.maximum_pressure");
    EXPECT_EQ(port.with, std::vector<std::string>{"Right_Cylinder"});
    EXPECT_GT(rise(right, 0.97 * port.load), 0.03);
    EXPECT_LT(rise(right, 1.03 * port.load), 0.01);
  }
}

TEST(CommonVolumeLoads, OfAPairAreTheSameInTheLoadChart) {
  const LoadChart chart =
      find_load_chart({.scene = kPair, .over = {"Foot=0deg,5deg"}}, [](std::string_view, double) { return true; });
  ASSERT_EQ(chart.poses.size(), 2u);
  EXPECT_NEAR(chart.poses[0].load, by_hand(0.06), 0.003 * chart.poses[0].load);
}

TEST(CommonVolumeLoads, OfCylindersInSeriesAreRefusedByName) {
  scene::Scene scene = scene::load_file(kSeries, {});
  const LiftableLoad found = find_liftable(scene, {}, ListedSettings::left_out);
  EXPECT_FALSE(found.has_answer());
  EXPECT_NE(found.refusal.find("Master and Slave share M"), std::string::npos) << found.refusal;
  try {
    static_cast<void>(find_load_chart({.scene = kSeries, .over = {"Slave_Guide=0m,0.1m"}},
                                      [](std::string_view, double) { return true; }));
    ADD_FAILURE();
  } catch (const Failure& failure) {
    EXPECT_NE(std::string(failure.what()).find("Master and Slave share M"), std::string::npos) << failure.what();
  }
}

TEST(CommonVolumeLoads, CylindersInSeriesStandAtTheStart) {
  const scene::Scene scene = scene::load_file(kSeries, {});
  EXPECT_EQ(start_warnings(scene), std::vector<std::string>());
  PlayedScene played(scene);
  play_to(played, 0.5);
  const coupling::MechanismSample& mechanism = played.session().mechanism();
  for (const double v : mechanism.v.span()) EXPECT_NEAR(v, 0, 1e-9);
}

// both lifts on the same two volumes: 2 t and 3 t are not held by one pair of pressures
TEST(CommonVolumeLoads, AStartThatPressuresCannotHoldIsAWarningWithTheMissingForces) {
  const std::vector<std::string> warnings =
      start_warnings(scene::load_file(kSeries, {"Master.port_b=B", "Slave.port_a=A", "Slave.piston_diameter=80mm",
                                                "Slave.rod_diameter=45mm", "Slave_Load.mass=3t"}));
  ASSERT_EQ(warnings.size(), 1u);
  for (const char* part : {"Master lacks -4.905 kN of 19.62 kN", "Slave lacks 4.905 kN of 29.43 kN"}) {
    EXPECT_NE(warnings[0].find(part), std::string::npos) << warnings[0];
  }
}

}  // namespace common_volume_loads_test
}  // namespace slew::analysis
