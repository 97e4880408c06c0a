// SPDX-License-Identifier: Apache-2.0
// A mass that runs into a force element which acts on one side only: the speed that it comes back with against the
// closed form of the half swing. Under `augmented` from touches that the step resolves to those of a thousandth of it,
// under explicit rules up to the limit of their stability.
//
// An end damper pushes with k x + c v while that is positive: exp(-zeta phi/r), phi = atan2(2 zeta r, 2 zeta^2 - 1), r
// = sqrt(1 - zeta^2). Ropes and tyres carry at most twice the spring (limited_damper.h): x'' = -(x + min(x, max(-x, 2
// zeta x'))) integrated by Runge-Kutta in steps of 1e-4 outside of this program.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <tuple>
#include <utility>

#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace touch_test {

using testing::Formulated;

constexpr double kStep = 1e-3, kMass = 1, kSpeed = 1, kStart = 2, kGap = 0.01;
constexpr int kPhases = 8;

enum class Kind { min_length, max_length, angle, rope, tyre };
constexpr const char* kNames[] = {"min_length", "max_length", "angle", "rope", "tyre"};

TranslationalForceDef line() {
  return {.name = "F", .body1 = "Ground", .body2 = "B"};
}

// a hinged body of 1 kg m2
MechanicsDef hinged(double k, double c, double gap) {
  MechanicsDef def;
  def.gravity = {};
  def.bodies.push_back({.name = "B", .mass = kMass, .inertia = {1, 1, 1}});
  def.joints.push_back({.name = "J", .body2 = "B", .initial_velocity = -kSpeed});
  def.rotational_forces.push_back({.name = "F",
                                   .body1 = "Ground",
                                   .f1 = {1, 0, 0},
                                   .g1 = {0, 1, 0},
                                   .body2 = "B",
                                   .f2 = {1, 0, 0},
                                   .min_angle = -gap,
                                   .end_spring_constant = k,
                                   .end_damping_constant = c});
  return def;
}

// a body of 1 kg on a slider along y, at 2 m with 1 m/s
MechanicsDef sliding(double mass, double speed) {
  MechanicsDef def;
  def.gravity = {};
  def.bodies.push_back({.name = "B", .position = {0, kStart, 0}, .mass = mass, .inertia = {1, 1, 1}});
  def.joints.push_back({.name = "J",
                        .type = JointType::prismatic,
                        .orientation1 = {-M_PI / 2, 0, 0},
                        .body2 = "B",
                        .point2 = {0, -kStart, 0},
                        .orientation2 = {-M_PI / 2, 0, 0},
                        .initial_velocity = speed});
  return def;
}

MechanicsDef scene(Kind kind, double k, double c, double gap) {
  if (kind == Kind::angle) return hinged(k, c, gap);
  const bool is_outwards = kind == Kind::max_length || kind == Kind::rope;
  MechanicsDef def = sliding(kind == Kind::tyre ? 0.5 * kMass : kMass, is_outwards ? kSpeed : -kSpeed);
  if (kind == Kind::rope) {
    def.ropes.push_back({.name = "F",
                         .bodies = {"Ground", "B"},
                         .points = {{0, 0, 0}, {0, 0, 0}},
                         .free_length = kStart + gap,
                         .stiffness = k,
                         .damping_constant = c});
  } else if (kind == Kind::tyre) {
    def.tyre_dummies.push_back({.name = "F",
                                .relative_to = "B",
                                .mass = 0.5 * kMass,
                                .inertia = {1, 1, 1},
                                .radius = kStart - gap,
                                .stiffness = k,
                                .damping = c});
  } else {
    TranslationalForceDef& force = def.translational_forces.emplace_back(line());
    if (kind == Kind::min_length) force.min_length = kStart - gap;
    if (kind == Kind::max_length) force.max_length = kStart + gap;
    force.end_spring_constant = k;
    force.end_damping_constant = c;
  }
  return def;
}

// Least and largest speed of the rebound over that of the impact, with the touch at different instants of the step.
struct Rebound {
  double least = INFINITY, largest = -INFINITY, energy = 0;
  int flagged = 0;
};

// How a mechanism moves.
struct Setting {
  Formulation formulation = Formulation::augmented;
  Integrator integrator = Integrator::own;
};

void add(MechanicsDef def, Setting setting, Rebound& rebound) {
  def.formulation = setting.formulation;
  def.integrator = setting.integrator;
  Formulated body(def);
  const double speed = body.state.u[0], energy = body.total_energy();
  // until it is halfway back to its start
  double v = speed;
  for (int n = 0; n < 500; ++n) {
    body.dynamics.evaluate(body.model, body.state, body.ws);
    rebound.flagged += body.dynamics.advance(body.model, body.state, body.ws, kStep, {}, {}) ? 0 : 1;
    body.see();
    rebound.energy = std::max(rebound.energy, body.total_energy() / energy);
    v = body.state.u[0];
    const double left = (kGap + kSpeed * kStep) * 0.5;
    if (n > 20 && v / speed < 0 && std::fabs(body.state.q[0]) < left) break;
  }
  rebound.least = std::min(rebound.least, -v / speed);
  rebound.largest = std::max(rebound.largest, -v / speed);
}

// with SLEWRING_SHOW set, prints the figures
void show(const std::string& which, double per_step, double zeta, Setting setting, const Rebound& rebound) {
  if (std::getenv("SLEWRING_SHOW") == nullptr) return;
  std::printf("%s %d %s, k h^2/m %g, zeta %g: %.4f to %.4f, energy %.5f\n",
              testing::name_of(setting.formulation).c_str(), static_cast<int>(setting.integrator), which.c_str(),
              per_step, zeta, rebound.least, rebound.largest, rebound.energy);
}

// per_step: k h^2/m
Rebound rebound_of(Kind kind, double per_step, double zeta, Setting setting = {}) {
  const double k = per_step * kMass / (kStep * kStep), c = 2 * zeta * std::sqrt(k * kMass);
  Rebound rebound;
  for (int phase = 0; phase < kPhases; ++phase) {
    add(scene(kind, k, c, kGap + kStep * kSpeed * phase / kPhases), setting, rebound);
  }
  show(kNames[static_cast<int>(kind)], per_step, zeta, setting, rebound);
  return rebound;
}

double closed_form(Kind kind, double zeta) {
  if (kind == Kind::rope || kind == Kind::tyre) return zeta == 0 ? 1 : zeta == 0.1 ? 0.75863 : 0.51980;
  const double r = std::sqrt(1 - zeta * zeta);
  return std::exp(-zeta * std::atan2(2 * zeta * r, 2 * zeta * zeta - 1) / r);
}

class Touch : public ::testing::TestWithParam<Kind> {};

TEST_P(Touch, GivesBackTheHalfSwing) {
  for (const double zeta : {0.0, 0.1, 0.3}) {
    for (const double per_step : {0.01, 0.1, 1.0, 10.0, 30.0, 100.0}) {
      SCOPED_TRACE("k h^2/m = " + std::to_string(per_step) + ", zeta = " + std::to_string(zeta));
      const Rebound rebound = rebound_of(GetParam(), per_step, zeta);
      const double right = closed_form(GetParam(), zeta);
      EXPECT_EQ(rebound.flagged, 0);
      EXPECT_LE(rebound.energy, 1 + 1e-9);
      EXPECT_LE(rebound.largest, 1 + 1e-9);
      // the touch loses at most 2 %; a damper takes its share where the step resolves the swing
      if (zeta > 0 && per_step > 0.1) continue;
      EXPECT_GE(rebound.least, right - 0.021);
      EXPECT_LE(rebound.largest, right + 0.01);
    }
  }
}

// beyond what the smallest part resolves: it may keep less, and never gains
TEST_P(Touch, NeverGainsFromABlow) {
  for (const double zeta : {0.0, 0.3, 3.0, 100.0}) {
    for (const double per_step : {1.0, 1e3, 1e5, 1e8}) {
      SCOPED_TRACE("k h^2/m = " + std::to_string(per_step) + ", zeta = " + std::to_string(zeta));
      const Rebound rebound = rebound_of(GetParam(), per_step, zeta);
      EXPECT_EQ(rebound.flagged, 0);
      EXPECT_LE(rebound.energy, 1 + 1e-9);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(In, Touch,
                         ::testing::Values(Kind::min_length, Kind::max_length, Kind::angle, Kind::rope, Kind::tyre),
                         [](const auto& tested) { return kNames[static_cast<int>(tested.param)]; });

// A weak end spring is touched by a mass that gravity slows down far more: x'' = -g, then x'' = -g - k (x - gap). The
// implicit Euler rule over the whole step would end g h^2/2 = 4e-6 m too low.
TEST(TouchOfAWeakSpring, LeavesTheOtherForcesAlone) {
  constexpr double kGravity = 8, kSpring = 1, kEnd = 0.03;
  for (int phase = 0; phase < kPhases; ++phase) {
    SCOPED_TRACE(phase);
    const double gap = kGap + kStep * kSpeed * phase / kPhases;
    MechanicsDef def = sliding(kMass, kSpeed);
    def.gravity = {0, -kGravity, 0};
    def.formulation = Formulation::augmented;
    TranslationalForceDef& force = def.translational_forces.emplace_back(line());
    force.max_length = kStart + gap;
    force.end_spring_constant = kSpring;
    Formulated body(def);
    body.run(kEnd, kStep);
    const double speed = std::sqrt(kSpeed * kSpeed - 2 * kGravity * gap), left = kEnd - (kSpeed - speed) / kGravity;
    const double omega = std::sqrt(kSpring / kMass);
    const double swing = speed / omega * std::sin(omega * left), fall = 1 - std::cos(omega * left);
    const double right = kStart + gap + swing - kGravity / (omega * omega) * fall;
    // 1e-6 of the mechanism's length (body_penalty.h), the body's radius of gyration about the origin of its joint
    const double length = std::sqrt((3.0 + 2 * kMass * kStart * kStart) / (2 * kMass));
    EXPECT_NEAR(body.pose("B").position[1], right, 1e-6 * length);
  }
}

// rk4, up to k h^2/m of 7.8, the last that is accepted at load. A damper that makes the touch faster than the rule is
// refused there as well.
class ExplicitTouch : public ::testing::TestWithParam<std::tuple<Formulation, Kind>> {};

TEST_P(ExplicitTouch, GivesBackTheHalfSwing) {
  const auto [formulation, kind] = GetParam();
  for (const double zeta : {0.0, 0.1, 0.3}) {
    for (const double per_step : {0.01, 0.1, 0.3, 1.0, 2.0, 3.9, 7.8}) {
      if (zeta > 0 && per_step > 2) continue;
      SCOPED_TRACE("k h^2/m = " + std::to_string(per_step) + ", zeta = " + std::to_string(zeta));
      const Rebound rebound = rebound_of(kind, per_step, zeta, {formulation, Integrator::rk4});
      const double right = closed_form(kind, zeta);
      EXPECT_EQ(rebound.flagged, 0);
      EXPECT_LE(rebound.energy, 1.005);
      EXPECT_GE(rebound.least, right - 0.015);
      EXPECT_LE(rebound.largest, right + 0.004);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Under, ExplicitTouch,
    ::testing::Combine(::testing::Values(Formulation::recursive, Formulation::lagrange, Formulation::penalty),
                       ::testing::Values(Kind::min_length, Kind::max_length, Kind::angle, Kind::rope, Kind::tyre)),
    [](const auto& tested) {
      return testing::name_of(std::get<0>(tested.param)) + "_" + kNames[static_cast<int>(std::get<1>(tested.param))];
    });

// A table that pushes on one side only, with the slope k one metre behind its knee: its force begins with the square of
// the depth.
Rebound rebound_of_a_table(double per_step, Setting setting) {
  const double k = per_step * kMass / (kStep * kStep);
  Rebound rebound;
  for (int phase = 0; phase < kPhases; ++phase) {
    MechanicsDef def = sliding(kMass, -kSpeed);
    TranslationalForceDef& force = def.translational_forces.emplace_back(line());
    force.free_length = kStart - kGap - kStep * kSpeed * phase / kPhases;
    force.spring_table = {{-2, -2 * k}, {-1, -k}, {0, 0}, {1, 0}, {2, 0}};
    add(def, setting, rebound);
  }
  show("table", per_step, 0, setting, rebound);
  return rebound;
}

using RuleOf = std::pair<Formulation, Integrator>;

std::string name_of_rule(RuleOf rule) {
  const auto [formulation, integrator] = rule;
  return testing::name_of(formulation) + (integrator == Integrator::own ? "" : "_" + testing::name_of(integrator));
}

class TouchOfATable : public ::testing::TestWithParam<RuleOf> {};

TEST_P(TouchOfATable, GivesBackWhatItStored) {
  const auto [formulation, integrator] = GetParam();
  for (const double per_step : {1.0, 7.8, 1e3, 1e5}) {
    if (integrator == Integrator::rk4 && per_step > 7.8) continue;
    SCOPED_TRACE(per_step);
    const Rebound rebound = rebound_of_a_table(per_step, {formulation, integrator});
    EXPECT_EQ(rebound.flagged, 0);
    EXPECT_LE(rebound.largest, 1.01);
    // sdirk2 damps a swing that its parts do not resolve
    const bool is_damped = integrator == Integrator::sdirk2 && per_step > 7.8;
    EXPECT_GE(rebound.least, is_damped ? 0.6 : 0.98);
  }
}

constexpr RuleOf kRules[] = {{Formulation::augmented, Integrator::own},
                             {Formulation::recursive, Integrator::rk4},
                             {Formulation::lagrange, Integrator::rk4},
                             {Formulation::penalty, Integrator::rk4},
                             {Formulation::recursive, Integrator::trapezoidal},
                             {Formulation::recursive, Integrator::generalised_alpha},
                             {Formulation::recursive, Integrator::sdirk2},
                             {Formulation::lagrange, Integrator::trapezoidal},
                             {Formulation::lagrange, Integrator::generalised_alpha},
                             {Formulation::lagrange, Integrator::sdirk2}};
INSTANTIATE_TEST_SUITE_P(Under, TouchOfATable, ::testing::ValuesIn(kRules),
                         [](const auto& tested) { return name_of_rule(tested.param); });

}  // namespace touch_test
}  // namespace slew::multibody
