// SPDX-License-Identifier: Apache-2.0
// The static start of flexible bodies in mechanisms with loops: the forces that hold the actuators keep the machine at
// rest, in every formulation; joints that the actuators do not hold leave the bodies undeformed.
#include <string>
#include <vector>

#include "build_paths.h"
#include "math/small_cholesky.h"
#include "scene/scene.h"
#include "scene/unsettled_start.h"
#include "tests/validation/flexible/flexible_def.h"
#include "tests/validation/multibody/cylinder_bodies.h"
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace loop_rest_test {

using namespace testing;

const std::vector<std::string> kActuators = {"ForceR_Pillar", "ForceT_Lift", "ForceT_Jib"};

// the truck crane with a lift boom that bends and its cylinders as bodies; nothing to touch
MechanicsDef crane_with_loops() {
  MechanicsDef def = scene::load_file(SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml").mechanics;
  def.contacts.clear();
  def.shapes.clear();
  flex::BeamDef beam = flex::testing::straight(
      {.shape = flex::SectionShape::hollow_rectangle, .width = 0.4, .height = 0.4, .wall = 12.6e-3},
      flex::testing::steel(5e9), {-2.6, 0, 0}, 14);
  beam.name = "Truck_LiftBoom";
  def.flexible_bodies = {
      {.body = "Truck_LiftBoom", .modes = slew::testing::modes_of(beam, flex::testing::with_modes(10), {1, 2, 3, 4})}};
  for (BodyDef& body : def.bodies) {
    if (body.name == "Truck_LiftBoom") body.type = BodyType::flexible;
  }
  replace_dummies(def, "ForceT_Lift", {0, 0, 1});
  replace_dummies(def, "ForceT_Jib", {0, 0, 1});
  def.held_forces = kActuators;
  return def;
}

// forces of the rows at which none accelerates
std::vector<double> holding_forces(Formulated& mechanism) {
  mechanism.dynamics.evaluate(mechanism.model, mechanism.state, mechanism.ws);
  const std::size_t n = mechanism.model.rows.size();
  std::vector<double> W = mechanism.ws.row_W, F(n);
  for (std::size_t k = 0; k < n; ++k) F[k] = -mechanism.ws.row_a_free[k];
  EXPECT_TRUE(math::factorize_cholesky(W.data(), static_cast<int>(n)));
  math::substitute_forward(W.data(), static_cast<int>(n), F.data());
  math::substitute_backward(W.data(), static_cast<int>(n), F.data());
  return F;
}

class LoopRest : public EveryFormulation {};

TEST_P(LoopRest, TheCraneStaysUnderTheForcesThatHoldItsActuators) {
  Formulated crane = start(crane_with_loops(), kActuators);
  ASSERT_TRUE(crane.model.rests_in_loops);
  const double bend = crane.value("Truck_LiftBoom.deflection.y");
  EXPECT_LT(bend, -1e-3);
  const std::vector<double> forces = holding_forces(crane);
  const BodyPose bag = crane.pose("Bag");
  crane.run(0.1, 1e-4, forces);
  // undeformed, the boom's tip moves by millimetres
  const double size = is(Formulation::penalty) || is(Formulation::augmented) ? 1e-5 : 1e-8;
  EXPECT_NEAR(crane.value("Truck_LiftBoom.deflection.y"), bend, size);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(crane.pose("Bag").position[k], bag.position[k], size);
}

INSTANTIATE_TEST_SUITE_P(Formulations, LoopRest, kEveryFormulation, kFormulationName);

// closed, with the lengths and angles of the undeformed start; the load hangs as it did
TEST(LoopRestStart, HoldsActuatorsAndTheJointsThatNothingMoves) {
  MechanicsDef straight = crane_with_loops();
  straight.flexible_bodies.front().start = {0, 0, 0, 0};
  Mechanism undeformed(straight, kActuators), rested(crane_with_loops(), kActuators);
  EXPECT_FALSE(undeformed.model.rests_in_loops);
  for (Mechanism* crane : {&undeformed, &rested}) evaluate(crane->model, crane->state, crane->ws);
  for (std::size_t k = 0; k < kActuators.size(); ++k) {
    EXPECT_NEAR(rested.ws.row_x[k], undeformed.ws.row_x[k], 1e-10) << kActuators[k];
  }
  for (const RowValue& row : rested.ws.loops.rows) EXPECT_NEAR(row.g, 0, 1e-10);
  const Joint& ball = rested.model.joints[static_cast<std::size_t>(find_joint(rested.model, "Hook_Bag"))];
  const auto q = static_cast<std::size_t>(rested.model.links[static_cast<std::size_t>(ball.link)].q);
  for (std::size_t k = q; k < q + 4; ++k) EXPECT_EQ(rested.model.start_q[k], undeformed.model.start_q[k]);
}

// without actuators the crane falls, whatever its boom does
TEST(LoopRestStart, IsUndeformedWhereNothingHoldsAJoint) {
  MechanicsDef def = crane_with_loops();
  def.held_forces = {"ForceR_Pillar", "ForceT_Lift"};
  const Model model = build_model(def);
  EXPECT_FALSE(model.rests_in_loops);
  for_each_mode(model, [&](std::size_t q, std::size_t) { EXPECT_EQ(model.start_q[q], 0); });
  Problems warnings;
  find_start_deflections(model, warnings);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].what.find("starts undeformed"), std::string::npos);
}

TEST(LoopRestStart, OfTheFullCraneIsWithoutAWarning) {
  const scene::Scene scene = scene::load_file(SLEWRING_SOURCE_DIR "/scenes/truck_crane_full.yaml");
  EXPECT_TRUE(build_model(scene.mechanics).rests_in_loops);
  Problems warnings;
  scene::find_start_shapes(scene, warnings);
  scene::find_unsettled_start(scene, warnings);
  EXPECT_TRUE(warnings.empty()) << text_of(warnings);
}

}  // namespace loop_rest_test
}  // namespace slew::multibody
