// SPDX-License-Identifier: Apache-2.0
// Toggle positions within 1e-6 rad and full stretch, in every formulation. Bounds and figures: docs/extremes.md.
#include "tests/validation/multibody/chain_def.h"
#include "tests/validation/multibody/every_formulation.h"
#include "tests/validation/multibody/extremes/outcome.h"
#include "tests/validation/multibody/loop_defs.h"

namespace slew::multibody {
namespace toggle_test {

using namespace testing;

constexpr double kCrank = 0.2, kRod = 0.5;                         // m
constexpr double kCrankMass = 1, kRodMass = 1.5, kSliderMass = 2;  // kg
constexpr double kGravity = 9.81;

// crank, connecting rod and slider along x; weight pushes the slider towards the crank
MechanicsDef press(double angle) {
  const double phi = -std::asin(kCrank / kRod * std::sin(angle));
  const double bx = kCrank * std::cos(angle), by = kCrank * std::sin(angle), cx = bx + kRod * std::cos(phi);
  MechanicsDef def;
  def.gravity = {-kGravity, 0, 0};
  const auto rod = [](double mass, double length) { return mass * length * length / 12; };
  def.bodies = {{.name = "Crank",
                 .orientation = {angle, 0, 0},
                 .mass = kCrankMass,
                 .center_of_mass = {0.5 * kCrank, 0, 0},
                 .inertia = {0, rod(kCrankMass, kCrank), rod(kCrankMass, kCrank)}},
                {.name = "Conrod",
                 .position = {bx, by, 0},
                 .orientation = {phi, 0, 0},
                 .mass = kRodMass,
                 .center_of_mass = {0.5 * kRod, 0, 0},
                 .inertia = {0, rod(kRodMass, kRod), rod(kRodMass, kRod)}},
                {.name = "Slider", .position = {cx, 0, 0}, .mass = kSliderMass, .inertia = {0.1, 0.1, 0.1}}};
  const Triple along = {0, M_PI / 2, 0};
  def.joints = {
      {.name = "Pivot", .body2 = "Crank"},
      {.name = "Pin", .body1 = "Crank", .point1 = {kCrank, 0, 0}, .body2 = "Conrod"},
      {.name = "Slot", .type = JointType::prismatic, .orientation1 = along, .body2 = "Slider", .orientation2 = along},
      {.name = "Wrist", .body1 = "Conrod", .point1 = {kRod, 0, 0}, .body2 = "Slider"}};
  return def;
}

// the same as one equation for the crank's angle: M(theta) theta'' + M'(theta) theta'^2 / 2 = -U'(theta)
struct OneAngle {
  double theta = 0, omega = 0;

  // velocities over omega: d/dtheta of the coordinates
  struct Rates {
    double phi, gx, gy, cx, ax;
  };
  static Rates rates(double t) {
    const double phi = -std::asin(kCrank / kRod * std::sin(t));
    const double dphi = -kCrank * std::cos(t) / (kRod * std::cos(phi));
    const double bx = -kCrank * std::sin(t), by = kCrank * std::cos(t);
    return {dphi, bx - 0.5 * kRod * std::sin(phi) * dphi, by + 0.5 * kRod * std::cos(phi) * dphi,
            bx - kRod * std::sin(phi) * dphi, 0.5 * bx};
  }
  static double mass(double t) {
    const Rates r = rates(t);
    return kCrankMass * kCrank * kCrank / 3 +
           kRodMass * (r.gx * r.gx + r.gy * r.gy + kRod * kRod / 12 * r.phi * r.phi) + kSliderMass * r.cx * r.cx;
  }
  static double acceleration(double t, double w) {
    const Rates r = rates(t);
    constexpr double d = 1e-4;
    const double slope = (8 * (mass(t + d) - mass(t - d)) - (mass(t + 2 * d) - mass(t - 2 * d))) / (12 * d);
    const double push = -kGravity * (kCrankMass * r.ax + kRodMass * r.gx + kSliderMass * r.cx);
    return (push - 0.5 * slope * w * w) / mass(t);
  }
  void run(double time, int steps) {
    const double h = time / steps;
    for (int i = 0; i < steps; ++i) {
      const double a1 = acceleration(theta, omega), w2 = omega + 0.5 * h * a1;
      const double a2 = acceleration(theta + 0.5 * h * omega, w2), w3 = omega + 0.5 * h * a2;
      const double a3 = acceleration(theta + 0.5 * h * w2, w3), w4 = omega + h * a3;
      const double a4 = acceleration(theta + h * w3, w4);
      theta += h / 6 * (omega + 2 * w2 + 2 * w3 + w4);
      omega += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
  }
};

class Toggle : public EveryFormulation {};

// an unstable balance: an error at the start has grown a millionfold at the end
TEST_P(Toggle, PressIsLeftAsInItsEquation) {
  for (const double angle : {1e-6, -1e-6}) {
    OneAngle reference{angle, 0};
    reference.run(1, 10000);
    Formulated linkage = start(press(angle));
    Outcome outcome;
    outcome.is_flagged = !linkage.try_run(1, 1e-3);
    outcome.error = std::abs(linkage.value("Pivot.position") - reference.theta);
    expect_outcome("press, 1e-6 rad from its toggle [rad]", setting(1e-3), outcome, 1e-2, Ending::right);
  }
}

// from rest at 1e-6 rad from the flat position, in which the four-bar could turn into its crossed form
TEST_P(Toggle, FourBarLeavesItsFlatPositionOnItsBranch) {
  for (const double from : {0.5 * M_PI - 1e-6, 0.5 * M_PI + 1e-6}) {
    const double rate = 9.81 * 2 / (2.0 / 3 + 1);
    double theta = from, omega = 0;
    constexpr int kSteps = 10000;
    constexpr double h = 1.0 / kSteps;
    for (int i = 0; i < kSteps; ++i) {
      const double a1 = rate * std::sin(theta), w2 = omega + 0.5 * h * a1;
      const double a2 = rate * std::sin(theta + 0.5 * h * omega), w3 = omega + 0.5 * h * a2;
      const double a3 = rate * std::sin(theta + 0.5 * h * w2), w4 = omega + h * a3;
      const double a4 = rate * std::sin(theta + h * w3);
      theta += h / 6 * (omega + 2 * w2 + 2 * w3 + w4);
      omega += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
    MechanicsDef def = four_bars(1);
    def.joints[0].initial_velocity = 0;
    for (BodyDef& body : def.bodies) {
      if (body.name[0] == 'R') body.orientation = {-from, 0, 0};
      if (body.name[0] == 'C') body.position = {std::sin(from), std::cos(from), 0};
    }
    Formulated bars = start(def);
    Outcome outcome;
    outcome.is_flagged = !bars.try_run(1, 1e-3);
    const Triple tip = bars.pose("Coupler0").position, other = bars.pose("Rod1").position;
    outcome.error = std::hypot(tip[0] - std::sin(theta), tip[1] - std::cos(theta)) + std::abs(other[1]);
    expect_outcome("four-bar, 1e-6 rad from flat [m]", setting(1e-3), outcome, 1e-3, Ending::right);
  }
}

// two rods of 1 kg and 1 m between pins; each stands at the angle from the line of the pins
MechanicsDef truss(double angle) {
  MechanicsDef def;
  const double J = 1.0 / 12, reach = std::cos(angle);
  def.bodies = {
      {.name = "Left", .orientation = {-angle, 0, 0}, .mass = 1, .center_of_mass = {0.5, 0, 0}, .inertia = {0, J, J}},
      {.name = "Right",
       .position = {reach, -std::sin(angle), 0},
       .orientation = {angle, 0, 0},
       .mass = 1,
       .center_of_mass = {0.5, 0, 0},
       .inertia = {0, J, J}}};
  def.joints = {{.name = "Wall", .body2 = "Left"},
                {.name = "Middle", .body1 = "Left", .point1 = {1, 0, 0}, .body2 = "Right"},
                {.name = "End", .body1 = "Ground", .point1 = {2 * reach, 0, 0}, .body2 = "Right", .point2 = {1, 0, 0}}};
  return def;
}

// pins take half the weight of each rod across, and m g / (2 tan(angle)) along
TEST_P(Toggle, StretchedTrussCarriesItsWeight) {
  for (const double angle : {1e-3, 1e-6}) {
    Formulated bars = start(truss(angle));
    Outcome outcome;
    outcome.is_flagged = !bars.try_run(1, 1e-3);
    std::vector<JointReaction> reactions(3);
    joint_reactions(bars.model, bars.state, bars.ws, {}, reactions);
    const double along = kGravity / (2 * std::tan(angle));
    outcome.error = std::max(std::abs(std::abs(reactions[0].force[0]) / along - 1),
                             std::abs(bars.pose("Right").position[1] + std::sin(angle)));
    char name[64];
    std::snprintf(name, sizeof name, "truss, %g rad from full stretch", angle);
    // joints that are held by penalties give, and sag by what they give over the angle
    const double bound = is(Formulation::penalty) ? 5e-2 : 1e-2;
    const bool is_right = angle == 1e-3 || is(Formulation::recursive);
    expect_outcome(name, setting(1e-3), outcome, bound, is_right ? Ending::right : Ending::flagged);
  }
}

// pins exactly two lengths apart: no force across can be carried; the middle may not leave its place by more than what
// opens nothing
TEST_P(Toggle, FullyStretchedTrussStaysOrIsFlagged) {
  Formulated bars = start(truss(0));
  Outcome outcome;
  outcome.is_flagged = !bars.try_run(1, 1e-3);
  outcome.error = std::abs(bars.pose("Right").position[1]) + opening(bars).position;
  expect_outcome("truss, exactly stretched [m]", setting(1e-3), outcome, 1e-3, Ending::settled);
}

INSTANTIATE_TEST_SUITE_P(In, Toggle, kEveryFormulation, kFormulationName);

}  // namespace toggle_test
}  // namespace slew::multibody
