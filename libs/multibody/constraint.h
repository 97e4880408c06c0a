// What a joint forbids, as scalar rows between two links: value, gradient and the part of the second derivative that
// does not depend on accelerations.
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
// Rows are in m, m/s for (1), (3) and in 1, rad/s for (2). Sources: Haug 1989, chapter 9 (basic constraints); the
// joints are those of table 1 of the flexible-body tutorial thesis (2017), the universal's axes as in the errata.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "multibody/state.h"

namespace slew::multibody {

inline constexpr int kMaxJointRows = 6;

enum class RowForm : std::uint8_t { in_plane, in_plane_of_2, perpendicular, distance };

struct ConstraintRow {
  RowForm form = RowForm::in_plane;
  int axis1 = 0;      // 0 x, 1 y, 2 z: a, of frame 1
  int axis2 = 0;      // b, of frame 2
  double offset = 0;  // c [m or 1]
};

// The rows of one joint between two links.
struct Constraint {
  int joint = 0;  // Model::joints
  int link1 = 0, link2 = 0;
  math::Mat3 R_L1, R_L2;  // frames in their links
  math::Vec3 p_L1, p_L2;  // m
  std::vector<ConstraintRow> rows;
};

// Gradient of a row with respect to the velocities of both links' origins and their angular velocities.
struct RowGradient {
  math::Vec3 v1, w1, v2, w2;
};

struct RowValue {
  double g = 0;     // m or 1
  double rate = 0;  // g' [m/s or 1/s]
  double bias = 0;  // b [m/s2 or 1/s2]
  RowGradient G;
};

// A distance that was given as zero has no direction: massless links need a length.
inline constexpr double kShortestLink = 1e-9;  // m

// The rows of a joint type for frames that stand to each other as given (frame 2 in frame 1). The massless links (two
// balls, hinge and ball, two hinges about z_1 and z_2) keep the lengths and angles that they are given, the others are
// closed at offset zero. Empty for a floating joint. Allocates.
[[nodiscard]] std::vector<ConstraintRow> rows_of(JointType type, const math::Mat3& R_12, math::Vec3 p_12);

// What a row holds, "position along x" or "angle between z and x": for messages. Allocates.
[[nodiscard]] std::string describe(const ConstraintRow& row);

// One value per row of the constraint. Pre-condition: for a distance, P_1 and P_2 are apart.
void evaluate(const Constraint& constraint, const LinkMotion& link1, const LinkMotion& link2,
              std::span<RowValue> values) noexcept;

// A single row that the constraint need not have, between the constraint's frames.
[[nodiscard]] RowValue evaluate(const ConstraintRow& row, const Constraint& constraint, const LinkMotion& link1,
                                const LinkMotion& link2) noexcept;

}  // namespace slew::multibody
