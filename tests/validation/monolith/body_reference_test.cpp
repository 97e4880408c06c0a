// SPDX-License-Identifier: Apache-2.0
// The two references of the mechanics against each other: joint coordinates under CVODE, body coordinates with
// multipliers under IDA. They share the laws of elements and rows, and neither coordinates nor equations nor solver.
#include "monolith/body_reference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "multibody/results/observe.h"
#include "tests/properties/multibody/random_tree.h"
#include "tests/validation/multibody/governor_def.h"
#include "tests/validation/multibody/loop_defs.h"
#include "tests/validation/multibody/squeezer_def.h"

namespace slew::monolith {
namespace body_reference_test {

using multibody::BodyPose;
using multibody::MechanicsDef;

MechanicsReference integrate(const MechanicsDef& def, const std::vector<double>& times, ReferenceEquations equations,
                             double tolerance) {
  MechanicsReference result;
  const Status status = integrate_mechanics(
      def, times, {.equations = equations, .relative_tolerance = tolerance, .absolute_tolerance = 0.1 * tolerance},
      result);
  EXPECT_TRUE(status.is_ok()) << status.text;
  return result;
}

BodyPose pose(const MechanicsReference& result, std::size_t output, int body) {
  multibody::Workspace ws(result.model);
  multibody::observe(result.model, result.states[output], ws);
  return multibody::body_pose(result.model, ws, body);
}

// Largest difference of positions and velocities of all bodies, of the mechanism's largest, at least 1.
double difference(const MechanicsDef& def, const std::vector<double>& times, double tolerance) {
  const MechanicsReference a = integrate(def, times, ReferenceEquations::joint_coordinates, tolerance);
  const MechanicsReference b = integrate(def, times, ReferenceEquations::body_coordinates, tolerance);
  if (a.states.size() != times.size() || b.states.size() != times.size()) return INFINITY;
  double largest = 0, scale = 1;
  for (std::size_t i = 0; i < times.size(); ++i) {
    for (int body = 1; body < static_cast<int>(a.model.bodies.size()); ++body) {
      const BodyPose p = pose(a, i, body), q = pose(b, i, body);
      for (std::size_t k = 0; k < 3; ++k) {
        scale = std::max({scale, std::fabs(p.position[k]), std::fabs(p.velocity[k])});
        largest =
            std::max({largest, std::fabs(p.position[k] - q.position[k]), std::fabs(p.velocity[k] - q.velocity[k])});
      }
    }
  }
  ::testing::Test::RecordProperty("difference", std::to_string(largest / scale));
  return largest / scale;
}

TEST(References, AgreeOnTheSpatialSliderCrank) {
  EXPECT_LT(difference(multibody::testing::slider_crank(), {0, 0.1, 0.3, 0.5, 1}, 1e-12), 1e-9);
}

// and end at the values of the IVP test set of Bari
TEST(References, NightlyAgreeOnAndrewsSqueezer) {
  MechanicsDef def = multibody::testing::squeezer();
  def.point_torques.push_back({.name = "Drive", .body = "K1", .direction = {0, 0, 1}, .torque = 0.033});
  // the case's own solutions differ by 1.5e-9; five turns of the crank in 30 ms let errors grow
  EXPECT_LT(difference(def, {0.01, 0.02, 0.03}, 1e-12), 2e-8);
  const MechanicsReference end = integrate(def, {0.03}, ReferenceEquations::body_coordinates, 1e-12);
  ASSERT_EQ(end.states.size(), 1U);
  EXPECT_NEAR(end.states[0].q[0], multibody::testing::kSqueezerAngles[0].second, 1e-8);
}

// case A03, with steps chosen by a relative tolerance of 1e-9: all angles within 1e-6 rad
TEST(References, TurnAndrewsSqueezerAsTheCaseAllowsAtItsAdaptiveTolerance) {
  MechanicsDef def = multibody::testing::squeezer();
  def.point_torques.push_back({.name = "Drive", .body = "K1", .direction = {0, 0, 1}, .torque = 0.033});
  for (const ReferenceEquations equations :
       {ReferenceEquations::joint_coordinates, ReferenceEquations::body_coordinates}) {
    const MechanicsReference end = integrate(def, {0.03}, equations, 1e-9);
    ASSERT_EQ(end.states.size(), 1U);
    multibody::Workspace ws(end.model);
    multibody::observe(end.model, end.states[0], ws);
    const std::vector<ElementVariable> names = multibody::variables(end.model);
    std::vector<double> values(names.size());
    multibody::read_variables(end.model, end.states[0], ws, std::vector<double>(end.model.rows.size()), values);
    double error = 0;
    for (const auto& [joint, angle] : multibody::testing::kSqueezerAngles) {
      const auto found = std::find_if(names.begin(), names.end(), [&joint = joint](const ElementVariable& variable) {
        return variable.name == std::string(joint) + ".position";
      });
      ASSERT_NE(found, names.end()) << joint;
      error = std::max(error, std::fabs(values[static_cast<std::size_t>(found - names.begin())] - angle));
    }
    EXPECT_LT(error, 1e-6);
    RecordProperty(equations == ReferenceEquations::joint_coordinates ? "joint_1e_9" : "body_1e_9",
                   std::to_string(1e9 * error));
  }
}

TEST(References, AgreeOnTheStiffGovernor) {
  EXPECT_LT(difference(multibody::testing::governor_def(), {0.1, 0.5, 1, 2}, 1e-12), 1e-9);
}

// the ten digits that the case prints, by the second reference alone
TEST(References, BodyCoordinatesGiveTheGovernorsTable) {
  const MechanicsReference governor = integrate(multibody::testing::governor_def(), {0.1, 0.5, 1, 2, 5, 10},
                                                ReferenceEquations::body_coordinates, 1e-11);
  constexpr double kSlider[] = {0.5238364756, 0.7432494248, 0.5014209224, 0.5059092943, 0.5355631037, 0.6196229171};
  ASSERT_EQ(governor.states.size(), 6U);
  const int slider = multibody::find_body(governor.model, "Slider");
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(pose(governor, i, slider).position[2], kSlider[i], 1e-8) << i;
}

// random trees, the two last bodies of which a massless link closes to a loop
TEST(References, AgreeOnRandomLoops) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    multibody::testing::RandomTree tree = multibody::testing::random_tree(
        seed, {.bodies = 3 + static_cast<int>(seed) % 3, .with_dummies = seed % 2 == 0});
    const std::size_t bodies = tree.def.bodies.size();
    tree.def.joints.push_back({.name = "Link",
                               .type = multibody::JointType::spherical_spherical,
                               .body1 = tree.def.bodies[bodies - 2].name,
                               .point1 = {0.3, 0.1, -0.2},
                               .body2 = tree.def.bodies[bodies - 1].name,
                               .point2 = {-0.1, 0.2, 0.4}});
    EXPECT_LT(difference(tree.def, {0.02, 0.05}, 1e-11), 1e-9) << seed;
  }
}

// a cube on a slope of 30 degrees that bristles hold, and one that they let go
TEST(References, BristlesAreStatesOfBoth) {
  for (const double friction : {8.0, 3.0}) {
    MechanicsDef def;
    def.gravity = {9.81 * 0.5, -9.81 * std::sqrt(0.75), 0};
    def.bodies.push_back({.name = "Cube", .mass = 1, .inertia = {1, 1, 1}});
    def.joints.push_back({.name = "Slide",
                          .type = multibody::JointType::prismatic,
                          .orientation1 = {0, M_PI / 2, 0},
                          .body2 = "Cube",
                          .orientation2 = {0, M_PI / 2, 0},
                          .first = {.coulomb_friction = friction,
                                    .friction_speed = 0.01,
                                    .bristle_stiffness = 1e4,
                                    .bristle_damping = 100,
                                    .breakaway_ratio = 1.2}});
    EXPECT_LT(difference(def, {0.1, 0.5, 1}, 1e-11), 1e-9);
    const MechanicsReference cube = integrate(def, {1}, ReferenceEquations::body_coordinates, 1e-10);
    ASSERT_EQ(cube.states.size(), 1U);
    const BodyPose end = pose(cube, 0, 1);
    if (friction > 9.81 * 0.5) {
      // held: bent by the weight over the bristles' stiffness, after some slip while it swung
      EXPECT_NEAR(cube.states[0].bristles[0], 9.81 * 0.5 / 1e4, 1e-9);
      EXPECT_GE(end.position[0], cube.states[0].bristles[0]);
      EXPECT_NEAR(end.velocity[0], 0, 1e-6);
    } else {
      // sliding friction once the bristles have slipped, a little less before
      EXPECT_NEAR(end.velocity[0], 9.81 * 0.5 - friction, 0.02);
    }
  }
}

TEST(References, RefuseContacts) {
  MechanicsDef def;
  def.bodies.push_back({.name = "Ball", .position = {0, 1, 0}, .mass = 1, .inertia = {1, 1, 1}});
  def.joints.push_back({.name = "Free", .type = multibody::JointType::floating, .point1 = {0, 1, 0}, .body2 = "Ball"});
  def.shapes = {{.name = "Skin", .type = contact::ShapeType::sphere, .body = "Ball", .radius = 0.1},
                {.name = "Floor", .type = contact::ShapeType::plane, .orientation = {0, -M_PI / 2, 0}}};
  multibody::ContactPairDef pair;
  pair.normal.stiffness = 1e5;
  pair.name = "Landing";
  pair.shape_a = "Skin";
  pair.shape_b = "Floor";
  def.contacts = {pair};
  MechanicsReference result;
  const std::vector<double> times = {0.1};
  const Status status = integrate_mechanics(def, times, {}, result);
  EXPECT_FALSE(status.is_ok());
  EXPECT_NE(status.text.find("'Landing'"), std::string::npos) << status.text;
}

}  // namespace body_reference_test
}  // namespace slew::monolith
