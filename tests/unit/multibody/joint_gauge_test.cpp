// SPDX-License-Identifier: Apache-2.0
// The gauge of open joints: its values for prepared motions.
#include "multibody/joints/joint_gauge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "multibody/build/validate.h"
#include "multibody/formulations/formulation.h"
#include "multibody/results/observe.h"

namespace slew::multibody {
namespace joint_gauge_test {

// three rods hang in a chain; the last one is held by a rod without mass when it is looped
MechanicsDef chain() {
  MechanicsDef def;
  for (int i = 0; i < 3; ++i) {
    def.bodies.push_back({.name = "Rod" + std::to_string(i),
                          .position = {static_cast<double>(i), 0, 0},
                          .mass = 1,
                          .center_of_mass = {0.5, 0, 0},
                          .inertia = {0.01, 0.1, 0.1}});
  }
  def.joints = {{.name = "Hinge", .body2 = "Rod0", .initial_velocity = 1},
                {.name = "Ball", .type = JointType::spherical, .body1 = "Rod0", .point1 = {1, 0, 0}, .body2 = "Rod1"},
                {.name = "Cross",
                 .type = JointType::universal,
                 .body1 = "Rod1",
                 .point1 = {1, 0, 0},
                 .body2 = "Rod2",
                 .orientation2 = {-M_PI / 2, 0, 0}}};
  return def;
}

MechanicsDef looped_chain() {
  MechanicsDef def = chain();
  def.joints[0].initial_velocity = kNotGiven;
  def.joints.push_back({.name = "Link",
                        .type = JointType::spherical_spherical,
                        .point1 = {3, 1, 0},
                        .body2 = "Rod2",
                        .point2 = {1, 0, 0}});
  return def;
}

struct Gauged {
  explicit Gauged(const MechanicsDef& def) : model(build_model(def)), state(start_state(model)), ws(model) {
    Problems problems;
    validate(def, problems);
    EXPECT_TRUE(problems.empty()) << problems[0].path << ": " << problems[0].what;
    observe(model, state, ws);
  }
  [[nodiscard]] JointGap gap() const { return JointGauge(model).measure(ws); }
  [[nodiscard]] LinkMotion& motion(const char* body) {
    return ws.motion[static_cast<std::size_t>(model.bodies[static_cast<std::size_t>(find_body(model, body))].link)];
  }

  Model model;
  State state;
  Workspace ws;
};

constexpr double kRounding = 1e-15;

TEST(JointGauge, ShowsRoundingWhereJointsAreClosed) {
  for (const MechanicsDef& def : {chain(), looped_chain()}) {
    const Gauged mechanism(def);
    EXPECT_LT(mechanism.gap().position, kRounding);
    EXPECT_LT(mechanism.gap().rate, kRounding);
  }
}

TEST(JointGauge, ShowsByHowMuchAPointIsOffAndOfWhichJoint) {
  Gauged mechanism(chain());
  mechanism.motion("Rod2").p += math::Vec3(0, 0, 1e-4);
  EXPECT_NEAR(mechanism.gap().position, 1e-4, kRounding);
  EXPECT_LT(mechanism.gap().rate, kRounding);
  EXPECT_EQ(mechanism.gap().joint, find_joint(mechanism.model, "Cross"));
}

TEST(JointGauge, ShowsByHowMuchAPointMovesAway) {
  Gauged mechanism(chain());
  mechanism.motion("Rod2").v += math::Vec3(0, 0, 2e-3);
  EXPECT_LT(mechanism.gap().position, kRounding);
  EXPECT_NEAR(mechanism.gap().rate, 2e-3, kRounding);
}

TEST(JointGauge, ShowsAnAngleInRadians) {
  Gauged mechanism(chain());
  // the cross is bent about the axis that it does not have
  LinkMotion& rod = mechanism.motion("Rod2");
  rod.R = math::rotation_xyz({1e-3, 0, 0}) * rod.R;
  EXPECT_NEAR(mechanism.gap().position, std::sin(1e-3), 1e-12);
}

TEST(JointGauge, ShowsALinkThatIsTooLongAndNothingAcrossIt) {
  Gauged mechanism(looped_chain());
  // the link stands along y
  mechanism.motion("Rod2").p += math::Vec3(0, -1e-6, 0);
  // a distance shows (d^2 - c^2) / 2c; the other joint the same shift
  EXPECT_NEAR(mechanism.gap().position, 1e-6, 1e-12);
  Gauged turned(looped_chain());
  turned.motion("Rod2").w += math::Vec3(0, 0, 1);
  EXPECT_NEAR(turned.gap().rate, 1, 1e-12);
}

TEST(JointGauge, HidesNothingThatIsNotFinite) {
  Gauged mechanism(looped_chain());
  mechanism.motion("Rod0").p += math::Vec3(std::numeric_limits<double>::quiet_NaN(), 0, 0);
  EXPECT_TRUE(std::isnan(mechanism.gap().position));
}

// rows that others imply are measured too: a planar four-bar in space has three
TEST(JointGauge, MeasuresRedundantRows) {
  MechanicsDef def;
  for (int i = 0; i < 2; ++i) {
    def.bodies.push_back({.name = "Rod" + std::to_string(i),
                          .position = {static_cast<double>(i), 0, 0},
                          .mass = 1,
                          .center_of_mass = {0, 0.5, 0},
                          .inertia = {0.1, 0, 0.1}});
    def.joints.push_back({.name = "Pin" + std::to_string(i),
                          .point1 = {static_cast<double>(i), 0, 0},
                          .body2 = "Rod" + std::to_string(i)});
  }
  def.bodies.push_back(
      {.name = "Coupler", .position = {0, 1, 0}, .mass = 1, .center_of_mass = {0.5, 0, 0}, .inertia = {0, 0.1, 0.1}});
  def.joints.push_back({.name = "Left", .body1 = "Rod0", .point1 = {0, 1, 0}, .body2 = "Coupler"});
  def.joints.push_back(
      {.name = "Right", .body1 = "Coupler", .point1 = {1, 0, 0}, .body2 = "Rod1", .point2 = {0, 1, 0}});
  Gauged bars(def);
  EXPECT_LT(bars.gap().position, kRounding);
  // out of the plane, which the loop's own rows leave to the tree
  bars.motion("Rod1").p += math::Vec3(0, 0, 1e-5);
  EXPECT_NEAR(bars.gap().position, 1e-5, kRounding);
}

TEST(JointGauge, SeesJointsThatTheStartHadToClose) {
  MechanicsDef def = chain();
  def.bodies[1].position = {1, 2e-4, 0};
  const Gauged mechanism(def);
  EXPECT_LT(mechanism.gap().position, 1e-11);
}

// Body coordinates have an error of their own, which joint coordinates made of them cannot show: whatever integrates
// them has to show them, every formulation that there is.
class BodyCoordinates : public ::testing::TestWithParam<Formulation> {};

TEST_P(BodyCoordinates, AreWhatIsMeasured) {
  MechanicsDef def = chain();
  def.gravity = {0, -9.81, 0};
  def.formulation = GetParam();
  def.max_substep = 1e-4;
  Problems problems;
  validate(def, problems);
  if (!problems.empty()) GTEST_SKIP() << problems[0].what;
  Model model = build_model(def);
  State state = start_state(model);
  Workspace ws(model), joints(model);
  const JointGauge gauge(model);
  Dynamics dynamics(def.formulation, model, state);
  double position = 0, rate = 0, apart = 0;
  for (int i = 0; i < 200; ++i) {
    dynamics.evaluate(model, state, ws);
    ASSERT_TRUE(dynamics.advance(model, state, ws, def.max_substep, {}, {}));
    dynamics.observe(model, state, ws);
    observe(model, state, joints);
    position = std::max(position, gauge.measure(ws).position);
    rate = std::max(rate, gauge.measure(ws).rate);
    for (std::size_t link = 1; link < model.links.size(); ++link) {
      apart = std::max(apart, norm(ws.motion[link].p - joints.motion[link].p));
    }
  }
  EXPECT_GT(apart, 0) << "joint coordinates were measured";
  EXPECT_GT(position, 0);
  if (def.formulation != Formulation::lagrange) return;
  EXPECT_LT(position, 1e-8);
  EXPECT_LT(rate, 1e-8);
}

INSTANTIATE_TEST_SUITE_P(Of, BodyCoordinates,
                         ::testing::Values(Formulation::lagrange, Formulation::augmented, Formulation::penalty));

}  // namespace joint_gauge_test
}  // namespace slew::multibody
