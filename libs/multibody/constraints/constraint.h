// SPDX-License-Identifier: Apache-2.0
// The constraints of a joint as scalar rows between two links: value, gradient and the part of the second derivative
// that does not depend on accelerations.
//
// Joint frame i (point P_i, axes x_i y_i z_i) is fixed to link i; d = P_2 - P_1. Three laws make every joint:
//   in_plane(a)          g = a_1 . d - c           P_2 stays in a plane of frame 1 with the normal a_1       (1)
//                                                  (or P_1 in one of frame 2: the same with 1 and 2 exchanged)
//   perpendicular(a, b)  g = a_1 . b_2 - c         the angle between two axes stays                           (2)
//   distance             g = (d . d - c^2) / (2c)  P_2 stays on a sphere about P_1, c its radius              (3)
// and, with every vector in Ground axes, w_i the links' angular velocities and v_i the velocities of P_i,
//   (1)  g' = a_1 . (v_2 - v_1) + w_1 . (a_1 x d)
//        b  = a_1 . (w_2 x (w_2 x s_2) - w_1 x (w_1 x s_1)) + 2 (w_1 x a_1) . (v_2 - v_1) + (w_1 x (w_1 x a_1)) . d
//   (2)  g' = (w_1 - w_2) . (a_1 x b_2)
//        b  = (w_1 x (w_1 x a_1)) . b_2 + 2 (w_1 x a_1) . (w_2 x b_2) + a_1 . (w_2 x (w_2 x b_2))
//   (3)  g' = d . (v_2 - v_1) / c,  b = (d . (w_2 x (w_2 x s_2) - w_1 x (w_1 x s_1)) + |v_2 - v_1|^2) / c
// where s_i = P_i - origin of link i, g'' = G a + b, a the accelerations (origin, angular) of the two links.
// The angles that are joint coordinates (turn, first_turn, second_turn) are rows for prescribed motion: g is the angle
// less that of its law, to the nearest turn, and rate and b are less its derivatives; so is (1) with a law.
// Rows are in m, m/s for (1), (3) and in 1, rad/s for (2). Sources: Haug 1989, chapter 9 (basic constraints); the
// joints are those of table 1 of the flexible-body tutorial thesis (2017), the universal's axes as in the errata.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "multibody/joints/joint_axes.h"
#include "multibody/model/state.h"

namespace slew::multibody {

// A distance that was given as zero has no direction: massless links need a length.
inline constexpr double kShortestLink = 1e-9;  // m

// The rows of a joint type for frames that stand to each other as given (frame 2 in frame 1). The massless links (two
// balls, hinge and ball, two hinges about z_1 and z_2) keep their given lengths and angles, the others are closed at
// offset zero. Empty for a floating joint. Allocates.
[[nodiscard]] std::vector<ConstraintRow> rows_of(JointType type, const math::Mat3& R_12, math::Vec3 p_12);

// The row of a joint's coordinate, as coordinate() counts them. Pre-condition: the joint has it.
[[nodiscard]] ConstraintRow coordinate_row(JointType type, int number) noexcept;

[[nodiscard]] constexpr bool is_angle(RowForm form) noexcept {
  return form == RowForm::perpendicular || form >= RowForm::turn;
}

// A joint of the scene between the links of its bodies, without rows.
[[nodiscard]] Constraint constraint_between(const Model& model, int joint);

// Name of a row, "position along x" or "angle between z and x", for messages. Allocates.
[[nodiscard]] std::string describe(const ConstraintRow& row);

// One value per row of the constraint. drives: values of the laws that its rows follow, by Model::drives.
// Pre-condition: for a distance, P_1 and P_2 are apart.
void evaluate(const Constraint& constraint, const LinkMotion& link1, const LinkMotion& link2,
              std::span<const MotionValue> drives, std::span<RowValue> values) noexcept;

// g'' of a row with u' = 0, from the links' motion.
[[nodiscard]] inline double acceleration_of(const RowValue& row, const LinkMotion& link1,
                                            const LinkMotion& link2) noexcept {
  return row.bias + dot(row.G.v1, link1.a) + dot(row.G.w1, link1.alpha) + dot(row.G.v2, link2.a) +
         dot(row.G.w2, link2.alpha);
}

// A coordinate of a joint that is cut, measured between its frames: number 0 or 1 of a universal or cylindrical joint,
// 0 of a revolute or prismatic one. g is its value, an angle in (-pi, pi]. Pre-condition: the joint has it.
[[nodiscard]] RowValue coordinate(JointType type, int number, const Constraint& constraint, const LinkMotion& link1,
                                  const LinkMotion& link2) noexcept;

// A single row between the constraint's frames, not necessarily one of the constraint.
[[nodiscard]] RowValue evaluate(const ConstraintRow& row, const Constraint& constraint, const LinkMotion& link1,
                                const LinkMotion& link2, std::span<const MotionValue> drives) noexcept;

// Speed of a row's law, which its rate subtracts from G v; 0 without a law.
[[nodiscard]] inline double prescribed_rate(const Constraint& constraint, std::size_t row,
                                            std::span<const MotionValue> drives) noexcept {
  const int drive = constraint.rows[row].drive;
  return drive < 0 ? 0.0 : drives[static_cast<std::size_t>(drive)].speed;
}

}  // namespace slew::multibody
