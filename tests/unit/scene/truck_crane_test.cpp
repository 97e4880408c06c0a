// SPDX-License-Identifier: Apache-2.0
// scenes/truck_crane.yaml holds the numbers of its sources in SI.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "build_paths.h"
#include "hydraulics/components/double_acting_cylinder.h"
#include "hydraulics/components/l90ls_valve.h"
#include "hydraulics/components/ls_pump.h"
#include "scene/parameters.h"
#include "scene/scene.h"

namespace slew::scene {
namespace truck_crane_test {

constexpr double kDegree = std::numbers::pi / 180;

class TruckCrane : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { scene_ = new Scene(load_file(SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml")); }
  static void TearDownTestSuite() { delete scene_; }

  template <typename Def>
  static const Def& component(const std::string& name) {
    for (const auto& def : scene_->hydraulics.components) {
      if (def->name == name) return dynamic_cast<const Def&>(*def);
    }
    throw std::runtime_error("no component " + name);
  }
  static const multibody::BodyDef& body(const std::string& name) {
    const auto& bodies = scene_->mechanics.bodies;
    return *std::find_if(bodies.begin(), bodies.end(), [&](const auto& def) { return def.name == name; });
  }

  static Scene* scene_;
};

Scene* TruckCrane::scene_ = nullptr;

TEST_F(TruckCrane, HasTheBodiesOfItsTables) {
  ASSERT_EQ(scene_->mechanics.bodies.size(), 6u);
  const auto& pillar = body("Truck_Pillar");
  EXPECT_EQ(pillar.mass, 412.77395);
  EXPECT_EQ(pillar.products[0], -60.25371);
  EXPECT_EQ(pillar.inertia_about, multibody::InertiaPoint::body_origin);
  EXPECT_DOUBLE_EQ(pillar.orientation[1], 37.5 * kDegree);
  EXPECT_EQ(body("Truck_JibBoom").mass, 127.5618);
  EXPECT_EQ(body("Bag").mass, 500);
}

TEST_F(TruckCrane, HasThreePortsInComponentOrder) {
  ASSERT_EQ(scene_->ports.size(), 3u);
  const PortDef& slew = scene_->ports[0];
  EXPECT_EQ(slew.name, "SlewCyl_CraneSlew");
  EXPECT_EQ(slew.force, "ForceR_Pillar");
  EXPECT_NEAR(slew.offset + slew.ratio * 37.5 * kDegree, 0.594, 5e-4);  // stroke at the start
  const PortDef& lift = scene_->ports[1];
  EXPECT_EQ(lift.name, "Cyl_Lift");
  EXPECT_EQ(lift.force, "ForceT_Lift");
  EXPECT_DOUBLE_EQ(lift.offset, -(0.1 + 1.137));
  EXPECT_EQ(lift.ratio, 1);
  EXPECT_EQ(lift.line_force.stroke_min, 0.7);
  EXPECT_EQ(lift.line_force.stroke_max, 1.05);
  EXPECT_EQ(lift.line_force.stop_stiffness, 5e7);
  EXPECT_EQ(lift.line_force.stop_damping, 5e5);
  EXPECT_EQ(lift.line_force.efficiency, 0.9);
  EXPECT_EQ(lift.line_force.seal_friction, 1000);
  ASSERT_EQ(lift.line_force.friction_curve.size(), 12u);
  EXPECT_EQ(lift.line_force.friction_curve[2][1], 0.9);
  EXPECT_EQ(scene_->ports[2].name, "Cyl_Jib");
}

TEST_F(TruckCrane, TakesAMonotoneCubicAsFrictionCurve) {
  const Scene scene =
      load_file(SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml", {"Spline_CylinderFriction.interpolation=pchip"});
  for (std::size_t port = 0; port < 3; ++port) {
    const Table& lines = scene_->ports[port].line_force.friction_curve;
    const Table& cubic = scene.ports[port].line_force.friction_curve;
    // through the points of the scene, and flat at the curve's minimum
    ASSERT_GT(cubic.size(), lines.size());
    for (const auto& point : lines) EXPECT_NE(std::find(cubic.begin(), cubic.end(), point), cubic.end());
    const auto minimum = std::find(cubic.begin(), cubic.end(), std::array<double, 2>{0.1, 0.2});
    ASSERT_NE(minimum, cubic.end());
    const auto next = minimum + 1;
    EXPECT_LT((*next)[1] - 0.2, 0.2 * ((*next)[0] - 0.1));  // the straight line rises by 1 per m/s
    EXPECT_GT((*next)[1], 0.2);
  }
}

// distance of the two points of a force in the plane of the boom, at the pose of the scene
TEST_F(TruckCrane, ItsCylindersHaveTheStrokesOfTheStaticTable) {
  const double lift = 15 * kDegree, fold = 25 * kDegree;
  // in pillar axes; raising turns about -z
  const auto turned = [](double x, double y, double angle) {
    return std::pair(x * std::cos(angle) - y * std::sin(angle), x * std::sin(angle) + y * std::cos(angle));
  };
  const auto [bx, by] = turned(-0.221712, 0.165, -lift);
  const double lift_length = std::hypot(0.50 + bx + 0.221712, 2.00 + by - 0.22223);
  EXPECT_NEAR(scene_->ports[1].offset + lift_length, 0.832, 5e-4);
  // in lift boom axes
  const auto [ax, ay] = turned(0, -0.35, fold);
  EXPECT_NEAR(scene_->ports[2].offset + std::hypot(-2.60 + ax + 0.70, ay + 0.25), 0.753, 5e-4);
}

TEST_F(TruckCrane, HasTheHydraulicsOfItsTables) {
  const auto& valve = component<hydraulics::L90lsValveDef>("L90Lift");
  EXPECT_EQ(valve.overlap, 0.32);
  EXPECT_EQ(valve.nominal_flow_pa, 70.0 / 60000);
  EXPECT_EQ(valve.nominal_flow_at, 30.0 / 60000);
  EXPECT_EQ(valve.maximum_ls_pressure_a, 180e5);
  EXPECT_NEAR(valve.nominal_flow_pa / std::sqrt(valve.nominal_pressure_drop), 6.236e-7, 1e-10);
  EXPECT_NEAR(valve.leak_flow / valve.leak_pressure, 1.67e-13, 1e-15);
  EXPECT_EQ(component<hydraulics::L90lsValveDef>("L90Slew").nominal_flow_pa, 20.0 / 60000);
  const auto& pump = component<hydraulics::LsPumpDef>("MainPump");
  EXPECT_NEAR(pump.displacement * pump.speed * pump.volumetric_coefficient * 60000, 195.3, 0.1);  // l/min
  EXPECT_EQ(pump.controller_gain, 3.5e-7);
  EXPECT_EQ(component<hydraulics::DoubleActingCylinderDef>("Cyl_Jib").common.piston_diameter, 0.16);
}

TEST_F(TruckCrane, HasTheInputsOfTable22) {
  ASSERT_EQ(scene_->inputs.size(), 3u);
  EXPECT_EQ(scene_->inputs[0].name, "Input_Slew");
  EXPECT_EQ(scene_->inputs[0].scale, -500);
  EXPECT_EQ(scene_->inputs[0].dead_zone, 0.2);
  EXPECT_EQ(scene_->inputs[2].channel, 2);
  EXPECT_EQ(scene_->inputs[1].ramp, 0.5);
}

// a warning would greet every run
TEST_F(TruckCrane, LoadsWithoutAWarning) {
  EXPECT_TRUE(scene_->warnings.empty()) << scene_->warnings.front();
}

// the same text is the same scene, and gives the same bits
TEST_F(TruckCrane, WrittenInTheSceneLanguageExpandsToTheSameText) {
  const Scene written = load_file(SLEWRING_SOURCE_DIR "/scenes/truck_crane_short.yaml");
  const auto sections = [](const std::string& text) { return text.substr(text.find("\nsession:")); };
  EXPECT_EQ(sections(written.expanded_text), sections(scene_->expanded_text));
  EXPECT_EQ(written.warnings.size(), scene_->warnings.size());
}

TEST_F(TruckCrane, RefusesABagThatItsDampersWouldThrow) {
  const ParameterDirectory directory(*scene_);
  const Status status = directory.check("Bag.mass", 1e-3).status;
  EXPECT_EQ(status.code, ExitCode::bad_input);
  for (const char* part : {"Bag.mass", "ForceR_Friction", "rk4", "mechanics.max_substep of at most", "sdirk2"}) {
    EXPECT_NE(status.text.find(part), std::string::npos) << part << " in " << status.text;
  }
  EXPECT_TRUE(directory.check("Bag.mass", 50).status.is_ok());
  EXPECT_FALSE(directory.check("ForceR_FrictionX.damping_constant", 5e9).status.is_ok());
  EXPECT_TRUE(directory.check("ForceR_FrictionX.damping_constant", 5e4).status.is_ok());
}

TEST_F(TruckCrane, TakesALiveChangeOfTheBagsMass) {
  ParameterDirectory directory(*scene_);
  const Assignment assignment = directory.parse_assignment("Bag.mass=1500kg");
  EXPECT_TRUE(assignment.status.is_ok()) << assignment.status.text;
  EXPECT_EQ(assignment.over, milliseconds(1000));
}

}  // namespace truck_crane_test
}  // namespace slew::scene
