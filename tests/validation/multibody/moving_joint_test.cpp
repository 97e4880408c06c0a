// SPDX-License-Identifier: Apache-2.0
// Case A10, section J of the cases: one body on one joint in motion, with the wrench that the joint puts on Ground, in
// every formulation.
//
// Revolute against ADAMS (projectchrono/chrono data/testing/joints/revolute_joint Case02; 1e-3) and all five against
// independent solutions in absolute coordinates (joint_*.csv, energy drift 2e-13): 1e-3 of the largest value.
// Figures: docs/validation/A10_joints.md.
#include "tests/validation/multibody/angles.h"
#include "tests/validation/multibody/csv_table.h"
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace moving_joint_test {

using namespace testing;

constexpr double kStep = 1e-3;

// The body's frame lies at the joint, whose frame it shares at the start. Planar: a point in a plane and two right
// angles.
struct Moving {
  const char* name;
  std::vector<JointType> types;
  Triple euler;       // z-x'-z'' of the attitude at the start [rad]
  Triple location;    // m, of the joint
  Triple center;      // m, of mass, in the body
  Triple rotation{};  // rad/s at the start, Ground axes
  Triple velocity{};  // m/s of the joint's point, Ground axes
};

MechanicsDef def_of(const Moving& c) {
  MechanicsDef def;
  def.gravity = {0, 0, -9.80665};
  def.bodies = {{.name = "Body",
                 .position = c.location,
                 .orientation = c.euler,
                 .mass = 1,
                 .center_of_mass = c.center,
                 .inertia = {0.04, 0.1, 0.1}}};
  const math::Mat3 R = math::rotation_zxz(c.euler);
  const bool has_tree_joint = c.types[0] != JointType::in_plane;
  for (std::size_t i = 0; i < c.types.size(); ++i) {
    // a right angle between z of the body and x, then y of Ground's frame
    const math::Mat3 R1 = i == 1 ? math::Mat3{R.c[1], R.c[2], R.c[0]} : i == 2 ? math::Mat3{R.c[2], R.c[0], R.c[1]} : R;
    def.joints.push_back({.name = "Joint" + std::to_string(i),
                          .type = c.types[i],
                          .point1 = c.location,
                          .orientation1 = angles_xyz(R1),
                          .body2 = "Body"});
  }
  if (has_tree_joint) {
    def.joints[0].initial_rotation = c.rotation;
  } else {
    def.joints.push_back({.name = "Free",
                          .type = JointType::floating,
                          .point1 = c.location,
                          .body2 = "Body",
                          .initial_translation = c.velocity,
                          .initial_rotation = c.rotation});
  }
  return def;
}

// on Ground, by all joints together, about the body's point
JointReaction wrench_of(Mechanism& body) {
  std::vector<JointReaction> reactions(body.model.joints.size());
  joint_reactions(body.model, body.state, body.ws, {}, reactions);
  JointReaction sum;
  for (const JointReaction& reaction : reactions) {
    for (std::size_t k = 0; k < 3; ++k) {
      sum.force[k] += reaction.force[k];
      sum.moment[k] += reaction.moment[k];
    }
  }
  return sum;
}

class MovingJoint : public EveryFormulation {
 protected:
  static void follow(const Moving& c) {
    Formulated body = start(def_of(c));
    double error[4] = {}, size[4] = {0, 1, 0, 1};
    double time = 0;
    for (const auto& row : read_table(std::string("joint_") + c.name + ".csv")) {
      if (row[0] > time) body.run(row[0] - time, kStep);
      time = row[0];
      const BodyPose pose = body.pose("Body");
      const JointReaction wrench = wrench_of(body);
      double along = 0;
      for (std::size_t k = 0; k < 4; ++k) along += pose.orientation[k] * row[k + 4];
      for (std::size_t k = 0; k < 4; ++k) {
        error[1] = std::max(error[1], std::abs((along < 0 ? -1 : 1) * pose.orientation[k] - row[k + 4]));
      }
      const auto compare = [&](int which, const Triple& got, std::size_t column) {
        for (std::size_t k = 0; k < 3; ++k) {
          error[which] = std::max(error[which], std::abs(got[k] - row[column + k]));
          size[which] = std::max(size[which], std::abs(row[column + k]));
        }
      };
      compare(0, pose.center_of_mass, 1);
      compare(2, wrench.force, 8);
      compare(3, wrench.moment, 11);
    }
    const char* kWhat[] = {"centre", "attitude", "force", "moment"};
    for (int i = 0; i < 4; ++i) {
      expect_figure("A10", setting(kStep),
                    {std::string(c.name) + ": " + kWhat[i] + ", relative", error[i] / size[i], 1e-3});
    }
  }
};

TEST_P(MovingJoint, RevoluteFollowsTheTable) {
  follow({"revolute_adams02", {JointType::revolute}, {0, -M_PI / 4, 0}, {1, 2, 3}, {2, 0, 0}});
}

TEST_P(MovingJoint, SphericalFollowsTheTable) {
  follow({"spherical_w", {JointType::spherical}, {M_PI / 2, M_PI / 3, -M_PI / 2}, {}, {2, 0, 0}, {0.3, -0.2, 2}});
}

TEST_P(MovingJoint, PrismaticFollowsTheTable) {
  follow({"prismatic", {JointType::prismatic}, {M_PI / 4, M_PI / 4, -M_PI / 4}, {}, {0.5, -0.2, -0.1}});
}

TEST_P(MovingJoint, PlanarFollowsTheTable) {
  const math::Mat3 R = math::rotation_zxz({0, M_PI / 6, 0});
  follow({"planar",
          {JointType::in_plane, JointType::perpendicular, JointType::perpendicular},
          {0, M_PI / 6, 0},
          {},
          {0.5, 0, -0.2},
          (R * math::Vec3(0, 0, 3)).array(),
          (R * math::Vec3(1, 0.5, 0)).array()});
}

TEST_P(MovingJoint, PointInPlaneFollowsTheTable) {
  follow(
      {"point_in_plane", {JointType::in_plane}, {M_PI / 2, M_PI / 6, -M_PI / 2}, {}, {0.5, -0.1, -0.2}, {0.5, 0, 1}});
}

TEST_P(MovingJoint, RevoluteAgreesWithAdams) {
  Formulated body = start(def_of({"", {JointType::revolute}, {0, -M_PI / 4, 0}, {1, 2, 3}, {2, 0, 0}}));
  double force = 0, center = 0, time = 0;
  const auto largest = [](const Triple& a, const Triple& b) {
    return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
  };
  const std::pair<double, Triple> kForces[] = {
      {0, {0, -4.78373, -5.02292}}, {1, {0.427164, 9.56081, -19.3673}}, {2.5, {-7.19193, -2.67074, -7.13638}}};
  for (const auto& [t, expected] : kForces) {
    if (t > time) body.run(t - time, kStep);
    time = t;
    force = std::max(force, largest(wrench_of(body).force, expected));
    if (t == 1) center = largest(body.pose("Body").center_of_mass, {1.0421, 3.4139, 1.5861});
  }
  // ADAMS prints with its integrator's tolerance
  expect_figure("A10", setting(kStep), {"ADAMS: force, of 19.4 N", force / 19.4, 1e-3});
  expect_figure("A10", setting(kStep), {"ADAMS: centre at 1 s [m]", center, 1e-3});
}

INSTANTIATE_TEST_SUITE_P(In, MovingJoint, kEveryFormulation, kFormulationName);

}  // namespace moving_joint_test
}  // namespace slew::multibody
