// SPDX-License-Identifier: Apache-2.0
// Every joint type of URDF: where the child is, which way it moves, and what becomes of links without mass.
#include <fmt/format.h>

#include "math/rotation.h"
#include "tests/validation/urdf/imported.h"

namespace slew::urdf {
namespace joint_types_test {

using math::Mat3;
using math::Vec3;
using testing::Imported;

constexpr double kRounding = 1e-13;

std::string link(const std::string& name, double mass = 1) {
  return fmt::format(
      "<link name=\"{}\"><inertial><origin xyz=\"0.1 0 0.05\"/><mass value=\"{}\"/><inertia ixx=\"0.1\" iyy=\"0.12\" "
      "izz=\"0.13\"/></inertial></link>",
      name, mass);
}

std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& rest) {
  return fmt::format("<joint name=\"{}\" type=\"{}\"><parent link=\"{}\"/><child link=\"{}\"/>{}</joint>", name, type,
                     parent, child, rest);
}

std::string robot(const std::string& content) {
  return "<robot name=\"r\"><link name=\"world\"/>" + content + "</robot>";
}

Mat3 rpy(double roll, double pitch, double yaw) {
  return math::rotation_z(yaw) * math::rotation_y(pitch) * math::rotation_x(roll);
}

void expect_pose(const multibody::BodyPose& pose, const Mat3& R, Vec3 p) {
  const auto [w, x, y, z] = pose.orientation;
  const Mat3 got = math::rotation_of({w, x, y, z});
  for (int i = 0; i < 3; ++i) EXPECT_LT(norm(got.c[i] - R.c[i]), kRounding) << "axis " << i;
  EXPECT_LT(norm(Vec3(pose.position) - p), kRounding);
}

// Names that YAML reads as other types: the scene loads with names that it takes as text, and moves. A link named null
// was refused with a text that named neither the line nor the cause.
TEST(Names, ThatYamlReadsAsValuesAreNamesOfTheScene) {
  const char* const names[] = {"null", "true", "~", "1.0", "yes", "Off", "NULL", "n", "1e5", ".nan"};
  std::string content;
  std::string parent = "world";
  for (const char* name : names) {
    const std::string hinge = std::string("on ") + name;
    content += link(name) + joint(hinge, "continuous", parent, name, "<origin xyz=\"0.2 0 0\"/><axis xyz=\"0 1 0\"/>");
    parent = name;
  }
  Imported one("<robot name=\"null\"><link name=\"world\"/>" + content + "</robot>");
  ASSERT_EQ(one.scene.mechanics.bodies.size(), std::size(names));
  EXPECT_EQ(one.body("null_link").mass, 1);
  EXPECT_EQ(one.body("NULL_link").mass, 1);
  EXPECT_EQ(one.body("_1_0").mass, 1);
  expect_pose(one.mechanism.pose("_nan"), Mat3::identity(), {2, 0, 0});
}

// turned by q about a skew axis, after an origin that is turned as well
TEST(JointTypes, ARevoluteJointTurnsAboutItsAxis) {
  const std::string axis = "1 -2 0.5";
  const Vec3 a = Vec3(1, -2, 0.5) * (1 / std::sqrt(5.25));
  for (const char* type : {"revolute", "continuous"}) {
    Imported one(robot(link("arm") + joint("turn", type, "world", "arm",
                                           "<origin xyz=\"1 2 3\" rpy=\"0.3 -0.7 1.9\"/><axis xyz=\"" + axis +
                                               "\"/><limit lower=\"-2\" upper=\"2\"/>")));
    expect_pose(one.mechanism.pose("arm"), rpy(0.3, -0.7, 1.9), {1, 2, 3});
    EXPECT_NEAR(one.mechanism.value("turn.position"), 0, kRounding);
    one.mechanism.state.q[0] = 0.8;
    one.mechanism.state.u[0] = 1.3;
    one.mechanism.see();
    const Mat3 K = math::skew(a);
    const Mat3 turn = Mat3::identity() + K * std::sin(0.8) + K * K * (1 - std::cos(0.8));
    expect_pose(one.mechanism.pose("arm"), rpy(0.3, -0.7, 1.9) * turn, {1, 2, 3});
    const Vec3 w(one.mechanism.pose("arm").angular_velocity);
    EXPECT_LT(norm(w - rpy(0.3, -0.7, 1.9) * a * 1.3), kRounding);
  }
}

TEST(JointTypes, APrismaticJointSlidesAlongItsAxis) {
  for (const auto& [text, direction] : {std::pair("1 0 0", Vec3(1, 0, 0)),
                                        {"0 1 0", Vec3(0, 1, 0)},
                                        {"0 0 1", Vec3(0, 0, 1)},
                                        {"0 0 -1", Vec3(0, 0, -1)},
                                        {"-1 0 0", Vec3(-1, 0, 0)},
                                        {"0 -3 4", Vec3(0, -0.6, 0.8)}}) {
    Imported one(robot(link("slide") +
                       joint("rail", "prismatic", "world", "slide",
                             std::string("<origin xyz=\"1 2 3\" rpy=\"0.3 -0.7 1.9\"/><axis xyz=\"") + text +
                                 "\"/><limit lower=\"-1\" upper=\"1\"/><dynamics damping=\"7\" friction=\"8\"/>")));
    one.mechanism.state.q[0] = 0.25;
    one.mechanism.see();
    expect_pose(one.mechanism.pose("slide"), rpy(0.3, -0.7, 1.9),
                Vec3(1, 2, 3) + rpy(0.3, -0.7, 1.9) * direction * 0.25);
    EXPECT_EQ(one.joint("rail").first.viscous_friction, 7);
    EXPECT_EQ(one.joint("rail").first.coulomb_friction, 8);
    EXPECT_EQ(one.joint("rail").first.limit_stiffness, 1e4) << "of 1 kg";
    EXPECT_EQ(one.joint("rail").first.limit_damping, 200);
  }
}

TEST(JointTypes, AnAxisThatIsNotGivenIsX) {
  Imported one(robot(link("arm") + joint("turn", "continuous", "world", "arm", "")));
  one.mechanism.state.q[0] = 0.5;
  one.mechanism.see();
  expect_pose(one.mechanism.pose("arm"), math::rotation_x(0.5), {});
}

TEST(JointTypes, AFixedJointHoldsAndAFloatingOneDoesNot) {
  const std::string parts = link("base") + link("part") + link("thing", 2) +
                            joint("foot", "fixed", "world", "base", "<origin xyz=\"0 0 1\"/>") +
                            joint("bolt", "fixed", "base", "part", "<origin xyz=\"0 1 0\" rpy=\"0.1 0.2 0.3\"/>") +
                            joint("free", "floating", "part", "thing", "<origin xyz=\"1 0 0\"/>");
  Imported one(robot(parts));
  EXPECT_EQ(multibody::describe(one.mechanism.model).degrees_of_freedom, 6);
  expect_pose(one.mechanism.pose("part"), rpy(0.1, 0.2, 0.3), {0, 1, 1});
  expect_pose(one.mechanism.pose("thing"), rpy(0.1, 0.2, 0.3), Vec3(0, 1, 1) + rpy(0.1, 0.2, 0.3) * Vec3(1, 0, 0));
  const multibody::BodyPose start = one.mechanism.pose("thing");
  one.mechanism.run(0.5, 1e-3);
  // it falls along -z, and nothing turns it
  const multibody::BodyPose later = one.mechanism.pose("thing");
  EXPECT_NEAR(later.position[2], start.position[2] - 9.81 * 0.125, 1e-12);
  EXPECT_NEAR(later.position[0], start.position[0], kRounding);
  expect_pose(one.mechanism.pose("part"), rpy(0.1, 0.2, 0.3), {0, 1, 1});
}

// on an inclined plane: the centre accelerates with what of gravity lies in the plane, whatever the body's shape
TEST(JointTypes, APlanarJointSlidesInItsPlane) {
  const Vec3 normal = Vec3(0.3, -0.2, 0.9) * (1 / std::sqrt(0.94));
  const scene::Scene scene = testing::imported_scene(robot(
      link("puck") + joint("table", "planar", "world", "puck", "<origin xyz=\"1 2 3\"/><axis xyz=\"0.3 -0.2 0.9\"/>")));
  multibody::testing::Formulated puck(scene.mechanics);
  EXPECT_EQ(puck.model.degrees_of_freedom(), 3);
  const Vec3 start(puck.pose("puck").center_of_mass);
  puck.run(0.5, 1e-3);
  const Vec3 g(0, 0, -9.81), expected = start + (g - normal * dot(g, normal)) * 0.125;
  EXPECT_LT(norm(Vec3(puck.pose("puck").center_of_mass) - expected), 1e-9);
  const multibody::BodyPose pose = puck.pose("puck");
  expect_pose(pose, Mat3::identity(), Vec3(pose.position));
}

TEST(JointTypes, ARootWithMassIsFixedOrFree) {
  const std::string text = "<robot name=\"r\">" + link("hull") + link("arm") +
                           joint("turn", "continuous", "hull", "arm", "<axis xyz=\"0 0 1\"/>") + "</robot>";
  EXPECT_EQ(multibody::describe(Imported(text).mechanism.model).degrees_of_freedom, 1);
  const Imported free(text, RootMount::floating);
  EXPECT_EQ(multibody::describe(free.mechanism.model).degrees_of_freedom, 7);
  EXPECT_EQ(free.joint("hull_mount").type, multibody::JointType::floating);
}

// a chain of frames without mass, before, between and behind the bodies
TEST(JointTypes, LinksWithoutMassKeepWhatHangsOnThemInPlace) {
  const std::string frames = "<link name=\"f1\"/><link name=\"f2\"/><link name=\"f3\"/><link name=\"tip\"/>";
  const std::string origin = "<origin xyz=\"0.5 0.1 0\" rpy=\"0.2 0.3 -0.4\"/>";
  const std::string parts = frames + link("arm") + link("hand") + joint("j1", "fixed", "world", "f1", origin) +
                            joint("j2", "continuous", "f1", "f2", origin) + joint("j3", "fixed", "f2", "arm", origin) +
                            joint("j4", "fixed", "f2", "f3", origin) + joint("j5", "continuous", "f3", "hand", origin) +
                            joint("j6", "fixed", "hand", "tip", origin);
  const Imported one(robot(parts));
  EXPECT_EQ(one.scene.mechanics.bodies.size(), 2u);
  EXPECT_EQ(multibody::describe(one.mechanism.model).degrees_of_freedom, 2);
  const Mat3 R = rpy(0.2, 0.3, -0.4);
  const Vec3 p(0.5, 0.1, 0);
  expect_pose(one.mechanism.pose("arm"), R * R * R, p + R * (p + R * p));
  expect_pose(one.mechanism.pose("hand"), R * R * R * R, p + R * (p + R * (p + R * p)));
}

// limits a whole turn away and more are the same joint
TEST(JointTypes, LimitsFarFromZeroAreTakenBackByWholeTurns) {
  const auto limited = [](double lower, double upper) {
    return robot(link("arm") + joint("turn", "revolute", "world", "arm",
                                     fmt::format("<limit lower=\"{}\" upper=\"{}\"/>", lower, upper)));
  };
  const Imported near(limited(0.5, 1.5)), far(limited(0.5 + 2 * M_PI, 1.5 + 2 * M_PI));
  EXPECT_NEAR(near.mechanism.value("turn.position"), 1, kRounding);
  EXPECT_NEAR(far.mechanism.value("turn.position"), 1, kRounding);
  EXPECT_NEAR(far.joint("turn").first.limit_min, 0.5, kRounding);
  EXPECT_NEAR(far.joint("turn").first.limit_max, 1.5, kRounding);
  // about half a turn, from either side
  for (const double sign : {-1.0, 1.0}) {
    const Imported half(limited(sign * M_PI - 0.2, sign * M_PI + 0.2));
    const double start = half.mechanism.value("turn.position");
    EXPECT_GT(start, half.joint("turn").first.limit_min);
    EXPECT_LT(start, half.joint("turn").first.limit_max);
  }
}

TEST(JointTypes, WhatIsOnlySeenBecomesComments) {
  const scene::TemporaryFolder folder;
  const std::string text =
      import_file(
          folder.write(
              "r.urdf",
              robot("<link name=\"a\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/></inertial>"
                    "<visual><origin xyz=\"0 0 1\"/><geometry><box size=\"1 2 3\"/></geometry></visual>"
                    "<visual><geometry><mesh filename=\"a\nb.stl\" scale=\"0.001 0.001 "
                    "0.002\"/></geometry></visual></link>" +
                    joint("j", "floating", "world", "a", ""))))
          .text;
  EXPECT_NE(text.find("    # visual: box [1, 2, 3] m, position [0, 0, 1] m\n"), std::string::npos) << text;
  EXPECT_NE(text.find("    # visual: mesh a b.stl, scale [0.001, 0.001, 0.002], which no unit can express"),
            std::string::npos)
      << text;
}

}  // namespace joint_types_test
}  // namespace slew::urdf
