// SPDX-License-Identifier: Apache-2.0
// A mass at the tip of a cantilever, a million times that of an element: static sag and frequency, by modes and by
// segments. The strip is let go straight: w = -w_s (1 - cos(omega t)), 3 E I/(m L^3) = omega^2 = g/w_s to 5e-6.
#include <span>

#include "multibody/build/validate.h"
#include "tests/support/nightly.h"
#include "tests/validation/flexible/strip.h"

namespace slew::multibody {
namespace heavy_tip_test {

using namespace testing;

// as stiff as makes the sag a hundredth of the length, as in a machine
constexpr double kTipMass = 1e6 * kDensity * kSide * kSide / 20, kSag = 0.01, kGravity = 9.81;
const double kModulus = kTipMass * kGravity / (3 * kSag) * 12 / std::pow(kSide, 4);

double omega() {
  slew::testing::SlenderBeam beam = slender(kModulus);
  beam.tip_mass = kTipMass;
  return std::sqrt(beam.lowest_square());
}

void load(MechanicsDef& def) {
  def.gravity = {0, -kGravity, 0};
  def.bodies.push_back(
      {.name = "Load", .relative_to = "Strip", .position = {1, 0, 0}, .mass = kTipMass, .inertia = {1, 1, 1}});
  def.joints.push_back(
      {.name = "Hook", .type = JointType::fixed, .body1 = "Strip", .point1 = {1, 0, 0}, .body2 = "Load"});
}

// all modes of a body whose tip is an interface: the static answer to the tip is among them
MechanicsDef loaded(int modes, flex::GeometricStiffening stiffening) {
  MechanicsDef def;
  if (modes > 0) {
    def = clamped_strip(strip_modes(modes, stiffening, kModulus));
  } else {
    flex::ReductionDef reduction = flex::testing::with_modes(0);
    reduction.stiffening = stiffening;
    def = clamped_strip(slew::testing::modes_of(strip(kModulus), reduction, {}));
  }
  load(def);
  return def;
}

// over one period, of the sag
Outcome swing(const MechanicsDef& def, double step, double periods = 1) {
  Formulated strip(def);
  Outcome outcome;
  const int steps = std::max(1, static_cast<int>(1e-3 / step));
  for (double t = 0; t < periods * 2 * M_PI / omega();) {
    outcome.is_flagged = !strip.try_run(steps * step, step) || outcome.is_flagged;
    t += steps * step;
    const double error = std::fabs(strip.value("Strip.deflection.y") + kSag * (1 - std::cos(omega() * t))) / kSag;
    if (!(error <= outcome.error)) outcome.error = error;
  }
  return outcome;
}

TEST(HeavyTip, TheReferenceIsTheClosedForm) {
  EXPECT_NEAR(omega(), std::sqrt(kGravity / kSag), 1e-5 * omega());
}

TEST(HeavyTip, OnModesOfItsOwnStaticShapeSwingsAsTheClosedForm) {
  struct Case {
    Formulation formulation;
    Integrator integrator;
    double step, bound;
  };
  constexpr Case kCases[] = {{Formulation::recursive, Integrator::trapezoidal, 1e-3, 2e-3},
                             {Formulation::lagrange, Integrator::trapezoidal, 1e-3, 2e-3},
                             {Formulation::augmented, Integrator::own, 1e-3, 2e-3},
                             {Formulation::recursive, Integrator::generalised_alpha, 1e-3, 2e-3},
                             {Formulation::recursive, Integrator::sdirk2, 1e-3, 2e-3}};
  for (const auto stiffening : {flex::GeometricStiffening::none, flex::GeometricStiffening::straight_beam}) {
    // in the gate two formulations, and one without stiffening
    const std::size_t gate = stiffening == flex::GeometricStiffening::none ? 1 : 2;
    for (const Case& c : std::span(kCases).first(slew::testing::rounds(gate, std::size(kCases)))) {
      MechanicsDef def = loaded(0, stiffening);
      def.formulation = c.formulation;
      def.integrator = c.integrator;
      def.max_substep = c.step;
      const bool is_linear = stiffening == flex::GeometricStiffening::none;
      expect_outcome(std::string("tip of 1e6 elements, all modes") + (is_linear ? "" : ", stiffening"),
                     name_of(c.formulation) + ", " + (c.integrator == Integrator::own ? "own" : name_of(c.integrator)) +
                         ", " + in_milliseconds(c.step),
                     swing(def, c.step), c.bound, Ending::right);
    }
  }
}

// two modes reach 99.4 % of the tip's compliance; the second turns with 7e4 rad/s
TEST(HeavyTip, OnTwoModesSwingsInEveryFormulation) {
  constexpr double kStep = 3.5e-5;
  constexpr Formulation kFormulations[] = {Formulation::recursive, Formulation::penalty, Formulation::lagrange,
                                           Formulation::augmented};
  for (const Formulation formulation : std::span(kFormulations).first(slew::testing::rounds<std::size_t>(2, 4))) {
    MechanicsDef def = loaded(2, flex::GeometricStiffening::none);
    def.formulation = formulation;
    def.max_substep = kStep;
    expect_outcome("tip of 1e6 elements, two modes", name_of(formulation) + ", " + in_milliseconds(kStep),
                   swing(def, kStep, slew::testing::rounds(0.5, 1.0)), 0.03, Ending::right);
  }
}

TEST(HeavyTip, OnSegmentsSwingsAsTheClosedForm) {
  // in the gate the first
  constexpr std::pair<Formulation, Integrator> kChoices[] = {
      {Formulation::recursive, Integrator::trapezoidal},       {Formulation::lagrange, Integrator::sdirk2},
      {Formulation::recursive, Integrator::generalised_alpha}, {Formulation::recursive, Integrator::sdirk2},
      {Formulation::lagrange, Integrator::trapezoidal},        {Formulation::lagrange, Integrator::generalised_alpha}};
  for (const auto& [formulation, rule] :
       std::span(kChoices).first(slew::testing::rounds<std::size_t>(1, std::size(kChoices)))) {
    MechanicsDef def = clamped_segments(20, kModulus);
    load(def);
    def.formulation = formulation;
    def.integrator = rule;
    expect_outcome("tip of 1e6 elements, 20 segments", name_of(formulation) + ", " + name_of(rule) + ", 1 ms",
                   swing(def, 1e-3), 2e-3, Ending::right);
  }
}

std::string refusal(const MechanicsDef& def) {
  Problems problems;
  validate(def, problems);
  return problems.empty() ? "" : problems[0].path + ": " + problems[0].what + "; " + problems[0].expected;
}

TEST(HeavyTip, ExplicitRulesAreRefusedByName) {
  MechanicsDef modes = loaded(0, flex::GeometricStiffening::none), segments = clamped_segments(20, kModulus);
  modes.max_substep = 1e-3;
  load(segments);
  segments.integrator = Integrator::rk4;
  EXPECT_EQ(refusal(modes).find("Strip.flex_modes: its fastest mode turns with"), 0U) << refusal(modes);
  EXPECT_EQ(refusal(segments).find("Strip.segments: their fastest motion swings with"), 0U) << refusal(segments);
  for (const MechanicsDef* def : {&modes, &segments}) {
    EXPECT_NE(refusal(*def).find("mechanics.max_substep of at most"), std::string::npos) << refusal(*def);
  }
}

// at the start each rests where beam theory has it
TEST(HeavyTip, RestsWhereBeamTheoryHasIt) {
  MechanicsDef modes = loaded(0, flex::GeometricStiffening::none), segments = clamped_segments(20, kModulus);
  modes.flexible_bodies[0].start.clear();
  modes.integrator = Integrator::trapezoidal;
  load(segments);
  segments.segmented_bodies[0].start = SegmentStart::at_rest;
  EXPECT_NEAR(Formulated(modes).value("Strip.deflection.y"), -kSag, 1e-4 * kSag);
  // cosines of the slopes: segments are no linear theory
  EXPECT_NEAR(Formulated(segments).value("Strip.deflection.y"), -kSag, 3e-4 * kSag);
}

// a mass of 1e-6 elements, and none at all
TEST(HeavyTip, NextToNothingChangesNothing) {
  MechanicsDef def = clamped_strip(strip_modes(4));
  load(def);
  def.gravity = {};
  def.bodies[1].mass = 1e-6 * kDensity * kSide * kSide / 20;
  def.bodies[1].inertia = {1e-15, 1e-15, 1e-15};
  EXPECT_NEAR(squares_of(def).front(), slender().lowest_square(), 2e-3 * slender().lowest_square());
  def.bodies[1].mass = 0;
  EXPECT_EQ(refusal(def).find("Load.mass: "), 0U) << refusal(def);
}

}  // namespace heavy_tip_test
}  // namespace slew::multibody
