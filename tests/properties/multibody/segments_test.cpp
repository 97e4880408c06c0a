// SPDX-License-Identifier: Apache-2.0
// Chains of finite segments: conservation laws, and agreement of the formulations.
#include <cmath>
#include <numbers>

#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace segments_test {

using namespace testing;
using math::Mat3;
using math::Vec3;

// 1 m of a flat bar of aluminium from the origin along x
std::shared_ptr<const SegmentChain> bar(std::size_t segments, std::size_t root = 0) {
  constexpr double kE = 7e10, kG = 2.7e10, kRho = 2700, kWidth = 0.005, kHeight = 0.02;
  const double A = kWidth * kHeight, Iy = kWidth * std::pow(kHeight, 3) / 12, Iz = kHeight * std::pow(kWidth, 3) / 12;
  const double l = 1.0 / static_cast<double>(segments);
  auto chain = std::make_shared<SegmentChain>();
  chain->root = root;
  chain->first_frequency = 26;
  for (std::size_t i = 0; i <= segments; ++i) {
    const double share = i == 0 || i == segments ? 0.5 : 1, length = share * l, mass = kRho * A * length;
    const double s = static_cast<double>(i) * l, c = s + (i == 0 ? l / 4 : i == segments ? -l / 4 : 0);
    const double across = mass * length * length / 12;
    chain->lumps.push_back(
        {Vec3(s, 0, 0), mass, Vec3(c, 0, 0),
         Mat3::diagonal(kRho * (Iy + Iz) * length, kRho * Iy * length + across, kRho * Iz * length + across)});
    chain->nodes.push_back({static_cast<std::int64_t>(i) + 1, Vec3(s, 0, 0), i});
  }
  const BeamStiffness K = stiffness_of({.length = l,
                                        .youngs_modulus = kE,
                                        .shear_modulus = kG,
                                        .area = A,
                                        .second_moment_y = Iy,
                                        .second_moment_z = Iz,
                                        .torsion_constant = 4 * Iz});
  const Mat3 forward = Mat3::identity(), backward = Mat3::diagonal(-1, 1, -1);
  for (std::size_t i = root; i < segments; ++i) chain->connectors.push_back({i, i + 1, forward, l, K});
  for (std::size_t i = root; i > 0; --i) chain->connectors.push_back({i, i - 1, backward, l, K});
  return chain;
}

MechanicsDef flying(std::size_t root) {
  const Vec3 spin(30, 20, -40);
  const double station = static_cast<double>(root) / 6;
  MechanicsDef def;
  def.gravity = {0, 0, 0};
  def.bodies = {{.name = "Bar", .type = BodyType::segmented}};
  def.joints = {{.name = "Free",
                 .type = JointType::floating,
                 .body2 = "Bar",
                 .point2 = {station, 0, 0},
                 .initial_translation = (Vec3(1, -2, 0.5) + cross(spin, Vec3(station, 0, 0))).array(),
                 .initial_rotation = spin.array()}};
  def.segmented_bodies = {{.body = "Bar", .chain = bar(6, root)}};
  def.max_substep = 5e-6;
  return def;
}

MechanicsDef swinging(std::size_t segments) {
  MechanicsDef def;
  def.bodies = {{.name = "Bar", .type = BodyType::segmented},
                {.name = "Weight",
                 .relative_to = "Bar",
                 .position = {1, 0, 0},
                 .mass = 0.1,
                 .center_of_mass = {0, -0.05, 0.02},
                 .inertia = {1e-4, 1e-4, 1e-4}}};
  def.joints = {{.name = "Pin", .orientation1 = {0.4, 0, 0}, .body2 = "Bar", .orientation2 = {0.4, 0, 0}},
                {.name = "Hook", .type = JointType::spherical, .body1 = "Bar", .point1 = {1, 0, 0}, .body2 = "Weight"}};
  def.segmented_bodies = {{.body = "Bar", .chain = bar(segments)}};
  def.max_substep = 5e-6;
  return def;
}

// A bar that falls with a weight on a universal joint at its tip, in steps far longer than its swings along itself: the
// projection of the joint must not strain it.
TEST(Segments, AChainInBodyCoordinatesGainsNoEnergyByTheProjectionOfItsJoints) {
  const auto let_fall = [](Formulation formulation, Integrator rule, std::size_t segments) {
    MechanicsDef def = swinging(segments);
    def.joints[1].type = JointType::universal;
    def.joints[1].orientation2 = {std::numbers::pi / 2, 0, 0};
    def.joints[1].initial_velocity = 20;
    def.segmented_bodies[0].relative_damping = 0.003;
    def.max_substep = 1e-3;
    def.formulation = formulation;
    def.integrator = rule;
    Formulated bar(def);
    const double before = bar.total_energy();
    bar.run(0.5, 1e-3);
    EXPECT_LT(bar.total_energy(), before);
    return bar.pose("Weight").position;
  };
  for (const std::size_t segments : {6, 24, 48}) {
    const Triple exact = let_fall(Formulation::recursive, Integrator::sdirk2, segments);
    for (const Integrator rule : {Integrator::trapezoidal, Integrator::generalised_alpha, Integrator::sdirk2}) {
      const Triple found = let_fall(Formulation::lagrange, rule, segments);
      EXPECT_LT(norm(Vec3(found) - Vec3(exact)), 1e-3) << segments << " " << name_of(rule);
    }
  }
}

// let go straight at 54 rad/s
TEST(Segments, AFreeChainKeepsEnergyAndMomentum) {
  for (const std::size_t root : {0, 2, 6}) {
    Mechanism bar(flying(root));
    const double energy = bar.total_energy();
    const Momentum before = momentum(bar.model, bar.ws);
    bar.run(0.2, 5e-6);
    EXPECT_GT(bar.value("Bar.strain_energy"), 1e-7 * energy) << root;
    EXPECT_NEAR(bar.total_energy(), energy, 1e-8 * energy) << root;
    const Momentum after = momentum(bar.model, bar.ws);
    const auto expect_same = [&](Vec3 a, Vec3 b) { EXPECT_LT(norm(a - b), 1e-9 * norm(b)) << root; };
    expect_same(Vec3(after.linear), Vec3(before.linear));
    expect_same(Vec3(after.angular), Vec3(before.angular));
  }
}

// whichever lump is the body: the same bar
TEST(Segments, TheRootIsAChoiceOfFrame) {
  Mechanism first(flying(0)), other(flying(6));
  first.run(0.1, 5e-6);
  other.run(0.1, 5e-6);
  const Triple a = first.pose("Bar.Segment7").position, b = other.pose("Bar").position;
  // the beam's law counts from its near end: equal to second order of a connector's bend
  const Vec3 tip = Vec3(b) + math::rotation_of([&] {
                               const auto [w, x, y, z] = other.pose("Bar").orientation;
                               return math::Quaternion{w, x, y, z};
                             }()) *
                                 Vec3(1, 0, 0);
  EXPECT_LT(norm(tip - Vec3(a)), 1e-4);
}

TEST(Segments, EveryFormulationMovesAChainAlike) {
  const auto after = [](Formulation formulation) {
    MechanicsDef def = swinging(4);
    def.formulation = formulation;
    Formulated bar(def);
    bar.run(0.05, 5e-6);
    return std::pair(bar.pose("Weight").position, bar.value("Bar.deflection.y"));
  };
  const auto [p, y] = after(Formulation::recursive);
  for (const Formulation formulation : {Formulation::lagrange, Formulation::augmented}) {
    const auto [other_p, other_y] = after(formulation);
    const double tolerance = formulation == Formulation::lagrange ? 1e-9 : 1e-6;
    EXPECT_LT(norm(Vec3(p) - Vec3(other_p)), tolerance) << name_of(formulation);
    EXPECT_NEAR(y, other_y, tolerance) << name_of(formulation);
  }
}

TEST(Segments, ASwingingChainKeepsEnergyAndDampingTakesIt) {
  Mechanism bar(swinging(5));
  const double kinetic = energy(bar.model, bar.ws).kinetic, start = bar.total_energy();
  EXPECT_EQ(kinetic, 0);
  bar.run(0.3, 5e-6);
  const double size = energy(bar.model, bar.ws).kinetic;
  EXPECT_NEAR(bar.total_energy(), start, 1e-7 * size);
  MechanicsDef def = swinging(5);
  def.segmented_bodies[0].relative_damping = 0.002;
  def.max_substep = 2e-6;
  Mechanism damped(def);
  double before = damped.total_energy();
  for (int i = 0; i < 10; ++i) {
    damped.run(0.01, 2e-6);
    EXPECT_LT(damped.total_energy(), before);
    before = damped.total_energy();
  }
}

// ---- the start ----

MechanicsDef level(std::size_t segments, double load) {
  MechanicsDef def = swinging(segments);
  def.joints[0].type = JointType::fixed;
  def.joints[1].type = JointType::fixed;
  def.bodies[1].mass = load;
  return def;
}

class SegmentsStart : public ::testing::TestWithParam<Formulation> {};

TEST_P(SegmentsStart, AreAtRest) {
  MechanicsDef def = level(5, 0.1);
  def.formulation = GetParam();
  Formulated bar(def);
  const double before = bar.value("Bar.deflection.y");
  EXPECT_LT(before, -0.01);
  bar.run(0.01, 5e-6);
  EXPECT_NEAR(bar.value("Bar.deflection.y"), before, 1e-7 * std::fabs(before));
}

INSTANTIATE_TEST_SUITE_P(In, SegmentsStart,
                         ::testing::Values(Formulation::recursive, Formulation::lagrange, Formulation::augmented),
                         [](const auto& tested) { return name_of(tested.param); });

TEST(SegmentsStart, HangsByMoreThanItsRootStraightAndReportsIt) {
  MechanicsDef def = level(5, 0.1);
  def.joints[1] = {
      .name = "Hook", .type = JointType::spherical, .point1 = {1, 0, 0}, .body2 = "Bar", .point2 = {1, 0, 0}};
  def.bodies.pop_back();
  const Mechanism held(def);
  EXPECT_EQ(held.value("Bar.largest_deflection"), 0);
  Problems warnings;
  find_start_changes(def, warnings);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0].path, "Bar.segments");
  EXPECT_NE(warnings[0].what.find("starts undeformed"), std::string::npos);
}

TEST(SegmentsStart, LargeBendsAreWarnedOf) {
  Problems warnings;
  find_start_changes(level(5, 0.1), warnings);
  EXPECT_TRUE(warnings.empty()) << text_of(warnings);
  find_start_changes(level(3, 1.5), warnings);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].what.find("segments are turned by"), std::string::npos) << warnings[0].what;
  const Mechanism bar(level(3, 1.5));
  EXPECT_TRUE(is_bent_far(bar.model, bar.model.segmented[0], bar.ws));
}

// a motion just below the bound of the message stays bounded, one above it does not
TEST(SegmentsStart, TooFastOnesAreRefusedByName) {
  for (const double zeta : {0.0, 0.02}) {
    MechanicsDef def = swinging(4);
    def.segmented_bodies[0].relative_damping = zeta;
    def.max_substep = 1e-3;
    Problems problems;
    validate(def, problems);
    ASSERT_EQ(problems.size(), 1U) << text_of(problems);
    EXPECT_EQ(problems[0].path, "Bar.segments");
    EXPECT_NE(problems[0].what.find("which rk4 cannot follow in sub-steps of 0.001 s"), std::string::npos);
    const std::string& text = problems[0].expected;
    const double longest = std::stod(text.substr(text.find("at most ") + 8));
    const auto energy_after = [&](double h) {
      const Model model = build_model(def);
      Workspace ws(model);
      State state = start_state(model);
      for (int i = 0; i < 3000; ++i) (void)advance_free(model, state, ws, h);
      observe(model, state, ws);
      return energy(model, ws).kinetic;
    };
    EXPECT_LT(energy_after(0.97 * longest), 10) << zeta;
    EXPECT_FALSE(energy_after(1.04 * longest) < 1e3) << zeta;
    def.integrator = Integrator::trapezoidal;
    problems.clear();
    validate(def, problems);
    EXPECT_TRUE(problems.empty()) << text_of(problems);
  }
}

}  // namespace segments_test
}  // namespace slew::multibody
