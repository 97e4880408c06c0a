// SPDX-License-Identifier: Apache-2.0
// Runs whose motion is the mechanism's no longer, finite as it is: they end with the name of the body, whatever
// computes them; and what is bent far or fails to converge for a while goes on.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "mechanics_node/divergence.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "multibody/flexible/deflection.h"
#include "multibody/model/field_tables.h"
#include "tests/support/mechanics_alone.h"
#include "tests/support/nightly.h"
#include "tests/validation/flexible/strip.h"

namespace slew::multibody {
namespace divergence_test {

using namespace testing;
using slew::testing::MechanicsAlone;

scene::Scene scene_of(const MechanicsDef& mechanics) {
  scene::Scene scene;
  scene.mechanics = mechanics;
  scene.session.step = 1e-3;
  return scene;
}

// The strip on a hinge along y, bent along it until its four modes across leave no inertia: `bent_far_test.cpp`.
MechanicsDef pendulum(Formulation formulation, Integrator integrator, double force) {
  flex::ReductionDef reduction = flex::testing::with_modes(24);
  reduction.stiffening = flex::GeometricStiffening::straight_beam;
  const auto all = slew::testing::modes_of(strip(), reduction, {});
  std::vector<int> kept = bending(*all, 1, 4);
  for (const int k : bending(*all, 2, 4)) kept.push_back(k);
  MechanicsDef def = clamped_strip(slew::testing::modes_of(strip(), reduction, kept));
  def.joints[0].type = JointType::revolute;
  def.joints[0].orientation1 = def.joints[0].orientation2 = {-M_PI / 2, 0, 0};
  def.flexible_bodies[0].relative_damping = {0.01};
  def.formulation = formulation;
  def.integrator = integrator;
  if (is_implicit(integrator) || formulation == Formulation::augmented) def.max_substep = 1e-3;
  def.point_forces = {{.name = "Load",
                       .body = "Strip",
                       .point = {1, 0, 0},
                       .direction = {0, 1, 0},
                       .axes = LoadAxes::ground,
                       .force_table = {{0, 0}, {0.3, force}}},
                      {.name = "Side",
                       .body = "Strip",
                       .point = {1, 0, 0},
                       .direction = {0, 0, 1},
                       .force_table = {{0, 0.1}, {0.1, 0.1}, {0.11, 0}}}};
  return def;
}

// clamped, a load that would bend it by so many lengths after a second
MechanicsDef cantilever(double lengths) {
  MechanicsDef def = clamped_strip(strip_modes(2, flex::GeometricStiffening::none));
  def.flexible_bodies[0].relative_damping = {0.3};
  def.integrator = Integrator::sdirk2;
  def.max_substep = 1e-3;
  def.point_forces = {{.name = "Load",
                       .body = "Strip",
                       .point = {1, 0, 0},
                       .direction = {0, 1, 0},
                       .axes = LoadAxes::ground,
                       .force_table = {{0, 0}, {1, lengths * 3 * slender().EI}}}};
  return def;
}

// steps until the run ends, at most so many
StepIndex run_until_end(MechanicsAlone& alone, StepIndex most) {
  while (!alone.report.has_failed() && alone.n < most) alone.step();
  return alone.n;
}

void expect_ended_at_strip(MechanicsAlone& alone, StepIndex most, const std::string& what) {
  EXPECT_LT(run_until_end(alone, most), most) << what;
  ASSERT_TRUE(alone.report.has_failed()) << what;
  if (alone.report.has(StepFlag::ended)) {
    const std::string text(alone.subsystem.failure_text());
    EXPECT_EQ(text.rfind("Strip: ", 0), 0U) << what << ": " << text;
    EXPECT_NE(text.find("Use a shorter session.step"), std::string::npos) << text;
  }
  // latched, and the last good values stay
  const StepReport first = alone.report;
  EXPECT_LE(alone.value("Strip.largest_deflection"), kLostDeflection) << what;
  alone.step();
  EXPECT_EQ(alone.report.flags, first.flags) << what;
}

TEST(Divergence, OfAPendulumWithoutInertiaEndsTheRunUnderEveryRule) {
  std::vector<std::pair<Formulation, Integrator>> rules = {{Formulation::recursive, Integrator::trapezoidal},
                                                           {Formulation::recursive, Integrator::sdirk2},
                                                           {Formulation::lagrange, Integrator::trapezoidal},
                                                           {Formulation::augmented, Integrator::index3_trapezoidal},
                                                           {Formulation::recursive, Integrator::generalised_alpha},
                                                           {Formulation::lagrange, Integrator::generalised_alpha},
                                                           {Formulation::lagrange, Integrator::sdirk2},
                                                           {Formulation::recursive, Integrator::rk4},
                                                           {Formulation::recursive, Integrator::semi_implicit_euler},
                                                           {Formulation::lagrange, Integrator::rk4},
                                                           {Formulation::penalty, Integrator::rk4}};
  rules.resize(slew::testing::rounds<std::size_t>(4, rules.size()));
  for (const auto& [formulation, integrator] : rules) {
    for (const double force : {52.0, 100.0}) {
      MechanicsAlone alone(scene_of(pendulum(formulation, integrator, force)));
      expect_ended_at_strip(alone, 300, name_of(formulation) + ", " + std::string(key_of(integrator)));
    }
  }
}

TEST(Divergence, OfADeflectionOfThreeLengthsEndsTheRunAndOfOneDoesNot) {
  for (const Formulation formulation : {Formulation::recursive, Formulation::lagrange, Formulation::augmented}) {
    MechanicsDef def = cantilever(4);
    def.formulation = formulation;
    if (formulation == Formulation::augmented) def.integrator = Integrator::own;
    MechanicsAlone alone(scene_of(def));
    expect_ended_at_strip(alone, 1000, name_of(formulation));
    EXPECT_TRUE(alone.report.has(StepFlag::ended));
    EXPECT_NE(alone.subsystem.failure_text().find("bent by 3"), std::string::npos) << alone.subsystem.failure_text();
  }
  MechanicsAlone sound(scene_of(cantilever(1)));
  EXPECT_EQ(run_until_end(sound, 1500), 1500);
  EXPECT_TRUE(sound.report.has(StepFlag::large_deflection));
  EXPECT_EQ(sound.subsystem.failure_text(), "");
}

// so soft that a pull at the tip makes it five times as long
TEST(Divergence, OfSegmentsEndsTheRun) {
  constexpr double kSoft = 2.1e5;
  MechanicsDef def = clamped_segments(10, kSoft);
  def.segmented_bodies[0].relative_damping = 1e-4;
  def.max_substep = 1e-3;
  def.point_forces = {{.name = "Load",
                       .body = "Strip",
                       .point = {1, 0, 0},
                       .direction = {1, 0, 0},
                       .axes = LoadAxes::ground,
                       .force_table = {{0, 0}, {1, 4 * kSoft * kSide * kSide}}}};
  MechanicsAlone alone(scene_of(def));
  expect_ended_at_strip(alone, 1500, "segments");
  EXPECT_TRUE(alone.report.has(StepFlag::ended));
}

TEST(Divergence, OfWhatIsFollowedEndsTheRunToo) {
  const scene::Scene scene = scene_of(cantilever(1));
  mechanics_node::MechanicsSubsystem shown(scene, mechanics_node::Motion::followed);
  coupling::OwnSample sample;
  static_cast<void>(shown.first_sample(sample));
  ASSERT_TRUE(shown.start({}, sample).is_ok());
  State state = start_state(shown.model());
  EXPECT_FALSE(shown.follow(0, {state, {}, {}, {}}, {}, sample).has_failed());
  state.q[0] = 100;
  EXPECT_TRUE(shown.follow(1, {state, {}, {}, {}}, {}, sample).has(StepFlag::ended));
  EXPECT_EQ(shown.failure_text().rfind("Strip: bent by ", 0), 0U) << shown.failure_text();
  EXPECT_TRUE(shown.follow(2, {state, {}, {}, {}}, {}, sample).has(StepFlag::ended));
}

// turns by more than a sub-step resolves, in every one
MechanicsDef rotor(Formulation formulation, double speed = 4000) {
  MechanicsDef def;
  def.bodies = {{.name = "Rotor", .mass = 1, .inertia = {1, 1, 1}}};
  def.joints = {{.name = "Pin", .type = JointType::revolute, .body2 = "Rotor", .initial_velocity = speed}};
  def.max_substep = 1e-3;
  def.formulation = formulation;
  return def;
}

TEST(Divergence, OfStepsThatDoNotConvergeEndsTheRun) {
  for (const Formulation formulation :
       {Formulation::recursive, Formulation::lagrange, Formulation::augmented, Formulation::penalty}) {
    MechanicsAlone alone(scene_of(rotor(formulation)));
    EXPECT_EQ(run_until_end(alone, 100), mechanics_node::kMostUnconverged) << name_of(formulation);
    EXPECT_TRUE(alone.report.has(StepFlag::ended));
    const std::string text(alone.subsystem.failure_text());
    EXPECT_EQ(text.rfind("Rotor: of late more steps did not converge than did, and it turns by 4 rad", 0), 0U) << text;
  }
}

// m g/(alpha omega^2) is a centimetre
TEST(Divergence, OfAJointThatAPenaltyLeavesOpenEndsTheRun) {
  MechanicsDef def = rotor(Formulation::penalty, 0);
  def.penalty_factor = 1e3;
  def.penalty_frequency = 1;
  MechanicsAlone alone(scene_of(def));
  EXPECT_LT(run_until_end(alone, 200), 200);
  ASSERT_TRUE(alone.report.has(StepFlag::ended));
  const std::string text(alone.subsystem.failure_text());
  EXPECT_EQ(text.rfind("Rotor: of late more steps did not converge than did, and its joint 'Pin' is open by ", 0), 0U)
      << text;
}

// flagged, since it turns by more than rules of tumbling bodies resolve, and right on its axis
TEST(Divergence, IsNoneOfAWheelThatIsFastOnItsAxis) {
  for (const Formulation formulation :
       {Formulation::recursive, Formulation::lagrange, Formulation::augmented, Formulation::penalty}) {
    MechanicsAlone alone(scene_of(rotor(formulation, 628)));
    EXPECT_EQ(run_until_end(alone, 200), 200) << name_of(formulation) << alone.subsystem.failure_text();
    EXPECT_TRUE(alone.report.has(StepFlag::not_converged));
    // exact in joint coordinates
    const bool is_exact = formulation == Formulation::recursive;
    EXPECT_NEAR(alone.value("Pin.position"), 628 * 0.2, is_exact ? 1e-9 : 0.02) << name_of(formulation);
  }
}

MechanicsDef turning_bushing(double rotational_stiffness) {
  MechanicsDef def;
  def.gravity = {};
  BodyDef body;
  body.name = "Arm", body.mass = 1, body.inertia = {1, 1, 1};
  def.bodies.push_back(body);
  JointDef joint;
  joint.name = "Pin", joint.type = JointType::revolute, joint.body2 = "Arm", joint.initial_velocity = 5;
  def.joints.push_back(joint);
  BushingDef bushing;
  bushing.name = "Mount", bushing.frames.body1 = "Ground", bushing.frames.body2 = "Arm";
  bushing.stiffness = {1, 1, 1}, bushing.rotational_stiffness = {0, 0, rotational_stiffness};
  def.bushings.push_back(bushing);
  return def;
}

// at half a turn the moment would jump from one side to the other: it does so without a sign in the energy of a step
TEST(Divergence, NamesABushingThatTurnsTooFar) {
  MechanicsAlone held(scene_of(turning_bushing(0.1))), free(scene_of(turning_bushing(0)));
  const StepIndex end = run_until_end(held, 3000);
  // x = 5/w sin(w t), w2 = k/J
  const double w = std::sqrt(0.1);
  EXPECT_NEAR(end * 1e-3, std::asin(170 * M_PI / 180 * w / 5) / w, 2e-3);
  EXPECT_NE(std::string(held.subsystem.failure_text()).find("Mount: its frames are turned by 170"), std::string::npos)
      << held.subsystem.failure_text();
  EXPECT_EQ(run_until_end(free, 3000), 3000);
  EXPECT_NEAR(free.value("Pin.position"), 15, 1e-9);
}

// G J/l = 2 Nm/rad on 1 kg m2: x = 10/w sin(w t), w2 = 2
TEST(Divergence, NamesABeamThatTurnsTooFar) {
  MechanicsDef def = turning_bushing(0);
  def.bushings.clear();
  def.bodies[0].position = {1, 0, 0};
  def.joints[0].point1 = {1, 0, 0}, def.joints[0].initial_velocity = 10;
  def.joints[0].orientation1 = def.joints[0].orientation2 = {0, M_PI / 2, 0};
  BeamDef beam;
  beam.name = "Shaft", beam.frames.body1 = "Ground", beam.frames.body2 = "Arm", beam.length = 1;
  beam.youngs_modulus = 2e6, beam.shear_modulus = 1e6, beam.area = 1e-4, beam.torsion_constant = 2e-6;
  beam.second_moment_y = beam.second_moment_z = 1e-6;
  def.beams.push_back(beam);
  MechanicsAlone alone(scene_of(def));
  const StepIndex end = run_until_end(alone, 2000);
  const double w = std::sqrt(2.0);
  EXPECT_NEAR(end * 1e-3, std::asin(170 * M_PI / 180 * w / 10) / w, 2e-3);
  EXPECT_NE(std::string(alone.subsystem.failure_text()).find("Shaft: its frames are turned by 170"), std::string::npos)
      << alone.subsystem.failure_text();
}

// a torsion spring of 2 Nm/rad between bodies whose joint does not count turns; a revolute joint does: 7.07 rad
TEST(Divergence, NamesARotationalForceThatCannotCountTurns) {
  MechanicsDef def = turning_bushing(0);
  def.bushings.clear();
  RotationalForceDef spring{.name = "Spring", .body1 = "Ground", .f1 = {1, 0, 0}, .g1 = {0, 1, 0}, .body2 = "Arm"};
  spring.f2 = {1, 0, 0};
  spring.spring_constant = 2;
  def.rotational_forces.push_back(spring);
  def.joints[0].initial_velocity = 10;
  MechanicsAlone counted(scene_of(def));
  EXPECT_EQ(run_until_end(counted, 2000), 2000) << counted.subsystem.failure_text();
  const double w = std::sqrt(2.0);
  EXPECT_NEAR(counted.value("Pin.position"), 10 / w * std::sin(w * 2), 1e-6);

  def.joints[0].type = JointType::cylindrical;
  MechanicsAlone lost(scene_of(def));
  const StepIndex end = run_until_end(lost, 2000);
  EXPECT_NEAR(end * 1e-3, std::asin(M_PI * w / 10) / w, 2e-3);
  EXPECT_NE(std::string(lost.subsystem.failure_text()).find("Spring: its angle is 1"), std::string::npos)
      << lost.subsystem.failure_text();
  // a damper alone needs no angle
  def.rotational_forces[0].spring_constant = 0, def.rotational_forces[0].damping_constant = 0.1;
  MechanicsAlone damped(scene_of(def));
  EXPECT_EQ(run_until_end(damped, 2000), 2000) << damped.subsystem.failure_text();
}

// the count is part of the state: saved on the way, the run ends at the same step with the same words
TEST(Divergence, ContinuesFromASavedState) {
  const MechanicsDef def = rotor(Formulation::lagrange);
  MechanicsAlone whole(scene_of(def)), part(scene_of(def)), later(scene_of(def));
  const StepIndex end = run_until_end(whole, 100);
  ASSERT_TRUE(whole.report.has(StepFlag::ended));
  while (part.n < end - 5) part.step();
  std::vector<std::byte> bytes;
  part.subsystem.save(bytes);
  ASSERT_TRUE(later.subsystem.load(bytes, later.sample).is_ok());
  EXPECT_EQ(later.subsystem.state_hash(), part.subsystem.state_hash());
  later.n = part.n;
  EXPECT_EQ(run_until_end(later, 100), end);
  EXPECT_EQ(later.subsystem.failure_text(), whole.subsystem.failure_text());
  EXPECT_EQ(later.subsystem.state_hash(), whole.subsystem.state_hash());
  // what has ended stays so, with its text
  whole.subsystem.save(bytes = {});
  ASSERT_TRUE(later.subsystem.load(bytes, later.sample).is_ok());
  later.step();
  EXPECT_TRUE(later.report.has(StepFlag::ended));
  EXPECT_EQ(later.subsystem.failure_text(), whole.subsystem.failure_text());
}

TEST(Divergence, NeedsMoreThanHalfOfTheStepsUnconverged) {
  const Model model = build_model(rotor(Formulation::recursive), {});
  const State state = start_state(model);
  Workspace ws(model);
  observe(model, state, ws);
  const auto ends_after = [&](int unconverged, int converged, int rounds) {
    mechanics_node::DivergenceWatch watch(model);
    for (int i = 0; i < rounds; ++i) {
      for (int k = 0; k < unconverged + converged; ++k) {
        watch.count_step(k >= unconverged);
        if (watch.ends_run(model, state, ws, 1e-3, 1e-3)) return i * (unconverged + converged) + k + 1;
      }
    }
    return -1;
  };
  EXPECT_EQ(ends_after(1, 0, 1000), mechanics_node::kMostUnconverged);
  EXPECT_EQ(ends_after(mechanics_node::kMostUnconverged - 1, mechanics_node::kMostUnconverged - 1, 1000), -1);
  EXPECT_EQ(ends_after(1, 1, 1000), -1);
  EXPECT_NE(ends_after(2, 1, 1000), -1);
}

}  // namespace divergence_test
}  // namespace slew::multibody
