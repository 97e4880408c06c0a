// SPDX-License-Identifier: Apache-2.0
// A base that turns ten times with a flexible body on it: attitude and deflection after it are those of no turn; while
// it turns, the beam bends as theory has it under centrifugal tension.
#include <span>

#include "tests/support/nightly.h"
#include "tests/validation/flexible/strip.h"

namespace slew::multibody {
namespace turns_test {

using namespace testing;

constexpr double kTurns = 10 * 2 * M_PI, kGravity = 9.81;

// the strip turns about y, which gravity is along
void turn(MechanicsDef& def, const MotionDef& motion) {
  def.gravity = {0, -kGravity, 0};
  def.joints[0].type = JointType::revolute;
  def.joints[0].orientation1 = def.joints[0].orientation2 = {-M_PI / 2, 0, 0};
  def.motions = {motion};
}

// both planes: the start and the stop bend the strip sideways
MechanicsDef by_modes(flex::GeometricStiffening stiffening, double damping) {
  flex::ReductionDef reduction = flex::testing::with_modes(24);
  reduction.stiffening = stiffening;
  const auto all = slew::testing::modes_of(strip(), reduction, {});
  std::vector<int> kept = bending(*all, 1, 4);
  for (const int k : bending(*all, 2, 3)) kept.push_back(k);
  MechanicsDef def = clamped_strip(slew::testing::modes_of(strip(), reduction, kept));
  def.flexible_bodies[0].start.clear();
  def.flexible_bodies[0].relative_damping = {damping};
  return def;
}

MechanicsDef by_segments(double damping) {
  MechanicsDef def = clamped_segments(20);
  def.segmented_bodies[0].relative_damping = damping;
  def.segmented_bodies[0].start = SegmentStart::at_rest;
  return def;
}

double turn_between(const std::array<double, 4>& a, const std::array<double, 4>& b) {
  double along = 0, aside = 0;
  for (std::size_t i = 0; i < 4; ++i) along += a[i] * b[i];
  for (std::size_t i = 0; i < 4; ++i) aside += (b[i] - along * a[i]) * (b[i] - along * a[i]);
  return 2 * std::asin(std::min(1.0, std::sqrt(aside)));
}

struct Case {
  Formulation formulation;
  Integrator integrator;
  double step;
  bool is_segmented;
};
const Case kCases[] = {{Formulation::recursive, Integrator::rk4, 2e-4, false},
                       {Formulation::lagrange, Integrator::rk4, 2e-4, false},
                       {Formulation::recursive, Integrator::trapezoidal, 2e-3, false},
                       {Formulation::augmented, Integrator::own, 2e-3, false},
                       {Formulation::recursive, Integrator::trapezoidal, 1e-3, true},
                       {Formulation::lagrange, Integrator::sdirk2, 2e-3, true}};

// one of each kind of body in the gate
std::vector<Case> cases() {
  if (slew::testing::is_nightly()) return {std::begin(kCases), std::end(kCases)};
  return {kCases[2], kCases[5]};
}

std::string text_of(const Case& c) {
  return std::string(c.is_segmented ? "20 segments, " : "modes, ") + name_of(c.formulation) + ", " +
         (c.integrator == Integrator::own ? std::string("own") : name_of(c.integrator)) + ", " +
         in_milliseconds(c.step);
}

Formulated start(const Case& c, const MotionDef& motion, double damping) {
  MechanicsDef def =
      c.is_segmented ? by_segments(damping) : by_modes(flex::GeometricStiffening::straight_beam, damping);
  turn(def, motion);
  def.formulation = c.formulation;
  def.integrator = c.integrator;
  def.max_substep = c.step;
  return Formulated(def);
}

TEST(TenTurns, EndWhereNoTurnDoes) {
  for (const Case& c : cases()) {
    Formulated base = start(c,
                            {.name = "Ramp",
                             .shape = MotionShape::ramp,
                             .joint = "Root",
                             .from = 0,
                             .to = kTurns,
                             .start = 0.1,
                             .duration = 8},
                            0.1);
    const double sag = base.value("Strip.deflection.y");
    const BodyPose before = base.pose("Strip");
    Outcome outcome;
    outcome.is_flagged = !base.try_run(10, c.step);
    const double aside = base.value("Strip.deflection.z"), after = base.value("Strip.deflection.y");
    outcome.error = std::hypot(after - sag, aside) / std::fabs(sag);
    expect_outcome("ten turns and a stop: deflection, of the sag", text_of(c), outcome, 1e-3, Ending::right);
    outcome.error = turn_between(before.orientation, base.pose("Strip").orientation);
    outcome.error = std::max(outcome.error, std::fabs(base.value("Root.position") - kTurns));
    expect_outcome("ten turns and a stop: attitude and angle [rad]", text_of(c), outcome, 1e-8, Ending::right);
  }
}

// eta = Omega sqrt(rho A L^4/(E I)) = 5: tension makes the strip three times as stiff
TEST(TenTurns, UnderWayTheStripBendsAsTheBeamUnderTension) {
  slew::testing::SlenderBeam beam = slender();
  const double weight = -beam.rho_A * kGravity, rest = beam.tip_under(weight);
  beam.spin = 5 * std::sqrt(beam.EI / beam.rho_A);
  const double exact = beam.tip_under(weight);
  EXPECT_LT(exact / rest, 0.35);
  const double time = 1.5 + kTurns / beam.spin;  // a second of it to speed up
  for (const Case& c : cases()) {
    if (c.formulation == Formulation::lagrange && !c.is_segmented) continue;
    Formulated base = start(
        c, {.name = "Spin", .shape = MotionShape::speed, .joint = "Root", .points = {{0, 0}, {1, beam.spin}}}, 0.2);
    Outcome outcome;
    const double settled = std::ceil(time / c.step) * c.step;
    outcome.is_flagged = !base.try_run(settled, c.step);
    outcome.error = std::fabs(base.value("Strip.deflection.y") / exact - 1);
    EXPECT_GE(base.value("Root.position"), 0.999 * kTurns);
    expect_outcome("ten turns at 5 sqrt(EI/rho A L^4): sag", text_of(c), outcome, 0.01, Ending::right);
  }
}

// Free on its hinge, swinging sideways: energy and angular momentum stay, the angle counts all turns.
TEST(TenTurns, OnAFreeHingeKeepTheirMomentum) {
  constexpr Formulation kFormulations[] = {Formulation::recursive, Formulation::lagrange};
  constexpr double step = 5e-5;
  for (const Formulation formulation : std::span(kFormulations).first(slew::testing::rounds<std::size_t>(1, 2))) {
    MechanicsDef def = by_modes(flex::GeometricStiffening::straight_beam, 0);
    def.joints[0].type = JointType::revolute;
    def.joints[0].orientation1 = def.joints[0].orientation2 = {-M_PI / 2, 0, 0};
    def.joints[0].initial_velocity = 30;
    def.flexible_bodies[0].start = {0, 0.01, 0, 0, 0, 0, 0};  // sideways
    def.formulation = formulation;
    def.max_substep = step;
    Formulated base(def);
    // about the hinge
    const auto spin = [&] {
      const auto L = momentum(base.model, base.ws).angular;
      return L[1];
    };
    const double begin = base.total_energy(), L = spin();
    Outcome outcome;
    outcome.is_flagged = !base.try_run(2.2, step);
    EXPECT_GT(base.value("Root.position"), kTurns);
    outcome.error = std::max(std::fabs(base.total_energy() / begin - 1), std::fabs(spin() / L - 1));
    expect_outcome("ten turns on a free hinge: energy and momentum, relative",
                   name_of(formulation) + ", " + in_milliseconds(step), outcome, 1e-5, Ending::right);
  }
}

}  // namespace turns_test
}  // namespace slew::multibody
