// SPDX-License-Identifier: Apache-2.0
// Instruments of whole scenes: inertial measurement units in closed form, and a machine whose physics they do not
// change.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

#include "build_paths.h"
#include "scene/scene.h"
#include "session/direct_session.h"

namespace slew::session {
namespace instruments_test {

using wire::Role;

double value(const DirectSession& session, Role role, const std::string& name) {
  const coupling::Subsystem& part = *session.subsystem(role);
  std::vector<double> values(part.variables().size());
  part.read_variables(values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (part.variables()[i].name == name) return values[i];
  }
  ADD_FAILURE() << name;
  return 0;
}

// A rotor turns about the vertical at w from its motion: f = (-w^2 r, g, 0) at r along its x, rates (0, w, 0). A ball
// falls freely: f = 0. A post stands: f = (0, g, 0). A mast turns as the rotor does, with its z axis upwards:
// f = (-w^2 r, 0, g), rates (0, 0, w).
const char* const kScene = R"(
session: {step: 1 ms}
mechanics: {gravity: [0, -10, 0]}
bodies:
  Rotor: {mass: 2 kg, inertia: [0.1, 0.1, 0.1]}
  Ball: {mass: 2 kg, inertia: [0.1, 0.1, 0.1], position: [0, 50 m, 0]}
  Post: {mass: 2 kg, inertia: [0.1, 0.1, 0.1], position: [0, 1 m, 5 m]}
  Mast: {mass: 2 kg, inertia: [0.1, 0.1, 0.1], position: [9 m, 0, 0], orientation: [0, -90 deg, 0]}
joints:
  Axle: {type: revolute, body2: Rotor, orientation1: [-90 deg, 0, 0],
         orientation2: [-90 deg, 0, 0]}
  Free: {type: floating, body2: Ball, point1: [0, 50 m, 0]}
  Foot: {type: fixed, body2: Post, point1: [0, 1 m, 5 m]}
  Pole: {type: revolute, body2: Mast, point1: [9 m, 0, 0], orientation1: [-90 deg, 0, 0]}
motions:
  Drive: {type: rotation_speed, joint: Axle, speed: 4 rad/s}
  Turn: {type: rotation_speed, joint: Pole, speed: 4 rad/s}
sensors:
  On_Rotor: {type: imu, body: Rotor, point: [0.5 m, 0, 0], acceleration_range: 80 m/s2, rate_range: 35 rad/s}
  On_Ball: {type: imu, body: Ball, point: [0, 0.2 m, 0], acceleration_range: 80 m/s2, rate_range: 35 rad/s}
  On_Post: {type: imu, body: Post, acceleration_range: 80 m/s2, rate_range: 35 rad/s}
  On_Mast: {type: imu, body: Mast, point: [0.5 m, 0, 0], acceleration_range: 80 m/s2, rate_range: 35 rad/s}
  Weak: {type: imu, body: Rotor, point: [0.5 m, 0, 0], acceleration_range: 5 m/s2, rate_range: 1 rad/s, sample_time: 10 ms}
)";

// a scene of the repository with these sensors beside its own
scene::Scene with_sensors(const std::string& file, const std::string& sensors) {
  std::ifstream in(std::string(SLEWRING_SOURCE_DIR "/scenes/") + file);
  std::stringstream read;
  read << in.rdbuf();
  std::string text = read.str();
  const std::string section = "\nsensors:\n";
  if (text.find(section) == std::string::npos) text += section;
  return scene::load_text(text.insert(text.find(section) + section.size(), sensors), file);
}

// A cold start: what a thermometer in the tank shows is the tank's temperature of 250 ms ago (of the steps of 50 ms),
// in steps of 0.5 K and with its offset of 2 K; a second one is at the end of its range.
TEST(Thermometer, shows_the_temperature_of_a_volume_late_and_in_steps) {
  const scene::Scene scene = with_sensors(
      "oil_warm_up.yaml",
      R"(  Probe: {type: temperature, variable: Vol_Tank.temperature, lowest: -20 degC, highest: 120 degC, resolution: 0.5 K,
          offset: 2 K, sample_time: 50 ms, delay: 200 ms}
  Cold: {type: temperature, variable: Vol_Tank.temperature, lowest: -40 degC, highest: 0 degC}
)");
  DirectSession session(scene);
  ASSERT_TRUE(session.start().is_ok());
  std::vector<double> truth = {value(session, Role::hydraulics, "Vol_Tank.temperature")};
  bool has_moved = false;
  for (StepIndex n = 0; n < 2000; ++n) {
    session.step(n, {}, {});
    truth.push_back(value(session, Role::hydraulics, "Vol_Tank.temperature"));
    const StepIndex now = n + 1, sample = now < 20 ? 0 : (now - 20) / 5 * 5;
    const double shown = 0.5 * std::round((truth[static_cast<std::size_t>(sample)] + 2) / 0.5);
    ASSERT_NEAR(value(session, Role::hydraulics, "Probe.value"), shown, 1e-9) << now;
    has_moved = has_moved || shown > 282;
    ASSERT_EQ(value(session, Role::hydraulics, "Cold.value"), 273.15);
  }
  EXPECT_TRUE(has_moved);
}

// the oil of a scene has one temperature unless the scene states more; errors of a thermometer are differences
TEST(Thermometer, needs_the_temperature_of_the_oil) {
  const auto problem = [](const std::string& file, const std::string& keys) {
    try {
      static_cast<void>(
          with_sensors(file, "  Probe: {type: temperature, lowest: 0 degC, highest: 9 degC, " + keys + "}\n"));
    } catch (const scene::LoadError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(problem("single_cylinder.yaml", "variable: Vol_Tank.temperature")
                .find("Probe.variable: the oil has one temperature, which no variable shows; expected "
                      "hydraulics.oil_temperature: by_volume"),
            std::string::npos)
      << problem("single_cylinder.yaml", "variable: Vol_Tank.temperature");
  EXPECT_EQ(problem("oil_warm_up.yaml", "variable: Vol_Tank.temperature, noise: 0.1 K"), "");
  for (const char* key : {"noise", "offset", "drift", "resolution"}) {
    EXPECT_NE(problem("oil_warm_up.yaml", std::string("variable: Vol_Tank.temperature, ") + key + ": 0.1 degC")
                  .find("'0.1 degC' is a temperature; expected a temperature difference"),
              std::string::npos)
        << key;
    // an expression has no such zero
    EXPECT_NE(
        problem("oil_warm_up.yaml", std::string("variable: Vol_Tank.temperature, ") + key + ": \"${2 * 0.1 degC}\"")
            .find(std::string("Probe.") + key + ": 546.5 K is more than the range"),
        std::string::npos)
        << key;
  }
}

TEST(InertialMeasurementUnit, measures_what_a_turning_a_falling_and_a_standing_body_feel) {
  DirectSession session(scene::load_text(kScene, "imu"));
  ASSERT_TRUE(session.start().is_ok());
  for (StepIndex n = 0; n < 500; ++n) session.step(n, {}, {});
  const auto at = [&](const std::string& name) { return value(session, Role::mechanics, name); };
  // the mean of the acceleration over a step lags by half of it: 8 m/s2 turned by w H/2
  EXPECT_NEAR(at("On_Rotor.specific_force.x"), -8, 1e-4);
  EXPECT_NEAR(at("On_Rotor.specific_force.y"), 10, 1e-9);
  EXPECT_NEAR(at("On_Rotor.specific_force.z"), 0, 8 * 4 * 0.6e-3);
  EXPECT_NEAR(at("On_Rotor.rate.y"), 4, 1e-9);
  EXPECT_NEAR(at("On_Rotor.rate.x"), 0, 1e-9);
  for (const char* axis : {"x", "y", "z"}) EXPECT_NEAR(at(std::string("On_Ball.specific_force.") + axis), 0, 1e-9);
  EXPECT_NEAR(at("On_Post.specific_force.y"), 10, 1e-12);
  EXPECT_NEAR(at("On_Post.specific_force.x"), 0, 1e-12);
  EXPECT_NEAR(at("On_Mast.specific_force.x"), -8, 1e-4);
  EXPECT_NEAR(at("On_Mast.specific_force.z"), 10, 1e-9);
  EXPECT_NEAR(at("On_Mast.rate.x"), 0, 1e-9);
  EXPECT_NEAR(at("On_Mast.rate.y"), 0, 1e-9);
  EXPECT_NEAR(at("On_Mast.rate.z"), 4, 1e-9);
  // at its range
  EXPECT_EQ(at("Weak.specific_force.x"), -5);
  EXPECT_EQ(at("Weak.specific_force.y"), 5);
  EXPECT_EQ(at("Weak.rate.y"), 1);
}

TEST(InertialMeasurementUnit, follows_a_change_of_gravity) {
  DirectSession session(scene::load_text(kScene, "imu"));
  ASSERT_TRUE(session.start().is_ok());
  session.step(0, {}, {});
  wire::Command change;
  change.path = "mechanics.gravity.y", change.value = -20;
  session.step(1, std::span(&change, 1), {});
  EXPECT_NEAR(value(session, Role::mechanics, "On_Post.specific_force.y"), 20, 1e-12);
}

// Faults of sensors and their noise leave every state hash as it is, and measured values are near the true ones.
TEST(TipperWithInstruments, computes_the_same_physics_as_without) {
  const std::string file = SLEWRING_SOURCE_DIR "/scenes/tipper_sensors.yaml";
  const scene::Scene with = scene::load_file(file);
  scene::Scene without = scene::load_file(file);
  without.instruments.clear();
  DirectSession one(with), other(without);
  ASSERT_TRUE(one.start().is_ok());
  ASSERT_TRUE(other.start().is_ok());
  ASSERT_GT(one.variables().size(), other.variables().size());
  const std::vector<double> controls(with.inputs.size(), 300);
  double true_pressure = 0;
  for (StepIndex n = 0; n < 400; ++n) {
    if (n == 396) true_pressure = value(one, Role::hydraulics, "Vol_Pump.pressure");
    one.step(n, {}, controls);
    other.step(n, {}, controls);
    for (const Role role : {Role::mechanics, Role::hydraulics}) {
      ASSERT_EQ(one.state_hash(role), other.state_hash(role)) << n;
    }
  }
  EXPECT_NEAR(value(one, Role::mechanics, "Platform_Angle.value"), value(one, Role::mechanics, "Hinge.position"), 0.02);
  // of 4 ms before, with five standard deviations of the noise and half of the resolution
  EXPECT_NEAR(value(one, Role::hydraulics, "Pump_Pressure.value"), true_pressure, 5 * 0.5e5 + 0.05e5);
  EXPECT_NE(value(one, Role::hydraulics, "Pump_Pressure.value"), value(one, Role::hydraulics, "Vol_Pump.pressure"));
}

const char* const kOne = R"(
bodies:
  Arm: {mass: 2 kg, inertia: [0.1, 0.1, 0.1], center_of_mass: [1 m, 0, 0]}
joints:
  Hinge: {type: revolute, body2: Arm}
sensors:
  Sensor: {type: angle, variable: VARIABLE, lowest: 0 deg, highest: 90 deg}
)";

std::string refusal_of(const std::string& variable, const std::string& type = "angle") {
  std::string text(kOne);
  text.replace(text.find("VARIABLE"), 8, variable);
  text.replace(text.find("angle"), 5, type);
  try {
    const scene::Scene scene = scene::load_text(text, "one");
    DirectSession session(scene);
    return "";
  } catch (const std::exception& error) {
    return error.what();
  }
}

TEST(Instruments, of_variables_that_they_cannot_measure_are_refused_by_name) {
  EXPECT_EQ(refusal_of("Hinge.position"), "");
  EXPECT_NE(refusal_of("Hing.position").find("no element 'Hing'"), std::string::npos);
  EXPECT_NE(refusal_of("Hinge.postion").find("did you mean 'Hinge.position'?"), std::string::npos);
  EXPECT_NE(refusal_of("Hinge.velocity").find("is in rad/s, its type measures rad"), std::string::npos);
  EXPECT_NE(refusal_of("Sensor.value").find("is no quantity of the mechanics or the hydraulics"), std::string::npos);
}

}  // namespace instruments_test
}  // namespace slew::session
