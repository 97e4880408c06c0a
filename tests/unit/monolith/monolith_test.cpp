#include "monolith/monolith.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "build_paths.h"
#include "hydraulics_node/hydraulics_subsystem.h"
#include "mechanics_node/mechanics_subsystem.h"

namespace slew::monolith {
namespace {

const std::string kScenes = std::string(SLEWRING_SOURCE_DIR) + "/scenes/";

double mechanical_energy(Monolith& monolith) {
  return monolith.variable("mechanics.kinetic_energy") + monolith.variable("mechanics.potential_energy");
}

void expect_same_start(const std::string& file, const scene::Overrides& overrides) {
  const scene::Scene scene = scene::load_file(kScenes + file, overrides);
  mechanics::MechanicsSubsystem mechanics(scene);
  hydraulic_node::HydraulicsSubsystem hydraulics(scene);
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

TEST(Monolith, GivesVariablesByName) {
  const scene::Scene scene = scene::load_file(kScenes + "truck_crane.yaml");
  Monolith monolith(scene);
  ASSERT_TRUE(monolith.start().is_ok());
  EXPECT_NEAR(monolith.variable("Vol_LiftCyl_B.pressure"), 5e5, 1);
  EXPECT_NEAR(monolith.variable("Pillar_LiftBoom.position"), 15 * std::numbers::pi / 180, 1e-9);
  EXPECT_NEAR(monolith.variable("Cyl_Lift.line_force"), monolith.ports()[1].line_force, 1e-9);
  EXPECT_TRUE(std::isnan(monolith.variable("Vol_LiftCyl_C.pressure")));
}

}  // namespace
}  // namespace slew::monolith
