// SPDX-License-Identifier: Apache-2.0
// A cylinder's masses on its line of force against the same cylinder as two real bodies in a loop: with no inertia
// about the line both are the same mechanism, so positions, speeds and reactions must agree.
#include "tests/validation/multibody/crane_def.h"
#include "tests/validation/multibody/cylinder_bodies.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace cylinder_test {

using testing::Formulated;

MechanicsDef with_bodies() {
  MechanicsDef def = testing::crane_def();
  testing::replace_dummies(def, "ForceT_Lift", {0, 0, 1});
  testing::replace_dummies(def, "ForceT_Jib", {0, 0, 1});
  return def;
}

class Cylinders : public ::testing::TestWithParam<Formulation> {};

TEST_P(Cylinders, AsBodiesMoveAsTheirMassesOnTheLine) {
  MechanicsDef simple = testing::crane_def(), real = with_bodies();
  simple.formulation = real.formulation = GetParam();
  Formulated dummies(simple), bodies(real);
  EXPECT_EQ(bodies.model.degrees_of_freedom(), dummies.model.degrees_of_freedom());
  for (int i = 0; i < 10; ++i) {
    dummies.run(0.1, 1e-3);
    bodies.run(0.1, 1e-3);
    for (const BodyDef& body : simple.bodies) {
      const BodyPose a = dummies.pose(body.name), b = bodies.pose(body.name);
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(a.position[k], b.position[k], 1e-8) << body.name << " at " << i;
        EXPECT_NEAR(a.velocity[k], b.velocity[k], 1e-7) << body.name << " at " << i;
      }
    }
    EXPECT_NEAR(dummies.total_energy(), bodies.total_energy(), 1e-5);
  }
}

TEST_P(Cylinders, AsBodiesGiveTheSameRowsToTheirActuators) {
  const std::vector<std::string> rows = {"ForceT_Lift", "ForceT_Jib", "ForceR_Pillar"};
  const Model a = build_model(testing::crane_def(), rows), b = build_model(with_bodies(), rows);
  State state_a = start_state(a), state_b = start_state(b);
  Workspace ws_a(a), ws_b(b);
  Dynamics(GetParam(), a, state_a).evaluate(a, state_a, ws_a);
  Dynamics(GetParam(), b, state_b).evaluate(b, state_b, ws_b);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(ws_a.row_a_free[k], ws_b.row_a_free[k], 1e-9 * std::fabs(ws_a.row_a_free[k]) + 1e-10) << k;
    for (std::size_t l = 0; l < 3; ++l) {
      EXPECT_NEAR(ws_a.row_W[3 * k + l], ws_b.row_W[3 * k + l], 1e-9 * ws_a.row_W[3 * k + k]) << k << l;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(In, Cylinders, ::testing::Values(Formulation::recursive, Formulation::lagrange),
                         [](const auto& tested) { return testing::name_of(tested.param); });

}  // namespace cylinder_test
}  // namespace slew::multibody
