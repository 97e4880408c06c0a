// SPDX-License-Identifier: Apache-2.0
// Rows of joints: against the motions that a joint allows, finite and exact, and against difference quotients.
#include "multibody/constraints/constraint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "tests/support/reference_algebra.h"

namespace slew::multibody {
namespace constraint_test {

using math::Mat3;
using math::Vec3;

struct Kind {
  JointType type;
  const char* name;
  int rows;
};

constexpr Kind kKinds[] = {
    {JointType::floating, "floating", 0},
    {JointType::spherical, "spherical", 3},
    {JointType::universal, "universal", 4},
    {JointType::revolute, "revolute", 5},
    {JointType::prismatic, "prismatic", 5},
    {JointType::cylindrical, "cylindrical", 4},
    {JointType::fixed, "fixed", 6},
    {JointType::in_plane, "in_plane", 1},
    {JointType::in_line, "in_line", 2},
    {JointType::perpendicular, "perpendicular", 1},
    {JointType::spherical_spherical, "spherical_spherical", 1},
    {JointType::revolute_spherical, "revolute_spherical", 2},
    {JointType::revolute_revolute, "revolute_revolute", 4},
};

class Joints : public ::testing::TestWithParam<Kind> {
 protected:
  double uniform(double largest = 1) { return std::uniform_real_distribution<double>(-largest, largest)(random_); }
  Vec3 vector(double largest = 1) { return {uniform(largest), uniform(largest), uniform(largest)}; }
  Mat3 rotation() { return math::rotation_xyz({uniform(3), uniform(3), uniform(3)}); }

  // frame 2 in frame 1, moved from where the joint began by amounts that it allows
  void move_joint(bool at_start) {
    const auto amount = [&](double largest) { return at_start ? 0.0 : uniform(largest); };
    const Mat3 turned_z = math::rotation_z(amount(2));
    const Mat3 any_turn = at_start ? Mat3::identity() : rotation();
    switch (GetParam().type) {
      case JointType::floating:
        R_12 = any_turn;
        p_12 = Vec3(amount(2), amount(2), amount(2));
        break;
      case JointType::spherical:
        R_12 = any_turn;
        p_12 = Vec3();
        break;
      case JointType::universal:
        R_12 = turned_z * math::rotation_x(M_PI / 2) * math::rotation_z(amount(2));
        p_12 = Vec3();
        break;
      case JointType::revolute:
        R_12 = turned_z;
        p_12 = Vec3();
        break;
      case JointType::prismatic:
        R_12 = Mat3::identity();
        p_12 = Vec3(0, 0, amount(2));
        break;
      case JointType::cylindrical:
        R_12 = turned_z;
        p_12 = Vec3(0, 0, amount(2));
        break;
      case JointType::fixed:
      case JointType::node:
        R_12 = Mat3::identity();
        p_12 = Vec3();
        break;
      case JointType::in_plane:
        R_12 = any_turn;
        p_12 = Vec3(amount(2), amount(2), 0);
        break;
      case JointType::in_line:
        R_12 = any_turn;
        p_12 = Vec3(0, 0, amount(2));
        break;
      case JointType::perpendicular:
        R_12 = turned_z * math::rotation_x(M_PI / 2) * math::rotation_z(amount(2));
        p_12 = Vec3(amount(2), amount(2), amount(2));
        break;
      case JointType::spherical_spherical:
        R_12 = any_turn;
        p_12 = any_turn * Vec3(0.3, -0.4, 1.2);
        break;
      case JointType::revolute_spherical:
        // the link turns about z of frame 1
        R_12 = any_turn;
        p_12 = turned_z * Vec3(0.7, 0.2, 0.4);
        break;
      case JointType::revolute_revolute:
        // the link turns about z of frame 1, body 2 about an axis of the link
        p_12 = turned_z * Vec3(0.7, 0.2, 0.4);
        R_12 = turned_z * hinge_in_link * math::rotation_z(amount(2));
        break;
    }
  }

  // both links at random poses, the joint's frames at random poses in them, with the relative pose R_12, p_12
  void place_links() {
    for (LinkMotion* link : {&link1, &link2}) {
      link->w = vector(2);
      link->v = vector(2);
    }
    link1.R = rotation();
    link1.p = vector(3);
    const Mat3 frame1 = link1.R * constraint.R_L1;
    const Vec3 P1 = link1.p + link1.R * constraint.p_L1;
    link2.R = frame1 * R_12 * transpose(constraint.R_L2);
    link2.p = P1 + frame1 * p_12 - link2.R * constraint.p_L2;
  }

  void build() {
    move_joint(true);
    constraint.R_L1 = rotation();
    constraint.R_L2 = rotation();
    constraint.p_L1 = vector();
    constraint.p_L2 = vector();
    constraint.rows = rows_of(GetParam().type, R_12, p_12);
  }

  [[nodiscard]] std::vector<RowValue> values(const LinkMotion& one, const LinkMotion& two) const {
    std::vector<RowValue> row(constraint.rows.size());
    evaluate(constraint, one, two, {}, row);
    return row;
  }
  [[nodiscard]] std::vector<RowValue> values() const { return values(link1, link2); }

  // the link after t with constant velocities: no accelerations
  static LinkMotion after(const LinkMotion& link, double t) {
    LinkMotion moved = link;
    moved.p += link.v * t;
    const double rate = norm(link.w), angle = rate * t;
    const Mat3 K = math::skew(link.w * (1 / rate));
    const math::SinCos turn = math::sin_cos(angle);
    moved.R = link.R + K * link.R * turn.sin + K * (K * link.R) * (1 - turn.cos);
    return moved;
  }

  Mat3 hinge_in_link = math::rotation_xyz({0.4, -0.3, 0.2});
  Mat3 R_12 = Mat3::identity();
  Vec3 p_12;
  Constraint constraint;
  LinkMotion link1, link2;

 private:
  std::mt19937 random_{11};
};

TEST_P(Joints, HaveTheRowsOfTheirType) {
  build();
  EXPECT_EQ(static_cast<int>(constraint.rows.size()), GetParam().rows);
  for (const ConstraintRow& row : constraint.rows) EXPECT_FALSE(describe(row).empty());
}

TEST_P(Joints, AllowTheirMotionsHoweverLarge) {
  build();
  for (int i = 0; i < 50; ++i) {
    move_joint(false);
    place_links();
    for (const RowValue& row : values()) EXPECT_NEAR(row.g, 0, 1e-14);
  }
}

TEST_P(Joints, HaveIndependentRows) {
  build();
  for (int i = 0; i < 20; ++i) {
    move_joint(false);
    place_links();
    slew::testing::Dense<long double> G(GetParam().rows, 12);
    int r = 0;
    for (const RowValue& row : values()) {
      int c = 0;
      for (const Vec3 part : {row.G.v1, row.G.w1, row.G.v2, row.G.w2}) {
        for (int k = 0; k < 3; ++k) G(r, c++) = part[k];
      }
      ++r;
    }
    const auto rank = r == 0 ? 0 : slew::testing::column_rank(G, r * std::numeric_limits<double>::epsilon());
    EXPECT_EQ(rank, r);
  }
}

// also away from where the joint is closed: a solver meets such places
TEST_P(Joints, HaveRatesThatAreTheDerivativeOfTheirValues) {
  build();
  constexpr double h = 1e-5;
  for (int i = 0; i < 20; ++i) {
    R_12 = rotation();
    p_12 = vector(2);
    place_links();
    const std::vector<RowValue> now = values();
    const std::vector<RowValue> before = values(after(link1, -h), after(link2, -h));
    const std::vector<RowValue> later = values(after(link1, h), after(link2, h));
    for (std::size_t k = 0; k < now.size(); ++k) {
      EXPECT_NEAR(now[k].rate, (later[k].g - before[k].g) / (2 * h), 1e-8);
      EXPECT_NEAR(now[k].bias, (later[k].rate - before[k].rate) / (2 * h), 1e-7);
      const RowGradient& G = now[k].G;
      EXPECT_NEAR(now[k].rate, dot(G.v1, link1.v) + dot(G.w1, link1.w) + dot(G.v2, link2.v) + dot(G.w2, link2.w),
                  1e-12);
    }
  }
}

std::string kind_name(const ::testing::TestParamInfo<Kind>& kind) {
  return kind.param.name;
}

INSTANTIATE_TEST_SUITE_P(Thirteen, Joints, ::testing::ValuesIn(kKinds), kind_name);

// the angle of parallel hinges has no gradient: another pair of rows holds them
TEST(MasslessLink, OfParallelHingesHasFourIndependentRows) {
  const std::vector<ConstraintRow> rows = rows_of(JointType::revolute_revolute, Mat3::identity(), Vec3(0.5, 0, 0.1));
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[2].form, RowForm::perpendicular);
  EXPECT_EQ(rows[3].form, RowForm::perpendicular);
}

}  // namespace constraint_test
}  // namespace slew::multibody
