// SPDX-License-Identifier: Apache-2.0
#include "math/rotation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace slew::math {
namespace rotation_test {

constexpr double kRounding = 1e-14;

void expect_near(Vec3 a, Vec3 b) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], kRounding) << "component " << i;
}

void expect_near(const Mat3& a, const Mat3& b) {
  for (int i = 0; i < 3; ++i) expect_near(a.c[i], b.c[i]);
}

const Mat3 kTurn = rotation_xyz({0.3, -1.1, 2.0});

TEST(Vec3, CrossProductIsRightHandedAndAtRightAngles) {
  expect_near(cross(Vec3(1, 0, 0), Vec3(0, 1, 0)), Vec3(0, 0, 1));
  const Vec3 a(1, 2, 3), b(-4, 0.5, 2);
  EXPECT_NEAR(dot(cross(a, b), a), 0, kRounding);
  expect_near(skew(a) * b, cross(a, b));
}

TEST(Vec3, FourthLaneStaysZero) {
  const Vec3 a(1, 2, 3), b(-4, 0.5, 2);
  for (const Vec3 v : {cross(a, b), a + b, a * 3, kTurn * a, transpose(kTurn) * b, outer(a, b).c[1]}) {
    EXPECT_EQ(v.lanes[3], 0);
  }
  for (const Vec3 v : transpose(kTurn).c) EXPECT_EQ(v.lanes[3], 0);
}

TEST(Mat3, TransposeTurnsBack) {
  expect_near(transpose(kTurn) * kTurn, Mat3::identity());
  const Vec3 a(1, 2, 3);
  expect_near(transpose_multiply(kTurn, a), transpose(kTurn) * a);
}

TEST(Mat3, TimesSkewIsTheProduct) {
  const Vec3 r(0.2, -0.7, 1.3);
  expect_near(times_skew(kTurn, r), kTurn * skew(r));
}

TEST(Mat3, InverseOfASymmetricMatrixUndoesIt) {
  const Mat3 A = kTurn * Mat3::diagonal(1, 4, 9) * transpose(kTurn);
  expect_near(A * inverse_symmetric(A), Mat3::identity());
}

TEST(Mat3, EigenvaluesAreThoseOfThePrincipalAxes) {
  const auto values = symmetric_eigenvalues(kTurn * Mat3::diagonal(9, 1, 4) * transpose(kTurn));
  EXPECT_NEAR(values[0], 1, 1e-13);
  EXPECT_NEAR(values[1], 4, 1e-13);
  EXPECT_NEAR(values[2], 9, 1e-13);
}

TEST(Rotation, EulerAnglesOfAQuarterTurnEachSideTurnAboutY) {
  // the slewing pillar: 90, 37.5, -90 deg in z, x', z'' is 37.5 deg about y
  const double a = 37.5 * M_PI / 180;
  expect_near(rotation_zxz({M_PI / 2, a, -M_PI / 2}), rotation_y(a));
}

TEST(Rotation, SuccessiveRotationsMultiplyFromTheLeft) {
  expect_near(rotation_xyz({0.1, 0.2, 0.3}), rotation_x(0.1) * rotation_y(0.2) * rotation_z(0.3));
}

TEST(Quaternion, SurvivesTheWayThroughAMatrix) {
  // each of the four components largest in turn
  for (const Quaternion& q :
       {Quaternion{0.9, 0.1, 0.2, 0.3}, {0.1, 0.9, 0.2, -0.3}, {0.1, -0.2, 0.9, 0.3}, {0.1, 0.2, 0.3, 0.9}}) {
    const Quaternion unit = normalized(q), back = quaternion_of(rotation_of(q));
    EXPECT_NEAR(std::abs(unit.w * back.w + unit.x * back.x + unit.y * back.y + unit.z * back.z), 1, kRounding);
  }
}

TEST(Quaternion, OfAnyLengthGivesAnOrthogonalMatrix) {
  const Mat3 R = rotation_of({0.5, 1.5, -2, 0.25});
  expect_near(R * transpose(R), Mat3::identity());
}

TEST(Quaternion, ProductIsTheProductOfTheRotations) {
  const Quaternion a{0.9, 0.1, 0.2, 0.3}, b{0.2, -0.5, 0.4, 0.1};
  expect_near(rotation_of(a * b), rotation_of(a) * rotation_of(b));
}

TEST(Quaternion, DerivativeTurnsWithTheAngularVelocity) {
  const Quaternion q = normalized({0.9, 0.1, 0.2, 0.3});
  const Vec3 w(0.3, -0.2, 0.5);
  const Quaternion rate = derivative(q, w);
  const double h = 1e-5;
  const auto at = [&](double t) {
    return rotation_of({q.w + t * rate.w, q.x + t * rate.x, q.y + t * rate.y, q.z + t * rate.z});
  };
  const Mat3 numeric = (at(h) - at(-h)) * (0.5 / h), expected = skew(w) * rotation_of(q);
  for (int k = 0; k < 9; ++k) EXPECT_NEAR(numeric(k / 3, k % 3), expected(k / 3, k % 3), 1e-9);
}

TEST(Rotation, AngleIsThatOfTheTurn) {
  EXPECT_NEAR(rotation_angle(rotation_y(-0.4)), 0.4, kRounding);
  EXPECT_NEAR(rotation_angle(rotation_x(1e-7)), 1e-7, 1e-20);
  EXPECT_NEAR(rotation_angle(rotation_x(M_PI)), M_PI, 1e-7);
}

}  // namespace rotation_test
}  // namespace slew::math
