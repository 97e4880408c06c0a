// SPDX-License-Identifier: Apache-2.0
// Loads far beyond what small-deflection theory carries: flagged or refused by name, never silent; and what modes
// cannot do at all. Figures: docs/extremes.md.
#include "multibody/build/validate.h"
#include "multibody/flexible/deflection.h"
#include "multibody/results/observe.h"
#include "tests/validation/flexible/strip.h"

namespace slew::multibody {
namespace bent_far_test {

using namespace testing;

// The strip on a hinge along y, across which its modes stand in for nearly all of its inertia: n of them leave a share
// of 2.9e-2, 4.6e-3, 1.4e-3, 6e-4 (n = 1 to 4), of which bending by a share d of the length takes about 0.65 d^2, a
// term of third order being left out of the kinetic energy.
MechanicsDef hinged(int along, int across) {
  flex::ReductionDef reduction = flex::testing::with_modes(24);
  reduction.stiffening = flex::GeometricStiffening::straight_beam;
  const auto all = slew::testing::modes_of(strip(), reduction, {});
  std::vector<int> kept = bending(*all, 1, along);
  for (const int k : bending(*all, 2, across)) kept.push_back(k);
  MechanicsDef def = clamped_strip(slew::testing::modes_of(strip(), reduction, kept));
  def.joints[0].type = JointType::revolute;
  def.joints[0].orientation1 = def.joints[0].orientation2 = {-M_PI / 2, 0, 0};
  def.flexible_bodies[0].relative_damping = {0.05};
  return def;
}

// bends the strip by a tenth of its length within a second, and pushes it aside
void bend(MechanicsDef& def) {
  def.point_forces = {{.name = "Load",
                       .body = "Strip",
                       .point = {1, 0, 0},
                       .direction = {0, 1, 0},
                       .axes = LoadAxes::ground,
                       .force_table = {{0, 0}, {1, 0.1 * 3 * slender().EI}}},
                      {.name = "Side",
                       .body = "Strip",
                       .point = {1, 0, 0},
                       .direction = {0, 0, 1},
                       .force_table = {{0, 0.01}, {0.1, 0.01}, {0.11, 0}}}};
}

// The tip against that of the beam under the load of the moment; the first mode turns in 0.12 s.
Outcome bend_until(const MechanicsDef& def, double end, double step) {
  Formulated strip(def);
  Outcome outcome;
  for (int i = 1; i <= std::lround(end / 0.05); ++i) {
    outcome.is_flagged = !strip.try_run(0.05, step) || outcome.is_flagged;
    if (outcome.is_flagged) return outcome;
    const double error = std::fabs(strip.value("Strip.deflection.y") - 0.1 * 0.05 * i);
    if (!(error <= outcome.error)) outcome.error = error;
  }
  return outcome;
}

TEST(BentFar, OnAHingeManyModesAreFlaggedAndFewAreNot) {
  struct Case {
    int across;
    Ending ending;
  };
  for (const Formulation formulation : {Formulation::recursive, Formulation::lagrange}) {
    for (const Case& c : {Case{1, Ending::right}, {2, Ending::settled}, {4, Ending::flagged}}) {
      MechanicsDef def = hinged(2, c.across);
      bend(def);
      def.formulation = formulation;
      def.integrator = Integrator::trapezoidal;
      def.max_substep = 1e-3;
      expect_outcome("on a hinge, bent by a tenth [m]",
                     std::to_string(c.across) + " modes across, " + name_of(formulation), bend_until(def, 1, 1e-3),
                     3e-3, c.ending);
    }
  }
}

TEST(BentFar, SegmentsGoOn) {
  MechanicsDef def = clamped_segments(20);
  def.joints[0].type = JointType::revolute;
  def.joints[0].orientation1 = def.joints[0].orientation2 = {-M_PI / 2, 0, 0};
  def.segmented_bodies[0].relative_damping = 0.05;
  bend(def);
  expect_outcome("on a hinge, bent by a tenth [m]", "20 segments", bend_until(def, 1, 1e-3), 3e-3, Ending::right);
}

TEST(BentFar, AStartThatLeavesNoInertiaIsRefusedByName) {
  MechanicsDef def = hinged(4, 4);
  def.flexible_bodies[0].start.assign(8, 0.0);
  def.flexible_bodies[0].start[0] = 0.03;
  def.integrator = Integrator::trapezoidal;
  Problems problems;
  validate(def, problems);
  ASSERT_EQ(problems.size(), 1U) << text_of(problems);
  EXPECT_EQ(problems[0].path, "Strip.flex_modes");
  EXPECT_NE(problems[0].what.find("leave no inertia to the joint 'Root'"), std::string::npos) << problems[0].what;
  EXPECT_NE(problems[0].expected.find("type segmented"), std::string::npos);
  // straight it is sound
  def.flexible_bodies[0].start[0] = 0;
  problems.clear();
  validate(def, problems);
  EXPECT_TRUE(problems.empty()) << text_of(problems);
}

// Ten times the allowable: the linear answer, and the flag.
TEST(BentFar, TenTimesTheAllowableIsFlagged) {
  for (const double share : {0.1, 1.0, 10.0}) {
    MechanicsDef def = clamped_strip(strip_modes(4, flex::GeometricStiffening::none));
    def.flexible_bodies[0].relative_damping = {0.3};
    def.integrator = Integrator::sdirk2;
    def.max_substep = 1e-3;
    const double force = share * kSmallDeflection * 0.99 * 3 * slender().EI;
    def.point_forces = {{.name = "Load",
                         .body = "Strip",
                         .point = {1, 0, 0},
                         .direction = {0, 1, 0},
                         .axes = LoadAxes::ground,
                         .force = force}};
    Formulated strip(def);
    strip.run(2, 1e-3);
    const double exact = force / (3 * slender().EI);
    EXPECT_NEAR(strip.value("Strip.deflection.y"), exact, 2e-3 * exact);
    EXPECT_EQ(is_bent_far(strip.model, 0, strip.state.q), share > 1) << share;
  }
}

// modes of one plane do not respond to a load in the other: rigid there, and finite
TEST(BentFar, OneModeIsRigidInTheOtherPlane) {
  MechanicsDef def = clamped_strip(strip_modes(1));
  def.point_forces = {{.name = "Load",
                       .body = "Strip",
                       .point = {1, 0, 0},
                       .direction = {0, 0, 1},
                       .axes = LoadAxes::ground,
                       .force = 1e4}};
  Formulated strip(def);
  strip.run(0.1, 1e-4);
  EXPECT_NEAR(strip.value("Strip.largest_deflection"), 0, 1e-12);
}

// Three strips in a row, the middle one without modes: as if it were a rigid body of its mass.
TEST(BentFar, ABodyWithoutModesBetweenTwoThatBendIsRigid) {
  MechanicsDef def;
  for (int i = 0; i < 3; ++i) {
    const std::string name = "Strip" + std::to_string(i);
    def.bodies.push_back({.name = name, .type = BodyType::flexible, .position = {static_cast<double>(i), 0, 0}});
    flex::ReductionDef reduction = flex::testing::with_modes(10);
    reduction.stiffening = flex::GeometricStiffening::straight_beam;
    flex::Reduction all = flex::reduce(flex::build_beam(strip()), reduction);
    const std::vector<int> kept = i == 1 ? std::vector<int>{} : std::vector<int>{1, 2, 3};
    def.flexible_bodies.push_back(
        {.body = name,
         .modes = std::make_shared<ModalBody>(scene::modal_body(flex::select(all, kept), name)),
         .start = kept.empty() ? std::vector<double>{} : std::vector<double>{0, 0, 0}});
    def.joints.push_back({.name = "Joint" + std::to_string(i),
                          .type = i == 1 ? JointType::fixed : JointType::revolute,
                          .body1 = i == 0 ? "Ground" : "Strip" + std::to_string(i - 1),
                          .point1 = {i == 0 ? 0.0 : 1.0, 0, 0},
                          .body2 = name});
  }
  def.max_substep = 2e-5;
  MechanicsDef rigid = def;
  take_mass(*def.flexible_bodies[1].modes, rigid.bodies[1]);
  rigid.bodies[1].type = BodyType::rigid;
  rigid.flexible_bodies.erase(rigid.flexible_bodies.begin() + 1);
  Formulated one(def), other(rigid);
  one.run(0.3, 2e-5);
  other.run(0.3, 2e-5);
  for (const char* variable :
       {"Strip2.position.x", "Strip2.position.y", "Strip0.deflection.y", "Strip2.deflection.y"}) {
    EXPECT_NEAR(one.value(variable), other.value(variable), 1e-9) << variable;
  }
}

}  // namespace bent_far_test
}  // namespace slew::multibody
