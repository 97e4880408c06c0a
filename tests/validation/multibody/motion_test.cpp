// SPDX-License-Identifier: Apache-2.0
// Prescribed motion against closed forms, under every formulation and integrator.
//
// Driven pendulum: T = J q'' + m g l sin q. Arm with a bead that slides on it, turned at constant speed in the plane of
// gravity: r'' = w^2 r - g sin(w t), so r = A e^(w t) + B e^(-w t) + g/(2 w^2) sin(w t), and the arm takes
// T = 2 m w r r' + (m r + M l/2) g cos(w t). Slider-crank: the slider's way from the crank's angle by Pythagoras.
// Tolerances: positions that are prescribed 1e-9 (penalty: what its rows leave), the others by the order of the rule.
#include <array>
#include <numbers>
#include <tuple>

#include "multibody/joints/joint_gauge.h"
#include "tests/validation/multibody/choices.h"
#include "tests/validation/multibody/loop_defs.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace motion_test {

using testing::Formulated;
using testing::name_of;

constexpr Formulation kFormulations[] = {Formulation::recursive, Formulation::lagrange, Formulation::augmented,
                                         Formulation::penalty};
constexpr double kGravity = 9.81;

// forces of all motions at the present state, in the order of the scene
std::vector<double> drive_forces(Formulated& m) {
  std::vector<JointReaction> reactions(m.model.joints.size());
  joint_reactions(m.model, m.state, m.ws, {}, reactions);
  std::vector<double> forces;
  for (std::size_t k = 0; k < m.model.drives.size(); ++k) {
    forces.push_back(drive_force(m.model, m.ws, k, {}, reactions));
  }
  m.see();
  return forces;
}

MotionDef harmonic(const std::string& joint, double amplitude, double frequency, double phase) {
  return {.name = joint + "_Motion",
          .shape = MotionShape::harmonic,
          .joint = joint,
          .amplitude = amplitude,
          .frequency = frequency,
          .phase = phase};
}

MotionDef turning(const std::string& joint, double speed) {
  return {.name = joint + "_Motion", .shape = MotionShape::speed, .joint = joint, .speed = speed};
}

// hangs along -y, and turns about z
MechanicsDef driven_pendulum() {
  MechanicsDef def;
  def.bodies = {{.name = "Rod", .mass = 2, .center_of_mass = {0, -0.4, 0}, .inertia = {0.1, 0.01, 0.1}}};
  def.joints = {{.name = "Pivot", .body2 = "Rod"}};
  def.motions = {harmonic("Pivot", 0.7, 0.8, 0.3)};
  def.motions[0].offset = -0.7 * std::sin(0.3);
  return def;
}

class Driven : public ::testing::TestWithParam<Formulation> {};

TEST_P(Driven, PendulumTakesTheTorqueOfItsEquationOfMotion) {
  MechanicsDef def = driven_pendulum();
  def.formulation = GetParam();
  Formulated pendulum(def);
  const double position_tolerance = GetParam() == Formulation::penalty ? 1e-7 : 1e-10;
  const double J = 0.1 + 2 * 0.4 * 0.4, omega = 2 * M_PI * 0.8;
  for (int i = 0; i < 20; ++i) {
    pendulum.run(0.05, 1e-3);
    const double angle = omega * pendulum.state.time + 0.3;
    const double q = 0.7 * (std::sin(angle) - std::sin(0.3));
    EXPECT_NEAR(pendulum.value("Pivot.position"), q, position_tolerance);
    EXPECT_NEAR(pendulum.value("Pivot.velocity"), 0.7 * omega * std::cos(angle), 100 * position_tolerance);
    const double T = -J * 0.7 * omega * omega * std::sin(angle) + 2 * kGravity * 0.4 * std::sin(q);
    EXPECT_NEAR(drive_forces(pendulum)[0], T, 1e-4 * (GetParam() == Formulation::penalty ? 1 : 1e-4));
  }
}

TEST_P(Driven, PendulumGainsTheWorkOfItsDrive) {
  MechanicsDef def = driven_pendulum();
  def.formulation = GetParam();
  Formulated pendulum(def);
  const double before = pendulum.total_energy();
  // Simpson's rule over the drive's power
  const double h = 1e-3;
  const auto power = [&] { return drive_forces(pendulum)[0] * pendulum.ws.drives[0].speed; };
  double work = power() * h / 3;
  const int steps = 700;
  for (int i = 1; i <= steps; ++i) {
    pendulum.run(h, h);
    work += power() * (i == steps ? 1 : i % 2 == 1 ? 4 : 2) * h / 3;
  }
  EXPECT_GT(std::fabs(work), 0.5);
  EXPECT_NEAR(pendulum.total_energy() - before, work, 1e-6 * (GetParam() == Formulation::penalty ? 10 : 1e-2));
}

// arm along x, turned about z; a bead slides along it
MechanicsDef arm_with_bead(double speed) {
  MechanicsDef def;
  def.bodies = {{.name = "Arm", .mass = 3, .center_of_mass = {0.5, 0, 0}, .inertia = {0, 0.25, 0.25}},
                {.name = "Bead", .position = {0.2, 0, 0}, .mass = 0.5, .inertia = {1e-3, 1e-3, 1e-3}}};
  const Triple along_x = {0, M_PI / 2, 0};
  def.joints = {{.name = "Pivot", .body2 = "Arm"},
                {.name = "Slide",
                 .type = JointType::prismatic,
                 .body1 = "Arm",
                 .orientation1 = along_x,
                 .body2 = "Bead",
                 .orientation2 = along_x}};
  def.motions = {turning("Pivot", speed)};
  return def;
}

struct BeadMotion {
  double r, v;
};

BeadMotion bead_at(double t, double w) {
  // r(0) = 0.2, r'(0) = 0
  const double c = kGravity / (2 * w * w), A = 0.5 * (0.2 - c), B = 0.5 * (0.2 + c);
  return {A * std::exp(w * t) + B * std::exp(-w * t) + c * std::sin(w * t),
          w * (A * std::exp(w * t) - B * std::exp(-w * t) + c * std::cos(w * t))};
}

TEST_P(Driven, ArmThrowsItsBeadOutAndFeelsCoriolis) {
  constexpr double w = 4;
  MechanicsDef def = arm_with_bead(w);
  def.formulation = GetParam();
  Formulated arm(def);
  const double tolerance = GetParam() == Formulation::recursive || GetParam() == Formulation::lagrange ? 1e-8 : 2e-5;
  for (int i = 0; i < 8; ++i) {
    arm.run(0.05, 5e-4);
    const double t = arm.state.time;
    const auto [r, v] = bead_at(t, w);
    EXPECT_NEAR(arm.value("Slide.position"), r, tolerance);
    EXPECT_NEAR(arm.value("Slide.velocity"), v, 10 * tolerance);
    EXPECT_NEAR(arm.value("Pivot.position"), w * t, 1e-7);
    const double T = 2 * 0.5 * w * r * v + (0.5 * r + 3 * 0.5) * kGravity * std::cos(w * t);
    EXPECT_NEAR(drive_forces(arm)[0], T, 100 * tolerance);
  }
}

// x of the slider for an angle of the crank, and its rate for a speed of the crank
std::array<double, 2> slider_at(double angle, double speed) {
  // the crank's pin turns about x from the top; the rod is 0.3 m long
  const double y = 0.1 - 0.08 * std::sin(angle), z = 0.12 + 0.08 * std::cos(angle);
  const double dy = -0.08 * std::cos(angle) * speed, dz = -0.08 * std::sin(angle) * speed;
  const double x = std::sqrt(0.09 - y * y - z * z);
  return {x, -(y * dy + z * dz) / x};
}

TEST_P(Driven, CrankOfASpatialLoopMovesItsSliderAsInGeometry) {
  MechanicsDef def = testing::slider_crank();
  def.formulation = GetParam();
  for (JointDef& joint : def.joints) joint.initial_velocity = joint.initial_velocity_2 = kNotGiven;
  const std::string crank = def.joints[0].name;
  def.motions = {turning(crank, 6)};
  Formulated machine(def);
  EXPECT_EQ(machine.model.degrees_of_freedom(), 0);
  EXPECT_NEAR(machine.pose("Slider").velocity[0], slider_at(0, 6)[1], 1e-10) << "the start speeds follow the drive";
  const double tolerance = GetParam() == Formulation::penalty ? 1e-6 : 1e-9;
  const JointGauge gauge(machine.model);
  for (int i = 0; i < 25; ++i) {
    machine.run(0.1, 1e-3);
    const auto [x, v] = slider_at(6 * machine.state.time, 6);
    EXPECT_NEAR(machine.pose("Slider").position[0], x, tolerance);
    EXPECT_NEAR(machine.pose("Slider").velocity[0], v, 100 * tolerance);
    machine.dynamics.observe(machine.model, machine.state, machine.ws);
    EXPECT_LT(gauge.measure(machine.ws).position, tolerance);
  }
}

TEST_P(Driven, JointThatClosesALoopMovesTheOthers) {
  // crank 0.1 m, coupler 0.3 m, slider along x; friction on all, so that the last listed joint is cut
  MechanicsDef def;
  def.formulation = GetParam();
  const double angle = 0.4, x0 = 0.1 * std::cos(angle) + std::sqrt(0.09 - 0.01 * std::pow(std::sin(angle), 2));
  const double rod = std::asin(0.1 * std::sin(angle) / 0.3);
  def.bodies = {{.name = "Crank", .orientation = {angle, 0, 0}, .mass = 1, .inertia = {0, 0.01, 0.01}},
                {.name = "Rod",
                 .position = {0.1 * std::cos(angle), 0.1 * std::sin(angle), 0},
                 .orientation = {-rod, 0, 0},
                 .mass = 1,
                 .center_of_mass = {0.15, 0, 0},
                 .inertia = {1e-3, 0.01, 0.01}},
                {.name = "Slider", .position = {x0, 0, 0}, .mass = 2, .inertia = {1e-3, 1e-3, 1e-3}}};
  const Triple along_x = {0, M_PI / 2, 0};
  def.joints = {{.name = "Main", .body2 = "Crank"},
                {.name = "Pin", .body1 = "Crank", .point1 = {0.1, 0, 0}, .body2 = "Rod"},
                {.name = "Wrist", .body1 = "Rod", .point1 = {0.3, 0, 0}, .body2 = "Slider"},
                {.name = "Slot",
                 .type = JointType::prismatic,
                 .orientation1 = along_x,
                 .body2 = "Slider",
                 .orientation2 = along_x}};
  for (JointDef& joint : def.joints) joint.first.viscous_friction = 1e-9;
  def.motions = {{.name = "Push",
                  .kind = MotionKind::translation,
                  .shape = MotionShape::ramp,
                  .joint = "Slot",
                  .to = 0.33,
                  .start = 0.1,
                  .duration = 0.4}};
  Formulated machine(def);
  ASSERT_EQ(machine.model.joints[3].cut, 0);
  const double tolerance = GetParam() == Formulation::penalty ? 1e-6 : 1e-9;
  for (int i = 0; i < 6; ++i) {
    machine.run(0.1, 1e-3);
    const double x = machine.value("Push.position");
    EXPECT_NEAR(machine.pose("Slider").position[0], x, tolerance);
    // the triangle of crank, rod and slider
    const double cosine = (0.01 + x * x - 0.09) / (2 * 0.1 * x);
    EXPECT_NEAR(std::cos(machine.value("Main.position")), cosine, 10 * tolerance);
  }
  EXPECT_NEAR(machine.pose("Slider").position[0], 0.33, tolerance);
}

INSTANTIATE_TEST_SUITE_P(Formulations, Driven, ::testing::ValuesIn(kFormulations),
                         [](const auto& test) { return name_of(test.param); });

// ---- integrators ----------------------------------------------------------------------------------------------

class DrivenBy : public ::testing::TestWithParam<testing::Choice> {};

TEST_P(DrivenBy, ArmFollowsItsClosedFormWithTheRulesOrder) {
  constexpr double w = 4;
  const auto error_at = [&](double h) {
    MechanicsDef def = arm_with_bead(w);
    std::tie(def.formulation, def.integrator) = GetParam();
    Formulated arm(def);
    arm.run(0.4, h);
    EXPECT_NEAR(arm.value("Pivot.position"), w * 0.4, 1e-9) << h;
    EXPECT_NEAR(arm.value("Pivot.velocity"), w, 1e-9) << h;
    return std::fabs(arm.value("Slide.position") - bead_at(0.4, w).r);
  };
  const double coarse = error_at(4e-3), fine = error_at(2e-3);
  const double order = std::get<1>(GetParam()) == Integrator::semi_implicit_euler ? 1 : 2;
  EXPECT_LT(coarse, order == 1 ? 2e-2 : 1e-3);
  // SHAKE in body coordinates is of second order in the positions of this arm
  const bool is_shake = order == 1 && std::get<0>(GetParam()) == Formulation::lagrange;
  EXPECT_NEAR(std::log2(coarse / fine), is_shake ? 2 : order, 0.25);
}

const testing::Rules kRules = {Integrator::semi_implicit_euler, Integrator::trapezoidal, Integrator::generalised_alpha,
                               Integrator::sdirk2};
const testing::Rules kInBodyCoordinates = {Integrator::semi_implicit_euler};
INSTANTIATE_TEST_SUITE_P(In, DrivenBy, ::testing::ValuesIn(testing::gate_choices(kRules, kInBodyCoordinates)),
                         testing::kChoiceName);
INSTANTIATE_TEST_SUITE_P(Nightly, DrivenBy, ::testing::ValuesIn(testing::nightly_choices(kRules, kInBodyCoordinates)),
                         testing::kChoiceName);

TEST(DrivenArm, ConvergesWithFourthOrderInRungeKutta) {
  const auto error_at = [](double h) {
    Formulated arm(arm_with_bead(4));
    arm.run(0.4, h);
    return std::fabs(arm.value("Slide.position") - bead_at(0.4, 4).r);
  };
  EXPECT_NEAR(std::log2(error_at(0.02) / error_at(0.01)), 4, 0.3);
}

// ---- time -----------------------------------------------------------------------------------------------------

TEST(PrescribedMotion, KeepsItsLawAfterADayOfSession) {
  for (const Formulation formulation : kFormulations) {
    MechanicsDef def = driven_pendulum();
    def.formulation = formulation;
    Formulated late(def);
    // a day is a whole number of the harmonic's periods (0.8 Hz)
    constexpr double kDay = 86400;
    late.state.time = kDay;
    late.run(0.25, 1e-3);
    Formulated early(def);
    early.run(0.25, 1e-3);
    EXPECT_NEAR(late.value("Pivot.position"), early.value("Pivot.position"), 1e-9) << name_of(formulation);
    EXPECT_NEAR(drive_forces(late)[0], drive_forces(early)[0], 1e-6) << name_of(formulation);
  }
}

TEST(PrescribedMotion, GivesTheSameBitsWhenRunAgain) {
  for (const Formulation formulation : kFormulations) {
    const auto hash = [&] {
      MechanicsDef def = arm_with_bead(4);
      def.formulation = formulation;
      Formulated arm(def);
      arm.run(0.2, 1e-3);
      StateHash sum;
      add_to_hash(arm.model, arm.state, sum);
      arm.dynamics.add_to_hash(sum);
      return sum.digest();
    };
    EXPECT_EQ(hash(), hash()) << name_of(formulation);
  }
}

TEST(PrescribedMotion, FailsWhereItsTableRefusesToBeLeft) {
  MechanicsDef def = driven_pendulum();
  def.motions[0] = {.name = "Swing", .joint = "Pivot", .points = {{0, 0}, {0.1, 0.2}}, .ends = TableEnds::refused};
  Formulated pendulum(def);
  pendulum.run(0.1, 0.01);
  pendulum.dynamics.evaluate(pendulum.model, pendulum.state, pendulum.ws);
  EXPECT_FALSE(pendulum.dynamics.advance(pendulum.model, pendulum.state, pendulum.ws, 0.01, {}, {}));
}

// A cart driven by 0.1 m in T from t_0 on, with a pendulum of 2 kg that hangs 0.5 m under it, 0.55 kg m2 about its pin:
//   I q'' = -m g l sin q - m l cos q p''
// integrated apart in the pieces of p'' (Dormand-Prince of order 8, rtol 1e-10) up to 0.12 s: q and q'.
struct Ramp {
  double start, duration;  // s
  double angle, speed;     // right, rad and rad/s
};
constexpr Ramp kRamps[] = {{0.1, 5e-5, -1.89326, -85.5857}, {0.1, 5e-4, -0.34925, -8.4935},
                           {0.1, 1e-3, -0.26351, -4.2162},  {0.1003, 1e-3, -0.26224, -4.2176},
                           {0.1, 2e-3, -0.22066, -2.0788},  {0.1005, 4e-3, -0.19877, -1.0143}};

MechanicsDef cart_with_pendulum() {
  MechanicsDef def;
  def.bodies = {{.name = "Cart", .mass = 1, .inertia = {0.1, 0.1, 0.1}},
                {.name = "Pendulum", .mass = 2, .center_of_mass = {0, -0.5, 0}, .inertia = {0.05, 0.05, 0.05}}};
  const double right = std::numbers::pi / 2;
  def.joints = {{.name = "Rail",
                 .type = JointType::prismatic,
                 .orientation1 = {0, right, 0},
                 .body2 = "Cart",
                 .orientation2 = {0, right, 0}},
                {.name = "Pin", .body1 = "Cart", .body2 = "Pendulum"}};
  def.motions = {{.name = "Drive", .kind = MotionKind::translation, .joint = "Rail"}};
  return def;
}

class FastMotion : public ::testing::TestWithParam<std::tuple<Formulation, Integrator>> {};

TEST_P(FastMotion, OfARampSwingsWhatHangsOnIt) {
  const auto [formulation, integrator] = GetParam();
  const bool is_fine = integrator == Integrator::rk4 || formulation != Formulation::recursive;
  MechanicsDef def = cart_with_pendulum();
  def.formulation = formulation;
  def.integrator = integrator;
  for (const Ramp& ramp : kRamps) {
    def.motions[0].shape = MotionShape::ramp;
    def.motions[0].to = 0.1;
    def.motions[0].start = ramp.start;
    def.motions[0].duration = ramp.duration;
    Formulated m(def);
    m.run(0.12, 1e-3);
    EXPECT_NEAR(m.value("Pin.position"), ramp.angle, (is_fine ? 0.005 : 0.04) * std::fabs(ramp.angle)) << ramp.duration;
    EXPECT_NEAR(m.value("Pin.velocity"), ramp.speed, (is_fine ? 0.005 : 0.06) * std::fabs(ramp.speed)) << ramp.duration;
  }
}

TEST_P(FastMotion, OfAHarmonicShakesWhatHangsOnIt) {
  const auto [formulation, integrator] = GetParam();
  MechanicsDef def = cart_with_pendulum();
  def.formulation = formulation;
  def.integrator = integrator;
  def.motions[0].shape = MotionShape::harmonic;
  def.motions[0].amplitude = 1e-3;
  def.motions[0].phase = std::numbers::pi / 2;
  for (const double frequency : {500.0, 1000.0}) {
    def.motions[0].frequency = frequency;
    Formulated m(def);
    m.run(0.1, 1e-3);
    // by the same integration -1.4e-5 and 4.5e-4 rad, of 1.8e-3 rad of motion; it was -0.196 rad
    EXPECT_NEAR(m.value("Pin.position"), frequency == 500 ? -1.38e-5 : 4.484e-4, 4e-4) << frequency;
  }
}

// A table of two points with `ends: hold` moves the cart by 0.1 m: p'' jumps from 0 to 6 D/T^2 and from -6 D/T^2 to 0.
// Without gravity I q'' = -m l cos q p'', with I = 0.501 kg m2, integrated apart over the table (RK4 in 1e5 steps, p''
// of the table alone); q' is constant behind it. Tolerance: 1e-3 of the 3 rad/s in the middle of the table, which rules
// of order 2 leave in ten sub-steps.
struct Jump {
  double begin, end;  // s
  double h;           // s
  double speed;       // right, rad/s, at 0.6 s
};
constexpr Jump kJumps[] = {{0, 0.1005, 1e-3, -0.0474448},
                           {0, 0.1, 1e-3, -0.0476820},
                           {0.0503, 0.1503, 1e-3, -0.0476820},
                           {0.2, 0.3, 1e-2, -0.0476820}};

TEST_P(FastMotion, OfATableThatIsHeldLeavesNoSpuriousSpeed) {
  const auto [formulation, integrator] = GetParam();
  MechanicsDef def = cart_with_pendulum();
  def.formulation = formulation;
  def.integrator = integrator;
  def.gravity = {0, 0, 0};
  def.bodies[1].inertia = {0.001, 0.001, 0.001};
  for (const Jump& jump : kJumps) {
    def.motions[0].points = {{jump.begin, 0}, {jump.end, 0.1}};
    Formulated m(def);
    // `penalty` reports its F/(alpha omega^2) in such long steps
    EXPECT_EQ(m.try_run(0.6, jump.h), formulation != Formulation::penalty || jump.h < 1e-2);
    EXPECT_NEAR(m.value("Pin.velocity"), jump.speed, 1e-3) << jump.end << " s in steps of " << jump.h << " s";
  }
}

TEST(FastMotion, IsCutWhereItsAccelerationJumps) {
  MotionLaw law = motion_law({.name = "Drive", .points = {{0.2, 0}, {0.3005, 0.1}}}, 0);
  ASSERT_EQ(law.jumps.size(), 2u);
  const double p2 = 6 * 0.1 / (0.1005 * 0.1005);
  EXPECT_NEAR(law.jumps[0].behind, p2, 1e-9 * p2);
  EXPECT_NEAR(law.jumps[1].before, -p2, 1e-9 * p2);
  // one-sided values, also where the time is off by rounding
  for (const double rounding : {-1e-13, 0.0, 1e-13}) {
    EXPECT_NEAR(evaluate(law, 0.3005 + rounding, 0.3005).acceleration, -p2, 1e-9 * p2);
    EXPECT_EQ(evaluate(law, 0.3005 + rounding, kNever).acceleration, 0);
    EXPECT_EQ(evaluate(law, 0.2 + rounding, 0.2).acceleration, 0);
    EXPECT_NEAR(evaluate(law, 0.2 + rounding, 0.201).acceleration, p2, 1e-9 * p2);
  }
  const auto piece = [&law](double time, double h) {
    Drive drive;
    drive.law = law;
    return motion_piece(std::span<const Drive>(&drive, 1), kResolutionOfRungeKutta, time, h, h);
  };
  EXPECT_NEAR(piece(0.3, 1e-3), 5e-4, 1e-12);
  EXPECT_NEAR(piece(0.3005, 1e-3), 1e-3, 1e-15);
  // next to an end of the sub-step
  EXPECT_NEAR(piece(0.3005 - 1e-9, 1e-2), 1e-9, 1e-13);
  EXPECT_NEAR(piece(0.2905 + 1e-9, 1e-2), 1e-2 - 1e-9, 1e-13);
  // tables without a jump
  EXPECT_TRUE(
      motion_law({.name = "Drive", .points = {{0, 0}, {0.1, 0.1}}, .ends = TableEnds::continued}, 0).jumps.empty());
  EXPECT_TRUE(
      motion_law({.name = "Drive", .shape = MotionShape::speed, .points = {{0, 0}, {0.1, 0.1}}}, 0).jumps.empty());
}

INSTANTIATE_TEST_SUITE_P(Under, FastMotion,
                         ::testing::Values(std::tuple(Formulation::recursive, Integrator::rk4),
                                           std::tuple(Formulation::recursive, Integrator::sdirk2),
                                           std::tuple(Formulation::recursive, Integrator::trapezoidal),
                                           std::tuple(Formulation::recursive, Integrator::generalised_alpha),
                                           std::tuple(Formulation::recursive, Integrator::semi_implicit_euler),
                                           std::tuple(Formulation::lagrange, Integrator::rk4),
                                           std::tuple(Formulation::lagrange, Integrator::sdirk2),
                                           std::tuple(Formulation::lagrange, Integrator::semi_implicit_euler),
                                           std::tuple(Formulation::augmented, Integrator::own),
                                           std::tuple(Formulation::penalty, Integrator::own)),
                         [](const auto& choice) {
                           const Integrator rule = std::get<1>(choice.param);
                           return name_of(std::get<0>(choice.param)) + "_" +
                                  (rule == Integrator::own ? "own" : name_of(rule));
                         });

}  // namespace motion_test
}  // namespace slew::multibody
