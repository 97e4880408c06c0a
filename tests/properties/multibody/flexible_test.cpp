// Flexible bodies in the recursion against the assembled equations of their mass points (assembled.h), on random trees.
#include <gtest/gtest.h>

#include "multibody/dynamics.h"
#include "tests/properties/multibody/assembled.h"
#include "tests/properties/multibody/random_tree.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace {

using namespace testing;

constexpr double kTolerance = 1e-9;

Vector to_vector(std::span<const double> values) {
  Vector v(static_cast<Eigen::Index>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) v[static_cast<Eigen::Index>(i)] = values[i];
  return v;
}

Real difference(const Vector& a, const Vector& b) {
  return (a - b).cwiseAbs().maxCoeff() / (1 + b.cwiseAbs().maxCoeff());
}

class FlexibleTrees : public ::testing::TestWithParam<unsigned> {
 protected:
  RandomTree tree(bool with_dummies = false) const {
    return random_tree(GetParam(), {.bodies = 1 + static_cast<int>(GetParam()) % 7,
                                    .with_dummies = with_dummies,
                                    .two_coordinates = true,
                                    .with_modes = true});
  }
};

TEST_P(FlexibleTrees, AccelerateAsTheirMassPoints) {
  const RandomTree random = tree();
  Mechanism mechanism(random.def, random.rows);
  if (mechanism.model.degrees_of_freedom() == 0) GTEST_SKIP() << "all joints are fixed";
  const Assembled reference(random.def, mechanism.model, random.points);
  const State state = random_state(GetParam(), mechanism.model);
  evaluate(mechanism.model, state, mechanism.ws);
  const Vector q = to_vector(state.q), u = to_vector(state.u);
  EXPECT_LT(difference(to_vector(mechanism.ws.udot_free), reference.accelerations(q, u)), kTolerance);
}

INSTANTIATE_TEST_SUITE_P(Seeds, FlexibleTrees, ::testing::Range(1u, 41u));

}  // namespace
}  // namespace slew::multibody
