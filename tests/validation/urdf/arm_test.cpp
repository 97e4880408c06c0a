// SPDX-License-Identifier: Apache-2.0
// The two-link arm of examples/urdf against Lagrange's equations written by hand.
//
// q1 of the upper arm from upright, q2 of the forearm from the upper arm, about +y; gravity along -z. With lengths L1,
// centres c1, c2, masses and moments about the centres:
//   M11 = I1 + m1 c1^2 + I2 + m2 (L1^2 + c2^2 + 2 L1 c2 cos q2),  M12 = I2 + m2 (c2^2 + L1 c2 cos q2),  M22 = I2 + m2
//   c2^2 k1 = -h (2 q1' q2' + q2'^2),  k2 = h q1'^2,   h = m2 L1 c2 sin q2 g1 = -g ((m1 c1 + m2 L1) sin q1 + m2 c2
//   sin(q1 + q2)),  g2 = -g m2 c2 sin(q1 + q2) M q'' = tau - k - g
// Both are exact, the difference is rounding.
#include <fstream>
#include <sstream>

#include "build_paths.h"
#include "tests/validation/urdf/imported.h"

namespace slew::urdf {
namespace arm_test {

using testing::Imported;

std::string example() {
  std::ifstream in(SLEWRING_SOURCE_DIR "/examples/urdf/two_link_arm.urdf");
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

std::array<double, 2> by_hand(const std::vector<double>& q, const std::vector<double>& u,
                              const std::vector<double>& tau) {
  constexpr double g = 9.81, L1 = 1, c1 = 0.5, c2 = 0.4, m1 = 3, m2 = 2, I1 = 0.25, I2 = 0.10666666666666667;
  const double h = m2 * L1 * c2 * std::sin(q[1]);
  const double M11 = I1 + m1 * c1 * c1 + I2 + m2 * (L1 * L1 + c2 * c2 + 2 * L1 * c2 * std::cos(q[1]));
  const double M12 = I2 + m2 * (c2 * c2 + L1 * c2 * std::cos(q[1])), M22 = I2 + m2 * c2 * c2;
  const double tip = -g * m2 * c2 * std::sin(q[0] + q[1]);
  const double r1 = tau[0] + h * (2 * u[0] * u[1] + u[1] * u[1]) + g * (m1 * c1 + m2 * L1) * std::sin(q[0]) - tip;
  const double r2 = tau[1] - h * u[0] * u[0] - tip;
  const double determinant = M11 * M22 - M12 * M12;
  return {(M22 * r1 - M12 * r2) / determinant, (M11 * r2 - M12 * r1) / determinant};
}

TEST(TwoLinkArm, AcceleratesAsInLagrangesEquations) {
  Imported arm(example());
  ASSERT_EQ(arm.mechanism.state.q.size(), 2u);
  double largest = 0;
  for (const double q1 : {-2.0, 0.35, 1.2, 2.8}) {
    for (const double q2 : {-1.9, 0.0, 0.4, 3.0}) {
      for (const double speed : {0.0, 1.5, -4.0}) {
        const std::vector<double> q = {q1, q2}, u = {speed, 1 - speed}, tau = {3 * speed, -2};
        const auto expected = by_hand(q, u, tau);
        const std::vector<double> got = arm.accelerations(q, u, tau);
        const double scale = std::hypot(expected[0], expected[1]);
        largest = std::max({largest, std::abs(got[0] - expected[0]) / scale, std::abs(got[1] - expected[1]) / scale});
      }
    }
  }
  RecordProperty("difference", std::to_string(largest * 1e15) + "e-15");
  EXPECT_LT(largest, 1e-12);
}

TEST(TwoLinkArm, HasTheLawsOfItsJoints) {
  const Imported arm(example());
  const multibody::JointDef &shoulder = arm.joint("shoulder"), &elbow = arm.joint("elbow");
  EXPECT_EQ(shoulder.first.viscous_friction, 0.5);
  EXPECT_EQ(shoulder.first.coulomb_friction, 0.2);
  EXPECT_EQ(shoulder.first.limit_min, 0.35);
  EXPECT_EQ(shoulder.first.limit_max, 2.8);
  EXPECT_EQ(elbow.first.limit_max, multibody::kUnlimited);
  EXPECT_EQ(elbow.first.viscous_friction, 0.3);
  // stops: what hangs on the shoulder, both bars about its axis, stretched: 0.25 + 0.75 + 0.10667 + 2 x 1.4^2
  const double hanging = 0.25 + 0.75 + 0.10666666666666667 + 2 * 1.96;
  EXPECT_NEAR(shoulder.first.limit_stiffness, 1e4 * hanging, 1e-8);
  EXPECT_NEAR(shoulder.first.limit_damping, 200 * hanging, 1e-10);
  // 0 is outside of the limits: it starts between them, and there the scene's coordinate is URDF's
  EXPECT_NEAR(arm.mechanism.value("shoulder.position"), (0.35 + 2.8) / 2, 1e-14);
  EXPECT_NEAR(arm.mechanism.value("elbow.position"), 0, 1e-14);
}

}  // namespace arm_test
}  // namespace slew::urdf
