// SPDX-License-Identifier: Apache-2.0
// Inertia of links whose inertial frames are turned: hand-transformed tensors, and masses on a rigid frame whose tensor
// is summed in the link's axes directly.
#include <fmt/format.h>

#include "tests/validation/urdf/imported.h"

namespace slew::urdf {
namespace inertia_test {

using testing::Imported;

std::string floating_link(const std::string& inertial) {
  return "<robot name=\"r\"><link name=\"world\"/><link name=\"a\"><inertial>" + inertial +
         "</inertial></link><joint name=\"j\" type=\"floating\"><parent link=\"world\"/><child "
         "link=\"a\"/></joint></robot>";
}

std::string inertial(const std::string& origin, double mass, const Triple& moments, const Triple& products) {
  return fmt::format(
      "<origin {}/><mass value=\"{}\"/><inertia ixx=\"{}\" iyy=\"{}\" izz=\"{}\" ixy=\"{}\" ixz=\"{}\" iyz=\"{}\"/>",
      origin, mass, moments[0], moments[1], moments[2], products[0], products[1], products[2]);
}

void expect_triple(const Triple& got, const Triple& expected, double tolerance) {
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(got[i], expected[i], tolerance) << i;
}

constexpr Triple kMoments{2, 3, 4};
constexpr Triple kProducts{0.1, -0.2, 0.3};  // xy xz yz

TEST(TurnedInertia, WithoutATurnIsTakenAsItStands) {
  const Imported robot(floating_link(inertial("xyz=\"0.1 0.2 0.3\"", 5, kMoments, kProducts)));
  EXPECT_EQ(robot.body("a").inertia, kMoments);
  EXPECT_EQ(robot.body("a").products, kProducts);
  EXPECT_EQ(robot.body("a").center_of_mass, (Triple{0.1, 0.2, 0.3}));
  EXPECT_EQ(robot.body("a").mass, 5);
}

// yaw 90: the frame's x is the link's y, its y is -x
TEST(TurnedInertia, ByAQuarterOfYaw) {
  const Imported robot(floating_link(inertial("rpy=\"0 0 1.5707963267948966\"", 5, kMoments, kProducts)));
  expect_triple(robot.body("a").inertia, {3, 2, 4}, 1e-15);
  expect_triple(robot.body("a").products, {-0.1, -0.3, -0.2}, 1e-15);
}

// roll 90: the frame's y is the link's z, its z is -y
TEST(TurnedInertia, ByAQuarterOfRoll) {
  const Imported robot(floating_link(inertial("rpy=\"1.5707963267948966 0 0\"", 5, kMoments, kProducts)));
  expect_triple(robot.body("a").inertia, {2, 4, 3}, 1e-15);
  expect_triple(robot.body("a").products, {0.2, 0.1, -0.3}, 1e-15);
}

struct PointMass {
  double m;
  Triple at;
};

// moments and the tensor's elements off the diagonal of masses about their centre
void sum(const std::vector<PointMass>& masses, double& mass, Triple& centre, Triple& moments, Triple& products) {
  mass = 0;
  centre = moments = products = {};
  for (const PointMass& p : masses) {
    mass += p.m;
    for (std::size_t k = 0; k < 3; ++k) centre[k] += p.m * p.at[k];
  }
  for (double& c : centre) c /= mass;
  for (const PointMass& p : masses) {
    const double x = p.at[0] - centre[0], y = p.at[1] - centre[1], z = p.at[2] - centre[2];
    moments[0] += p.m * (y * y + z * z);
    moments[1] += p.m * (x * x + z * z);
    moments[2] += p.m * (x * x + y * y);
    products[0] -= p.m * x * y;
    products[1] -= p.m * x * z;
    products[2] -= p.m * y * z;
  }
}

// about the fixed axes x, then y, then z
Triple turned(const Triple& p, double roll, double pitch, double yaw) {
  Triple a{p[0], p[1] * std::cos(roll) - p[2] * std::sin(roll), p[1] * std::sin(roll) + p[2] * std::cos(roll)};
  a = {a[0] * std::cos(pitch) + a[2] * std::sin(pitch), a[1], -a[0] * std::sin(pitch) + a[2] * std::cos(pitch)};
  return {a[0] * std::cos(yaw) - a[1] * std::sin(yaw), a[0] * std::sin(yaw) + a[1] * std::cos(yaw), a[2]};
}

TEST(TurnedInertia, OfMassesOnAFrameIsTheirSumInTheLinksAxes) {
  const std::vector<PointMass> masses = {
      {1, {0.3, 0.1, -0.2}}, {2, {-0.4, 0.5, 0.1}}, {0.5, {0.2, -0.6, 0.7}}, {1.5, {0, 0.2, 0.4}}};
  constexpr double kRoll = 0.4, kPitch = -0.9, kYaw = 2.1;
  const Triple offset{0.2, -0.3, 0.5};  // offset of the inertial frame's origin, which is the centre of mass
  double mass = 0;
  Triple centre, moments, products;
  sum(masses, mass, centre, moments, products);
  const Imported robot(floating_link(
      inertial(fmt::format("xyz=\"{} {} {}\" rpy=\"{} {} {}\"", offset[0], offset[1], offset[2], kRoll, kPitch, kYaw),
               mass, moments, products)));
  std::vector<PointMass> in_link;
  for (const PointMass& p : masses) {
    const Triple a = turned({p.at[0] - centre[0], p.at[1] - centre[1], p.at[2] - centre[2]}, kRoll, kPitch, kYaw);
    in_link.push_back({p.m, {a[0] + offset[0], a[1] + offset[1], a[2] + offset[2]}});
  }
  Triple link_centre, link_moments, link_products;
  sum(in_link, mass, link_centre, link_moments, link_products);
  expect_triple(robot.body("a").center_of_mass, link_centre, 1e-14);
  expect_triple(robot.body("a").inertia, link_moments, 1e-14);
  expect_triple(robot.body("a").products, link_products, 1e-14);
}

}  // namespace inertia_test
}  // namespace slew::urdf
