// SPDX-License-Identifier: Apache-2.0
#include "monolith/monolith.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "build_paths.h"
#include "hydraulics_node/hydraulics_subsystem.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "monolith/mechanics_reference.h"
#include "multibody/results/observe.h"
#include "scene/ports.h"

namespace slew::monolith {
namespace monolith_test {

const std::string kScenes = std::string(SLEWRING_SOURCE_DIR) + "/scenes/";

double mechanical_energy(Monolith& monolith) {
  return monolith.variable("mechanics.kinetic_energy") + monolith.variable("mechanics.potential_energy");
}

void expect_same_start(const std::string& file, const scene::Overrides& overrides) {
  const scene::Scene scene = scene::load_file(kScenes + file, overrides);
  mechanics_node::MechanicsSubsystem mechanics(scene);
  hydraulics_node::HydraulicsSubsystem hydraulics(scene);
  coupling::OwnSample first, start;
  ASSERT_TRUE(mechanics.first_sample(first));
  coupling::PartnerSamples partners;
  partners.mechanism = &first.mechanism;
  ASSERT_TRUE(hydraulics.start(partners, start).is_ok());
  Monolith monolith(scene);
  ASSERT_TRUE(monolith.start().is_ok());
  ASSERT_EQ(monolith.ports().size(), first.mechanism.x.size());
  for (std::size_t i = 0; i < monolith.ports().size(); ++i) {
    EXPECT_EQ(monolith.ports()[i].x, first.mechanism.x[i]);
    EXPECT_EQ(monolith.ports()[i].v, first.mechanism.v[i]);
    EXPECT_NEAR(monolith.ports()[i].F, start.actuators.F[i], 1e-8 * (1e3 + std::fabs(start.actuators.F[i])));
  }
}

TEST(Monolith, StartsWhereTheSubsystemsStart) {
  expect_same_start("truck_crane.yaml", {});
  expect_same_start("truck_crane.yaml", {"hydraulics.start=table13"});
  expect_same_start("single_cylinder.yaml", {});
}

double mechanics_variable(const mechanics_node::MechanicsSubsystem& mechanics, std::string_view name) {
  std::vector<double> values(mechanics.variables().size());
  mechanics.read_variables(values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (mechanics.variables()[i].name == name) return values[i];
  }
  ADD_FAILURE() << "no variable " << name;
  return 0;
}

TEST(Monolith, ShowsTheMechanismAsTheSubsystemDoes) {
  const scene::Scene scene = scene::load_file(kScenes + "truck_crane.yaml");
  mechanics_node::MechanicsSubsystem mechanics(scene);
  coupling::OwnSample first;
  ASSERT_TRUE(mechanics.first_sample(first));
  Monolith monolith(scene);
  ASSERT_TRUE(monolith.start().is_ok());
  const std::vector<ElementVariable> names = multibody::variables(mechanics.model());
  for (const ElementVariable& variable : names) {
    // forces wait for the partner's first sample
    if (variable.dimension == Dimension::force || variable.dimension == Dimension::torque) continue;
    const double value = monolith.variable(variable.name);
    EXPECT_NEAR(mechanics_variable(mechanics, variable.name), value, 1e-14 * (1 + std::fabs(value))) << variable.name;
  }
  EXPECT_NEAR(mechanics_variable(mechanics, "ForceR_FrictionZ.angle"), -10 * std::numbers::pi / 180, 1e-9);
}

TEST(MechanicsSubsystem, StaticForcePerKilogramFollowsLiveChanges) {
  const scene::Scene scene = scene::load_file(kScenes + "truck_crane.yaml");
  mechanics_node::MechanicsSubsystem mechanics(scene);
  hydraulics_node::HydraulicsSubsystem hydraulics(scene);
  coupling::OwnSample sample, start;
  ASSERT_TRUE(mechanics.first_sample(sample));
  ASSERT_TRUE(hydraulics.start({&sample.mechanism, nullptr}, start).is_ok());
  ASSERT_TRUE(mechanics.start({nullptr, &start.actuators}, sample).is_ok());
  const auto per_kilogram = [&] { return mechanics_variable(mechanics, "Cyl_Lift.static_force_per_kg"); };
  const double before = per_kilogram();
  // lever of the bag over that of the cylinder, times 9.81 m/s2
  EXPECT_NEAR(before, (627e3 - 251e3) / 1000, 0.02 * before);
  ASSERT_TRUE(mechanics.change_parameter(0, {"mechanics.gravity.y", -0.5 * 9.81, {}}));
  mechanics.step(0, {nullptr, &start.actuators}, {}, sample);
  EXPECT_NEAR(per_kilogram(), 0.5 * before, 1e-3 * before);
  mechanics.reset();
  ASSERT_TRUE(mechanics.first_sample(sample));
  EXPECT_EQ(per_kilogram(), before);
}

TEST(Monolith, AndTheSubsystemShowTheDampersOfASwingingBag) {
  // a bag on a ball joint, thrown: nothing but dampers, of which a step needs neither angle nor rate
  const scene::Scene scene = scene::load_text(R"(
bodies:
  Bag: {position: [0, 2 m, 0], mass: 500 kg, center_of_mass: [0, -0.6 m, 0], inertia: [100, 100, 100]}
joints:
  Hook: {type: spherical, body1: Ground, point1: [0, 2 m, 0], body2: Bag,
         initial_angular_velocity: [0.3 rad/s, 0.1 rad/s, -0.2 rad/s]}
forces:
  Damper: {type: rotational, body1: Ground, body2: Bag, damping_constant: 50 Nms/rad}
)",
                                              "bag");
  mechanics_node::MechanicsSubsystem mechanics(scene);
  coupling::OwnSample sample;
  ASSERT_TRUE(mechanics.first_sample(sample));
  ASSERT_TRUE(mechanics.start({}, sample).is_ok());
  Monolith monolith(scene);
  ASSERT_TRUE(monolith.start().is_ok());
  for (int n = 0; n < 500; ++n) mechanics.step(n, {}, {}, sample);
  ASSERT_TRUE(monolith.advance_to({500'000'000}, std::vector<double>{}).is_ok());
  for (const char* name : {"Damper.angle", "Damper.rate", "Damper.torque"}) {
    const double value = monolith.variable(name);
    EXPECT_GT(std::fabs(value), 1e-3) << name;
    EXPECT_NEAR(mechanics_variable(mechanics, name), value, 1e-6 * std::fabs(value)) << name;
  }
}

TEST(Monolith, RestartsOnlyWhereAControlOrItsSlopeChanges) {
  const scene::Scene scene = scene::load_file(kScenes + "single_cylinder.yaml");
  Monolith monolith(scene);
  ASSERT_TRUE(monolith.start().is_ok());
  const std::vector<double> off = {0}, half = {250}, full = {500};
  const auto restarts = [&] { return monolith.statistics().restarts; };
  ASSERT_TRUE(monolith.advance_to({10'000'000}, off).is_ok());
  const std::int64_t after_first = restarts();
  ASSERT_TRUE(monolith.advance_to({20'000'000}, off).is_ok());
  EXPECT_EQ(restarts(), after_first);
  // a ramp in two pieces has one kink at its start, and one where it ends
  ASSERT_TRUE(monolith.advance_to({30'000'000}, off, half).is_ok());
  EXPECT_EQ(restarts(), after_first + 1);
  ASSERT_TRUE(monolith.advance_to({40'000'000}, half, full).is_ok());
  EXPECT_EQ(restarts(), after_first + 1);
  ASSERT_TRUE(monolith.advance_to({50'000'000}, full).is_ok());
  EXPECT_EQ(restarts(), after_first + 2);
}

TEST(Monolith, RampIsTheLimitOfFineSteps) {
  const scene::Scene scene = scene::load_file(kScenes + "single_cylinder.yaml");
  Monolith ramp(scene), steps(scene);
  ASSERT_TRUE(ramp.start().is_ok());
  ASSERT_TRUE(steps.start().is_ok());
  ASSERT_TRUE(ramp.advance_to({200'000'000}, std::vector<double>{0}, std::vector<double>{500}).is_ok());
  for (int k = 0; k < 400; ++k) {
    const std::vector<double> middle = {500 * (k + 0.5) / 400};
    ASSERT_TRUE(steps.advance_to({(k + 1) * 500'000}, middle).is_ok());
  }
  EXPECT_NEAR(ramp.ports()[0].F, steps.ports()[0].F, 5);
  EXPECT_NEAR(ramp.ports()[0].x, steps.ports()[0].x, 1e-7);
}

TEST(Monolith, PortWorkIsTheGainOfMechanicalEnergy) {
  // without friction the pressure force is the line force
  const scene::Scene scene = scene::load_file(kScenes + "single_cylinder.yaml");
  Monolith monolith(scene);
  ASSERT_TRUE(monolith.start().is_ok());
  const double before = mechanical_energy(monolith);
  ASSERT_TRUE(monolith.advance_to({1'000'000'000}, std::vector<double>{500}).is_ok());
  const double gain = mechanical_energy(monolith) - before;
  EXPECT_GT(gain, 500);
  EXPECT_NEAR(monolith.ports()[0].work, gain, 1e-7 * gain);
}

TEST(Monolith, SceneWithoutHydraulicsKeepsItsEnergy) {
  const scene::Scene scene = scene::load_file(kScenes + "first_steps.yaml", {"Hinge.viscous_friction=0"});
  Monolith monolith(scene);
  ASSERT_TRUE(monolith.start().is_ok());
  const double before = mechanical_energy(monolith);
  double kinetic = 0;
  for (int k = 1; k <= 20; ++k) {
    ASSERT_TRUE(monolith.advance_to({k * 100'000'000}, std::vector<double>{}).is_ok());
    kinetic = std::max(kinetic, monolith.variable("mechanics.kinetic_energy"));
    EXPECT_NEAR(mechanical_energy(monolith), before, 1e-6 * kinetic);
  }
  EXPECT_GT(kinetic, 0);
}

TEST(Monolith, ParameterJumpTakesEffect) {
  const scene::Scene scene = scene::load_file(kScenes + "single_cylinder.yaml");
  Monolith monolith(scene);
  ASSERT_TRUE(monolith.start().is_ok());
  ASSERT_TRUE(monolith.advance_to({10'000'000}, std::vector<double>{0}).is_ok());
  const double x = monolith.ports()[0].x;
  ASSERT_TRUE(monolith.set_parameter("Load.mass", 3000).is_ok());
  ASSERT_TRUE(monolith.advance_to({60'000'000}, std::vector<double>{0}).is_ok());
  EXPECT_LT(monolith.ports()[0].x, x - 1e-4);
}

TEST(Monolith, RefusesAParameterThatItDoesNotHave) {
  const scene::Scene scene = scene::load_file(kScenes + "single_cylinder.yaml");
  Monolith monolith(scene);
  EXPECT_EQ(monolith.set_parameter("Load.masss", 1).code, ExitCode::bad_input);
  EXPECT_EQ(monolith.set_parameter("L90Lift.overlap", 7).code, ExitCode::bad_input);
  EXPECT_TRUE(monolith.set_parameter("L90Lift.overlap", 0.3).is_ok());
}

TEST(Monolith, NamesTheTimeWhereItCouldNotGoOn) {
  const scene::Scene scene = scene::load_file(kScenes + "single_cylinder.yaml");
  Monolith monolith(scene);
  ASSERT_TRUE(monolith.start().is_ok());
  ASSERT_TRUE(monolith.advance_to({500'000'000}, std::vector<double>{0}).is_ok());
  const std::vector<double> nothing = {std::numeric_limits<double>::quiet_NaN()};
  const Status status = monolith.advance_to({600'000'000}, nothing);
  EXPECT_EQ(status.code, ExitCode::diverged);
  EXPECT_NE(status.text.find("0.500000 s"), std::string::npos) << status.text;
}

// q of the mechanism after half a second, of all three computations
void expect_same_motion(const scene::Scene& scene, double tolerance) {
  Monolith monolith(scene, {1e-10, 1e-10});
  ASSERT_TRUE(monolith.start().is_ok());
  // steps like those of a session
  for (int n = 1; n <= 500; ++n) {
    const Status status = monolith.advance_to({n * 1'000'000}, std::vector<double>(scene.inputs.size()));
    ASSERT_TRUE(status.is_ok()) << status.text;
  }
  const std::vector<double>& q = monolith.equations().mechanism_state().q;
  const std::vector<double> times = {0.5};
  for (const ReferenceEquations equations :
       {ReferenceEquations::joint_coordinates, ReferenceEquations::body_coordinates}) {
    MechanicsReference reference;
    const Status status = integrate_mechanics(scene.mechanics, times, {equations, 1e-10, 1e-11}, reference);
    ASSERT_TRUE(status.is_ok()) << status.text;
    const std::vector<double>& expected = reference.states.front().q;
    ASSERT_EQ(q.size(), expected.size());
    for (std::size_t i = 0; i < q.size(); ++i) EXPECT_NEAR(q[i], expected[i], tolerance) << i;
  }
}

TEST(Monolith, ClosesLoopsAsTheReferencesOfTheMechanicsDo) {
  expect_same_motion(scene::load_file(kScenes + "four_bar.yaml"), 1e-7);
}

TEST(Monolith, CarriesTheBristlesOfJointFriction) {
  // a rod that sinks into the bristles of its hinge, and a slider that comes to rest in those of its rail
  const scene::Scene scene = scene::load_text(R"(
bodies:
  Rod: {mass: 2 kg, center_of_mass: [0.5 m, 0, 0], inertia: [0.1, 0.167, 0.167]}
  Slider: {position: [2 m, 0, 0], mass: 3 kg, inertia: [0.1, 0.1, 0.1]}
joints:
  Hinge: {type: revolute, body1: Ground, body2: Rod, coulomb_friction: 40 Nm, friction_speed: 0.01 rad/s,
          bristle_stiffness: 1e4 Nm/rad, bristle_damping: 400 Nms/rad}
  Rail: {type: prismatic, body1: Ground, point1: [2 m, 0, 0], body2: Slider, initial_velocity: 0.5 m/s,
         coulomb_friction: 8 N, friction_speed: 0.01 m/s, bristle_stiffness: 1e4 N/m, bristle_damping: 20 Ns/m}
)",
                                              "bristles");
  ASSERT_FALSE(
      multibody::start_state(multibody::build_model(scene.mechanics, scene::row_names(scene))).bristles.empty());
  expect_same_motion(scene, 1e-7);
  Monolith monolith(scene);
  ASSERT_TRUE(monolith.start().is_ok());
  ASSERT_TRUE(monolith.advance_to({1'000'000'000}, std::vector<double>{}).is_ok());
  // z' = v (1 - z/g), g = 40 / 1e4 rad, without turning back: x = -g ln(1 - z/g) at z = 9.81 / 1e4 rad
  EXPECT_NEAR(monolith.variable("Hinge.position"), 4e-3 * std::log(1 - 9.81 / 40), 2e-6);
}

TEST(Monolith, GivesVariablesByName) {
  const scene::Scene scene = scene::load_file(kScenes + "truck_crane.yaml");
  Monolith monolith(scene);
  ASSERT_TRUE(monolith.start().is_ok());
  EXPECT_NEAR(monolith.variable("Vol_LiftCyl_B.pressure"), 5e5, 1);
  EXPECT_NEAR(monolith.variable("Pillar_LiftBoom.position"), 15 * std::numbers::pi / 180, 1e-9);
  EXPECT_NEAR(monolith.variable("Cyl_Lift.line_force"), monolith.ports()[1].line_force, 1e-9);
  EXPECT_TRUE(std::isnan(monolith.variable("Vol_LiftCyl_C.pressure")));
}

// From rest to rest between two of the solver's own steps. Right: I q'' = -m l (g sin q + p'' cos q), integrated in the
// pieces of p'' by a method of order 8.
TEST(Monolith, SeesARampThatIsOverWithinAStep) {
  const scene::Scene scene =
      scene::load_file(std::string(SLEWRING_SOURCE_DIR) + "/tests/unit/monolith/cart_on_a_ramp.yaml", {});
  Monolith monolith(scene);
  ASSERT_TRUE(monolith.start().is_ok());
  for (int k = 1; k <= 120; ++k) ASSERT_TRUE(monolith.advance_to(SimTime{k * 1'000'000}, {}).is_ok());
  EXPECT_NEAR(monolith.variable("Pin.position"), -0.34925, 1e-4);
  EXPECT_NEAR(monolith.variable("Pin.velocity"), -8.4935, 1e-3);
}

// p'' jumps at the end of the table, on a step and within one. Right: I q'' = -m l p'' cos q over the table alone.
TEST(Monolith, RestartsWhereAPrescribedAccelerationJumps) {
  const std::string path = std::string(SLEWRING_SOURCE_DIR) + "/tests/unit/monolith/cart_on_a_table.yaml";
  for (const auto& [end, speed] : {std::pair(0.1, -0.0476820), {0.1005, -0.0474448}}) {
    scene::Scene scene = scene::load_file(path, {});
    scene.mechanics.motions[0].points[1][0] = end;
    Monolith monolith(scene);
    ASSERT_TRUE(monolith.start().is_ok());
    for (int k = 1; k <= 300; ++k) ASSERT_TRUE(monolith.advance_to(SimTime{k * 1'000'000}, {}).is_ok()) << k;
    EXPECT_NEAR(monolith.variable("Pin.velocity"), speed, 1e-6) << end;
  }
}

}  // namespace monolith_test
}  // namespace slew::monolith
