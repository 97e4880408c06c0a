// SPDX-License-Identifier: Apache-2.0
// End cushions against closed forms, and the split machine against the undivided one.
//
// A mass m without other forces enters a cushion of constant throttle at v_0. Above the transition pressure
//   m v dv/du = -A (A w v/K)^2,   w = min(1, u/e),   u: way since the entry
//   v(u) = v_0 exp(-c (u - 2 e/3)),  c = A^3/(m K^2),  u > e
// with its largest pressure at u = e. With the laminar transition p_t the exact law of the orifice applies:
// dp^2/(dp^2 + p_t^2)^(1/2) = (A w v/K)^2, solved by bisection and integrated by RK4 over the way.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "build_paths.h"
#include "monolith/monolith.h"
#include "tests/support/crane_pair.h"

namespace slew::monolith {
namespace cushion_test {

// 500 kg at 0.8 m/s on a double-rod cylinder between two tanks; 50 mm before the end a 40 mm plunger shuts the port.
const char kSled[] = R"(
scene: cushioned_sled
session: {step: 1 ms, duration: 1 s}
mechanics: {gravity: [0, 0, 0]}
bodies:
  Sled: {position: [1 m, 0, 0], mass: 500 kg, inertia: [10, 10, 10]}
joints:
  Rail: {type: prismatic, point1: [1 m, 0, 0], orientation1: [0, 90 deg, 0], body2: Sled, orientation2: [0, 90 deg, 0],
         initial_velocity: 0.8 m/s}
forces:
  Line: {type: translational, body1: Sled, body2: Ground}
hydraulics: {oil_density: 870 kg/m3, orifice_transition: 0.1 bar}
volumes:
  Tank_A: {fixed: true}
  Tank_B: {fixed: true}
components:
  Cyl:
    type: double_rod_cylinder
    force: Line
    port_a: Tank_A
    port_b: Tank_B
    piston_diameter: 80 mm
    rod_diameter: 30 mm
    piston_length: 50 mm
    chamber_length: 650 mm
    rod_length: 600 mm
    minimum_stroke: 50 mm
    maximum_stroke: 550 mm
    cylinder_coefficient: 1
    cushion_b_length: 50 mm
    cushion_b_entry_length: 2 mm
    cushion_b_plunger_diameter: 40 mm
    cushion_b_orifice_diameter: 8 mm
)";
constexpr double kMass = 500, kSpeed = 0.8, kEnd = 0.55, kLength = 0.05, kEntry = 0.002, kTransition = 1e4;
constexpr double kArea = std::numbers::pi / 4 * (0.08 * 0.08 - 0.04 * 0.04);
const double kConductance = 0.67 * std::numbers::pi / 4 * 0.008 * 0.008 * std::sqrt(2 / 870.0);

double closed_form(double way) {
  const double c = std::pow(kArea, 3) / (kMass * kConductance * kConductance);
  return kSpeed * std::exp(-c * (way - 2 * kEntry / 3));
}

// Pressure that passes the flow of the piston, by bisection of the orifice's law.
double drop_of(double speed, double share) {
  const double Q = share * kArea * speed / kConductance;
  double low = 0, high = 1e9;
  for (int k = 0; k < 80; ++k) {
    const double dp = 0.5 * (low + high);
    (dp / std::pow(dp * dp + kTransition * kTransition, 0.25) < Q ? low : high) = dp;
  }
  return 0.5 * (low + high);
}

double step_speed(double u, double v, double h) {
  const auto slope = [](double at, double speed) {
    return -kArea * drop_of(speed, std::min(1.0, at / kEntry)) / (kMass * speed);
  };
  const double k_1 = slope(u, v), k_2 = slope(u + h / 2, v + h / 2 * k_1), k_3 = slope(u + h / 2, v + h / 2 * k_2);
  return v + h / 6 * (k_1 + 2 * k_2 + 2 * k_3 + slope(u + h, v + h * k_3));
}

// Speed after a way in the cushion, from dv/du = -A dp/(m v): RK4 over parts of 0.1 mm, then over the rest.
double speed_after(double way) {
  static const std::vector<double> speeds = [] {
    std::vector<double> all{kSpeed};
    for (int k = 0; k < 500; ++k) all.push_back(step_speed(1e-4 * k, all.back(), 1e-4));
    return all;
  }();
  const auto part = static_cast<std::size_t>(way / 1e-4);
  const double begin = 1e-4 * static_cast<double>(part);
  return step_speed(begin, speeds[part], way - begin);
}

struct Motion {
  std::vector<double> x, v;
  double pressure = 0;  // largest in the cushion [Pa]
};

// Until the end of the stroke at most.
Motion undivided(const scene::Scene& scene, double seconds) {
  Monolith monolith(scene, {.relative_tolerance = 1e-10, .absolute_tolerance = 1e-10});
  EXPECT_TRUE(monolith.start().is_ok());
  const std::vector<double> controls(scene.inputs.size(), 0.0);
  Motion motion;
  for (std::int64_t k = 1; k * 1e-4 <= seconds && monolith.ports()[0].x < kEnd; ++k) {
    EXPECT_TRUE(monolith.advance_to({k * 100'000}, controls).is_ok());
    motion.x.push_back(monolith.ports()[0].x);
    motion.v.push_back(monolith.ports()[0].v);
    motion.pressure = std::max(motion.pressure, monolith.variable("Cyl.cushion_pressure_b"));
  }
  return motion;
}

double value(coupling::Subsystem& subsystem, std::string_view name) {
  std::vector<double> values(subsystem.variables().size());
  subsystem.read_variables(values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (subsystem.variables()[i].name == name) return values[i];
  }
  ADD_FAILURE() << name;
  return 0;
}

TEST(CushionedCylinder, MassIsBrakedAsTheClosedFormStates) {
  const scene::Scene scene = scene::load_text(kSled, "sled.yaml");
  const Motion motion = undivided(scene, 0.7);
  const double begin = kEnd - kLength;
  ASSERT_GT(motion.x.back(), kEnd);
  for (std::size_t k = 0; k < motion.x.size(); ++k) {
    const double way = motion.x[k] - begin;
    if (way < kEntry || way > kLength) continue;
    EXPECT_NEAR(motion.v[k], speed_after(way), 1e-6 * kSpeed) << way;
    // the transition takes over below a few times its pressure
    if (drop_of(motion.v[k], 1) > 100 * kTransition) EXPECT_NEAR(motion.v[k], closed_form(way), 1e-4 * kSpeed) << way;
  }
  const double highest = 1e5 + std::pow(kArea * closed_form(kEntry) / kConductance, 2);
  EXPECT_NEAR(motion.pressure, highest, 0.01 * highest);
  RecordProperty("peak_bar", std::to_string(1e-5 * motion.pressure));
}

TEST(CushionedCylinder, SplitMachineIsBrakedAsTheClosedFormStatesAtOneAndFiveMilliseconds) {
  for (const char* step : {"1 ms", "5 ms"}) {
    const scene::Scene scene = scene::load_text(kSled, "sled.yaml", {std::string("session.step=") + step});
    slew::testing::CranePair pair(scene);
    pair.start();
    double worst = 0;
    for (int k = 0; k < (step[0] == '1' ? 700 : 140); ++k) {
      pair.step({});
      const double way = pair.mechanics_now.mechanism.x[0] - (kEnd - kLength);
      if (way > kLength) break;
      if (way < kEntry) continue;
      worst = std::max(worst, std::fabs(pair.mechanics_now.mechanism.v[0] - speed_after(way)));
    }
    RecordProperty(std::string("worst_mm_s_") + step[0], std::to_string(1e3 * worst));
    EXPECT_LT(worst, 1e-4 * kSpeed) << step;
    EXPECT_GT(pair.mechanics_now.mechanism.x[0], kEnd - 2e-3);
    // brake and pressure of the sample agree
    const double drop = value(*pair.hydraulics, "Cyl.cushion_pressure_b") - 1e5;
    EXPECT_NEAR(value(*pair.mechanics, "Cyl.cushion_force"), -kArea * drop, 0.01 * kArea * drop + 0.1);
  }
}

TEST(CushionedCylinder, DoesNotThrowBack) {
  const Motion motion = undivided(scene::load_text(kSled, "sled.yaml", {"Cyl.cushion_b_orifice_diameter=2 mm"}), 1);
  for (std::size_t k = 0; k < motion.v.size(); ++k) EXPECT_GE(motion.v[k], -1e-9);
}

// The mass's energy is the heat of the throttle: int f v dt by the variables of the undivided machine.
TEST(CushionedCylinder, EnergyOfTheMassBecomesHeat) {
  const scene::Scene scene = scene::load_text(kSled, "sled.yaml");
  Monolith monolith(scene, {.relative_tolerance = 1e-10, .absolute_tolerance = 1e-10});
  ASSERT_TRUE(monolith.start().is_ok());
  double heat = 0, power_before = 0;
  for (std::int64_t k = 1; monolith.ports()[0].x < kEnd - 1e-3; ++k) {
    ASSERT_TRUE(monolith.advance_to({k * 100'000}, {}).is_ok());
    const double power = -monolith.variable("Cyl.cushion_force") * monolith.ports()[0].v;
    heat += 0.5e-4 * (power + power_before);
    power_before = power;
  }
  const double v = monolith.ports()[0].v, energy = 0.5 * kMass * (kSpeed * kSpeed - v * v);
  EXPECT_NEAR(heat, energy, 1e-4 * energy);
  EXPECT_GT(energy, 0.8 * 0.5 * kMass * kSpeed * kSpeed);
}

// The example: the boom driven into its cushion by the pump, with oil columns behind the port.
TEST(CushionedCylinder, BoomAgreesWithTheUndividedMachineAtOneAndFiveMilliseconds) {
  const std::string file = SLEWRING_SOURCE_DIR "/scenes/single_cylinder_cushion.yaml";
  for (const int step : {1, 5}) {
    const scene::Scene scene = scene::load_file(file, {"session.step=" + std::to_string(step) + " ms"});
    slew::testing::CranePair pair(scene);
    pair.start();
    Monolith monolith(scene);
    ASSERT_TRUE(monolith.start().is_ok());
    double worst_x = 0, worst_v = 0;
    for (std::int64_t k = 0; k * step < 12000; ++k) {
      const double control[] = {k * step >= 200 ? 500.0 : 0.0};
      pair.step(control);
      ASSERT_TRUE(monolith.advance_to({(k + 1) * step * 1'000'000}, control).is_ok());
      worst_x = std::max(worst_x, std::fabs(pair.mechanics_now.mechanism.x[0] - monolith.ports()[0].x));
      worst_v = std::max(worst_v, std::fabs(pair.mechanics_now.mechanism.v[0] - monolith.ports()[0].v));
    }
    RecordProperty("x_um_" + std::to_string(step), std::to_string(1e6 * worst_x));
    RecordProperty("v_mm_s_" + std::to_string(step), std::to_string(1e3 * worst_v));
    EXPECT_GT(monolith.ports()[0].x, 1.05 - 1e-3);
    EXPECT_LT(worst_x, step == 1 ? 1e-6 : 20e-6);
    EXPECT_LT(worst_v, step == 1 ? 5e-5 : 5e-4);
  }
}

}  // namespace cushion_test
}  // namespace slew::monolith
