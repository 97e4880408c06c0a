// SPDX-License-Identifier: Apache-2.0
// The truck crane with a lift boom that bends: its cylinders push at nodes of the boom, one from the pillar at a node
// that is not the joint's, one from another such node at the body that the tip carries. Their masses on the line of
// force against tubes and rods as bodies of their own, which loops hold there.
#include "build_paths.h"
#include "scene/scene.h"
#include "tests/validation/flexible/flexible_def.h"
#include "tests/validation/multibody/cylinder_bodies.h"
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace dummies_test {

using namespace testing;

// nothing to touch, and without rows no friction and no limits
MechanicsDef bending_crane() {
  MechanicsDef def = scene::load_file(SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml").mechanics;
  def.contacts.clear();
  def.shapes.clear();
  def.rotational_forces.clear();
  flex::BeamDef beam = flex::testing::straight(
      {.shape = flex::SectionShape::hollow_rectangle, .width = 0.4, .height = 0.4, .wall = 12.6e-3},
      flex::testing::steel(5e9), {-2.6, 0, 0}, 14);
  beam.name = "Truck_LiftBoom";
  def.flexible_bodies = {{.body = "Truck_LiftBoom",
                          .modes = slew::testing::modes_of(beam, flex::testing::with_modes(10), {1, 2, 3, 4}),
                          .start = {0, 0, 0, 0}}};
  for (BodyDef& body : def.bodies) {
    if (body.name == "Truck_LiftBoom") body.type = BodyType::flexible;
  }
  return def;
}

class CylindersAtNodes : public EveryFormulation {};

TEST_P(CylindersAtNodes, AsBodiesMoveAsTheirMassesOnTheLine) {
  MechanicsDef with_bodies = bending_crane();
  replace_dummies(with_bodies, "ForceT_Lift", {0, 0, 1});
  replace_dummies(with_bodies, "ForceT_Jib", {0, 0, 1});
  Formulated dummies = start(bending_crane()), bodies = start(with_bodies);
  EXPECT_EQ(dummies.model.node_dummies.size(), 2u);
  EXPECT_EQ(bodies.model.degrees_of_freedom(), dummies.model.degrees_of_freedom());
  const double size = is(Formulation::penalty) ? 1e-4 : is(Formulation::augmented) ? 1e-5 : 1e-7;
  double bend = 0;
  for (int i = 0; i < 10; ++i) {
    dummies.run(0.03, 1e-4);
    bodies.run(0.03, 1e-4);
    for (const std::string body : {"Truck_Pillar", "Truck_LiftBoom", "Truck_JibBoomAttachment", "Bag"}) {
      const BodyPose a = dummies.pose(body), b = bodies.pose(body);
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(a.position[k], b.position[k], size) << body << " at " << i;
        EXPECT_NEAR(a.velocity[k], b.velocity[k], 30 * size) << body << " at " << i;
      }
    }
    EXPECT_NEAR(dummies.value("Truck_LiftBoom.deflection.y"), bodies.value("Truck_LiftBoom.deflection.y"), size);
    bend = std::max(bend, std::fabs(dummies.value("Truck_LiftBoom.deflection.y")));
  }
  EXPECT_GT(bend, 1e-4);
}

TEST(CylinderMassesAtNodes, KeepTheEnergyOfTheCrane) {
  Mechanism crane(bending_crane());
  const double before = crane.total_energy();
  double drift = 0, kinetic = 0;
  for (int i = 0; i < 100; ++i) {
    crane.run(0.01, 1e-4);
    drift = std::max(drift, std::fabs(crane.total_energy() - before));
    kinetic = std::max(kinetic, energy(crane.model, crane.ws).kinetic);
  }
  RecordProperty("drift", std::to_string(drift / kinetic * 1e9) + "e-9");
  EXPECT_LT(drift, 1e-7 * kinetic);
}

INSTANTIATE_TEST_SUITE_P(Formulations, CylindersAtNodes, kEveryFormulation, kFormulationName);

}  // namespace dummies_test
}  // namespace slew::multibody
