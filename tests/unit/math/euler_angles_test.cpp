// SPDX-License-Identifier: Apache-2.0
#include "math/euler_angles.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/rotation.h"

namespace slew::math {
namespace euler_angles_test {

constexpr double kRounding = 4e-15;

double difference(const Mat3& a, const Mat3& b) {
  double largest = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) largest = std::max(largest, std::abs(a(i, j) - b(i, j)));
  }
  return largest;
}

// every rotation, also those where two of the axes are the same or nearly
TEST(EulerAngles, GiveTheirRotationBackEverywhere) {
  const double some[] = {-M_PI, -3, -M_PI / 2, -1.1, -1e-9, 0, 1e-13, 1e-7, 0.4, M_PI / 2, 2.5, M_PI - 1e-9, M_PI};
  for (const double a : some) {
    for (const double b : some) {
      for (const double c : some) {
        const Mat3 zxz = rotation_zxz({a, b, c}), xyz = rotation_xyz({a, b, c});
        for (const Mat3& R : {zxz, xyz}) {
          EXPECT_LT(difference(rotation_zxz(angles_zxz(R)), R), kRounding) << a << " " << b << " " << c;
          EXPECT_LT(difference(rotation_xyz(angles_xyz(R)), R), kRounding) << a << " " << b << " " << c;
        }
      }
    }
  }
}

TEST(EulerAngles, AreTheGivenOnesWhereTheyAreUnique) {
  const auto zxz = angles_zxz(rotation_zxz({0.3, 1.1, -2}));
  const auto xyz = angles_xyz(rotation_xyz({0.3, 1.1, -2}));
  for (const auto& angles : {zxz, xyz}) {
    EXPECT_NEAR(angles[0], 0.3, kRounding);
    EXPECT_NEAR(angles[1], 1.1, kRounding);
    EXPECT_NEAR(angles[2], -2, kRounding);
  }
  const auto none = angles_zxz(Mat3::identity());
  for (const double angle : none) EXPECT_EQ(angle, 0);
}

}  // namespace euler_angles_test
}  // namespace slew::math
