// SPDX-License-Identifier: Apache-2.0
// Rows along every coordinate of the joints of random trees, and about the axes of balls: with J the unit vector of the
// coordinate's speed, or the axis in the speeds of the ball, W equals J M^-1 J^T there, in every formulation.
#include <gtest/gtest.h>

#include "multibody/formulations/formulation.h"
#include "multibody/joints/joint_axes.h"
#include "tests/properties/multibody/assembled.h"
#include "tests/properties/multibody/random_tree.h"
#include "tests/support/nightly.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace joint_rows_test {

using namespace testing;
using namespace slew::testing;

constexpr Formulation kFormulations[] = {Formulation::recursive, Formulation::lagrange, Formulation::augmented};

// a row's speed v = J u, and J' u
struct Direction {
  Vector J;
  double bias = 0;
};

Direction direction_of(const Model& model, const Row& row, const Workspace& ws) {
  Direction direction{Vector(static_cast<Index>(ws.udot.size()))};
  const Link& link = model.links[static_cast<std::size_t>(row.link)];
  if (row.kind != RowKind::ball) {
    direction.J[link.u + row.place] = 1;
    return direction;
  }
  const Joint& joint = model.joints[static_cast<std::size_t>(row.element)];
  const Body &one = model.bodies[static_cast<std::size_t>(joint.body1)],
             &two = model.bodies[static_cast<std::size_t>(joint.body2)];
  const LinkMotion &link1 = ws.motion[static_cast<std::size_t>(one.link)],
                   &link2 = ws.motion[static_cast<std::size_t>(two.link)];
  const math::Vec3 axis = link1.R * (one.R_LB * (joint.R_B1.c[row.number]));
  // the speeds of a ball are those of the link seen from its parent, in Ground axes
  const double sign = two.link == row.link ? 1 : -1;
  for (int k = 0; k < 3; ++k) direction.J[link.u + k] = sign * axis[k];
  direction.bias = dot(cross(link1.w, axis), link2.w - link1.w);
  return direction;
}

TEST(CoordinateRows, SeeTheInverseOfTheMassMatrix) {
  for_each_seed(seeds({{1, 24}}), [](std::uint32_t seed) {
    const RandomTree tree = random_tree(seed, {.bodies = 1 + static_cast<int>(seed) % 9, .two_coordinates = true});
    std::vector<std::string> rows;
    for (const JointDef& joint : tree.def.joints) {
      for (int number = 0; number < row_count(joint.type); ++number) rows.push_back(row_label(joint, number));
    }
    if (rows.empty()) return;  // no joint has a coordinate
    for (const Formulation formulation : kFormulations) {
      Mechanism mechanism(tree.def, rows);
      const Assembled reference(tree.def, mechanism.model);
      State state = random_state(seed, mechanism.model);
      const Vector q = to_vector(state.q), u = to_vector(state.u);
      const Matrix mobility = inverse(reference.mass_matrix(q));
      const Vector udot = reference.accelerations(q, u);
      Dynamics dynamics(formulation, mechanism.model, state);
      dynamics.evaluate(mechanism.model, state, mechanism.ws);
      const double scale = 1 + static_cast<double>(mobility.largest());
      const double a_scale = 1 + static_cast<double>(udot.largest());
      const std::size_t count = rows.size();
      std::vector<Direction> directions;
      for (const Row& row : mechanism.model.rows)
        directions.push_back(direction_of(mechanism.model, row, mechanism.ws));
      for (std::size_t k = 0; k < count; ++k) {
        const Vector& J = directions[k].J;
        EXPECT_NEAR(mechanism.ws.row_a_free[k], static_cast<double>(J.dot(udot)) + directions[k].bias, 1e-8 * a_scale)
            << rows[k];
        EXPECT_NEAR(mechanism.ws.row_v[k], static_cast<double>(J.dot(u)), 1e-9 * a_scale) << rows[k];
        const Vector response = mobility * J;
        for (std::size_t l = 0; l < count; ++l) {
          EXPECT_NEAR(mechanism.ws.row_W[k * count + l], static_cast<double>(directions[l].J.dot(response)),
                      1e-8 * scale)
              << rows[k] << " " << rows[l];
        }
      }
    }
  });
}

}  // namespace joint_rows_test
}  // namespace slew::multibody
