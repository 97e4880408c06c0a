// Rows along every coordinate of the joints of random trees: with J the unit vector of its speed, W is what M^-1 has
// there, whatever the formulation.
#include <gtest/gtest.h>

#include "multibody/formulation.h"
#include "multibody/joint_axes.h"
#include "tests/properties/multibody/assembled.h"
#include "tests/properties/multibody/random_tree.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace {

using namespace testing;

constexpr Formulation kFormulations[] = {Formulation::recursive, Formulation::lagrange, Formulation::augmented};

class CoordinateRows : public ::testing::TestWithParam<unsigned> {};

TEST_P(CoordinateRows, SeeTheInverseOfTheMassMatrix) {
  const RandomTree tree =
      random_tree(GetParam(), {.bodies = 1 + static_cast<int>(GetParam()) % 9, .two_coordinates = true});
  std::vector<std::string> rows;
  for (const JointDef& joint : tree.def.joints) {
    for (int number = 0; number < coordinate_count(joint.type); ++number) rows.push_back(row_label(joint, number));
  }
  if (rows.empty()) GTEST_SKIP() << "no joint has a coordinate";
  for (const Formulation formulation : kFormulations) {
    Mechanism mechanism(tree.def, rows);
    const Assembled reference(tree.def, mechanism.model);
    State state = random_state(GetParam(), mechanism.model);
    Vector q(static_cast<Eigen::Index>(state.q.size())), u(static_cast<Eigen::Index>(state.u.size()));
    for (Eigen::Index i = 0; i < q.size(); ++i) q[i] = state.q[static_cast<std::size_t>(i)];
    for (Eigen::Index i = 0; i < u.size(); ++i) u[i] = state.u[static_cast<std::size_t>(i)];
    const Matrix mobility = reference.mass_matrix(q).inverse();
    const Vector udot = reference.accelerations(q, u);
    Dynamics dynamics(formulation, mechanism.model, state);
    dynamics.evaluate(mechanism.model, state, mechanism.ws);
    const double scale = 1 + static_cast<double>(mobility.cwiseAbs().maxCoeff());
    const double a_scale = 1 + static_cast<double>(udot.cwiseAbs().maxCoeff());
    const std::size_t count = rows.size();
    for (std::size_t k = 0; k < count; ++k) {
      const Row& row = mechanism.model.rows[k];
      const Link& link = mechanism.model.links[static_cast<std::size_t>(row.link)];
      const Eigen::Index own = link.u + row.place;
      EXPECT_NEAR(mechanism.ws.row_a_free[k], static_cast<double>(udot[own]), 1e-8 * a_scale) << rows[k];
      EXPECT_NEAR(mechanism.ws.row_v[k], static_cast<double>(u[own]), 1e-9 * a_scale) << rows[k];
      for (std::size_t l = 0; l < count; ++l) {
        const Row& other = mechanism.model.rows[l];
        const Eigen::Index column = mechanism.model.links[static_cast<std::size_t>(other.link)].u + other.place;
        EXPECT_NEAR(mechanism.ws.row_W[k * count + l], static_cast<double>(mobility(own, column)), 1e-8 * scale)
            << rows[k] << " " << rows[l];
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, CoordinateRows, ::testing::Range(1u, 25u));

}  // namespace
}  // namespace slew::multibody
