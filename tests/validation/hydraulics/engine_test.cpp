// SPDX-License-Identifier: Apache-2.0
// Engine with governor against closed forms: droop, run-up and stall, run-down, and the balance of its energy with its
// pumps.
#include "hydraulics/components/engine.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "hydraulics/components/ls_pump.h"
#include "hydraulics/components/pump.h"
#include "hydraulics/components/sources.h"
#include "tests/properties/hydraulics/crane_circuit.h"
#include "tests/support/circuit_rig.h"

namespace slew::hydraulics::test {
namespace engine_test {

constexpr double kFull = 400, kSpeed = 200, kStall = 60, kInertia = 2;  // Nm, rad/s, kg m2
constexpr double kDisplacement = 10e-6;                                 // m3/rad: 100 Nm at 100 bar

// A pump between tanks loads the engine by a torque that does not depend on the speed.
class Rig : public CircuitRig {
 public:
  explicit Rig(double load) {
    add_tank(def, "Line", 1e5 + load / kDisplacement), add_tank(def, "Tank", 1e5);
    PumpDef& pump = add<PumpDef>(def, "Pump");
    pump.port_a = "Line", pump.port_b = "Tank", pump.displacement = kDisplacement, pump.drive.engine = "Engine";
    EngineDef& of = add<EngineDef>(def, "Engine");
    of.torque_curve = "Full_Load", of.inertia = kInertia, of.speed = kSpeed, of.stall_speed = kStall;
    def.curves.push_back({.name = "Full_Load", .points = {{0, kFull}, {300, kFull}}});
    def.relative_tolerance = 1e-6;
  }
  EngineDef& engine() { return dynamic_cast<EngineDef&>(*def.components.back()); }
  PumpDef& pump() { return dynamic_cast<PumpDef&>(*def.components.front()); }
};

// u = T/T_full, w = w_s (1 + droop (1 - u)); the pump turns with it.
TEST(ValidationEngine, its_speed_droops_with_the_load) {
  for (const double load : {0.0, 100.0, 200.0, 350.0}) {
    Rig rig(load);
    rig.engine().droop = 0.08, rig.pump().drive.speed_ratio = 1;
    rig.run(10);
    const double w = kSpeed * (1 + 0.08 * (1 - load / kFull));
    EXPECT_NEAR(rig.variable("Engine.speed"), w, 1e-4 * w) << load;
    EXPECT_NEAR(rig.variable("Engine.torque"), load, 1e-3 * kFull) << load;
    EXPECT_NEAR(rig.variable("Pump.flow"), kDisplacement * w, 1e-4 * kDisplacement * w) << load;
  }
}

// No pump loads it at the start: speed and fuel stay where they begin. Losses of 21 + 0.11 w of 360 Nm and more, a
// small engine that its losses load to nine tenths, and one without losses.
TEST(ValidationEngine, begins_at_rest_under_its_own_losses) {
  for (const auto& [friction, viscous] : {std::pair{21.0, 0.11}, {300.0, 0.3}, {0.0, 0.0}, {2.0, 0.0}}) {
    Rig rig(0);
    rig.engine().friction_torque = friction, rig.engine().viscous_friction = viscous, rig.engine().droop = 0.07;
    const double w = rig.variable("Engine.speed"), u = rig.variable("Engine.fuel");
    EXPECT_NEAR(rig.variable("Engine.torque"), 0, 1e-9) << friction;
    rig.run(2);
    EXPECT_NEAR(rig.variable("Engine.speed"), w, 1e-9 * w) << friction;
    EXPECT_NEAR(rig.variable("Engine.fuel"), u, 1e-9) << friction;
    EXPECT_NEAR(w, kSpeed * (1 + 0.07 * (1 - u)), 2e-4 * w) << friction;
  }
}

// The engine sees r T; its own losses count too. Pump 100 Nm at 0.9: 1.5 x 100/0.9 + 30 + 0.1 w.
TEST(ValidationEngine, a_gear_multiplies_the_load_and_losses_add_to_it) {
  Rig rig(100);
  rig.pump().drive.speed_ratio = 1.5, rig.pump().mechanical_coefficient = 0.9;
  rig.engine().friction_torque = 30, rig.engine().viscous_friction = 0.1;
  rig.run(10);
  const double w = rig.variable("Engine.speed"), load = 1.5 * 100 / 0.9;
  EXPECT_NEAR(rig.variable("Engine.torque"), load, 0.1);
  EXPECT_NEAR(rig.variable("Engine.fuel"), (load + 30 + 0.1 * w) / kFull, 1e-3);
  EXPECT_NEAR(rig.variable("Pump.flow"), 1.5 * kDisplacement * w, 1e-9);
}

// Beyond its full load: J w' = T_full - T down to where the combustion ends, then J w' = -T; it does not start again.
TEST(ValidationEngine, an_overload_lugs_it_down_until_it_stalls) {
  Rig overload(500);
  overload.engine().fuel_time_constant = 1e-3;
  overload.run(0.5);
  const double w_1 = overload.variable("Engine.speed");
  EXPECT_NEAR(overload.variable("Engine.fuel"), 1, 1e-3);
  overload.run(1);
  EXPECT_NEAR(overload.variable("Engine.speed"), w_1 - 100 / kInertia, 1e-3);
  overload.run(2);
  EXPECT_EQ(overload.variable("Engine.is_stalled"), 1);
  EXPECT_NEAR(overload.variable("Engine.available_torque"), 0, 1e-9);
  overload.set("Pump.swash", 0);
  overload.run(1);
  EXPECT_EQ(overload.variable("Engine.is_stalled"), 1);
}

// A line that stays under pressure does not turn the stalled engine backwards: it creeps at T tau_h/J, T between alpha
// D p eta_m and alpha D p/eta_m, and its shaft gets less than the oil gives.
TEST(ValidationEngine, oil_does_not_turn_it_backwards) {
  Rig rig(200);
  rig.def.curves.front().points = {{0, 100}, {300, 100}};
  rig.pump().mechanical_coefficient = 0.8, rig.pump().volumetric_coefficient = 0.9;
  rig.engine().friction_torque = 10;
  rig.run(6);
  EXPECT_EQ(rig.variable("Engine.is_stalled"), 1);
  const double w = rig.variable("Engine.speed"), T = rig.variable("Pump.torque");
  EXPECT_LT(w, 0);
  EXPECT_GT(w, -1.1 * 1e-3 * 250 / kInertia);
  EXPECT_NEAR(rig.variable("Engine.torque"), T, 1e-6 * T);
  EXPECT_LE(T, 250);
  EXPECT_GE(T, 160);
  EXPECT_LT(-rig.variable("Pump.power"), -rig.variable("Pump.flow") * 200 / kDisplacement);
}

// A signal sets the speed: J w' = T_full w/o load until the governor takes over at w_s.
TEST(ValidationEngine, it_runs_up_at_its_full_load_to_the_speed_that_a_signal_demands) {
  Rig rig(0);
  rig.engine().speed = 100, rig.engine().speed_per_signal = 10, rig.engine().fuel_time_constant = 1e-3;
  rig.run(2);
  rig.set_signal("Engine", 10);
  rig.run(0.1);
  const double w_1 = rig.variable("Engine.speed");
  rig.run(0.2);
  EXPECT_NEAR(rig.variable("Engine.speed"), w_1 + 0.2 * kFull / kInertia, 0.02);
  rig.run(5);
  EXPECT_NEAR(rig.variable("Engine.speed"), 1.05 * 200, 0.02);
  EXPECT_EQ(rig.variable("Engine.speed_setting"), 200);
}

// Without combustion w = (w_0 + T_f/c) exp(-c t/J) - T_f/c, far above the speed at which the friction goes to zero.
TEST(ValidationEngine, it_runs_down_by_its_losses) {
  Rig rig(0);
  rig.engine().friction_torque = 40, rig.engine().viscous_friction = 0.5;
  rig.def.curves.front().points = {{0, 0}, {300, 0}};
  rig.run(1);
  const double start = 1.05 * kSpeed;  // without fuel
  EXPECT_NEAR(rig.variable("Engine.speed"), (start + 80) * std::exp(-0.25) - 80, 0.01);
}

// Work of the engine = work into the oil + growth of the kinetic energy, with two pumps of which one starts to deliver.
TEST(ValidationEngine, its_work_is_in_its_pumps_and_its_flywheel) {
  Rig rig(150);
  PumpDef& second = add<PumpDef>(rig.def, "Second");
  second.port_a = "Line", second.port_b = "Tank", second.displacement = 2 * kDisplacement;
  second.drive = {"Engine", 0.8}, second.swash = 0, second.swash_per_signal = 1;
  std::swap(rig.def.components[1], rig.def.components[2]);  // the engine stays the last for engine()
  rig.run(3);
  const auto kinetic = [&] { return 0.5 * kInertia * std::pow(rig.variable("Engine.speed"), 2); };
  const auto powers = [&] {
    return std::pair{rig.variable("Engine.power"), rig.variable("Pump.flow") * 150 / kDisplacement +
                                                       rig.variable("Second.flow") * 150 / kDisplacement};
  };
  const double before = kinetic();
  rig.set_signal("Second", 0.8);
  double made = 0, delivered = 0;
  auto [engine, pumps] = powers();
  for (int k = 0; k < 2000; ++k) {
    rig.run(1e-3);
    const auto [engine_now, pumps_now] = powers();
    made += 0.5e-3 * (engine + engine_now), delivered += 0.5e-3 * (pumps + pumps_now);
    engine = engine_now, pumps = pumps_now;
  }
  ASSERT_GT(before - kinetic(), 100);
  EXPECT_NEAR(made - delivered, kinetic() - before, 1e-4 * made);
}

TEST(ValidationEngine, rules_of_the_drive_are_checked) {
  Rig rig(0);
  rig.engine().stall_speed = 300;
  rig.def.curves.front().points = {{0, 10}, {300, -10}};
  PumpDef& second = add<PumpDef>(rig.def, "Second");
  second.port_a = "Line", second.port_b = "Tank", second.displacement = kDisplacement, second.drive.engine = "Pump";
  PumpDef& third = add<PumpDef>(rig.def, "Third");
  third.port_a = "Line", third.port_b = "Tank", third.displacement = kDisplacement;
  Problems errors, warnings;
  validate(rig.def, errors, warnings);
  std::vector<std::string> texts;
  for (const Problem& error : errors) texts.push_back(error.path + ": " + error.what);
  EXPECT_EQ(texts,
            (std::vector<std::string>{"Engine.torque_curve: the curve 'Full_Load' has negative torques",
                                      "Engine.stall_speed: the engine would stand at its governed speed",
                                      "Second.engine: 'Pump' is no engine", "Third.speed: nothing drives the pump"}));
}

TEST(ValidationEngine, without_a_pump_it_is_warned_about) {
  HydraulicsDef def;
  EngineDef& engine = add<EngineDef>(def, "Engine");
  engine.torque_curve = "Full_Load", engine.inertia = 1, engine.speed = 200, engine.stall_speed = 60;
  def.curves.push_back({.name = "Full_Load", .points = {{0, 1}, {300, 1}}});
  Problems errors, warnings;
  validate(def, errors, warnings);
  ASSERT_TRUE(errors.empty());
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0].what, "no pump is driven by the engine");
}

// A load of 150 bar takes 450 Nm at full swash of an engine that has 400: without a limiter it stalls; with one of 320
// Nm the torque is that, the swash 320/450, and the speed that of the droop.
TEST(ValidationEngine, a_torque_limiter_keeps_it_from_stalling) {
  constexpr double kLargePump = 30e-6, kLimit = 320;  // m3/rad, Nm
  for (const double limit : {0.0, kLimit}) {
    CircuitRig rig;
    add_tank(rig.def, "Line", 151e5), add_tank(rig.def, "Tank", 1e5);
    LsPumpDef& pump = add<LsPumpDef>(rig.def, "Pump");
    pump.port_a = "Line", pump.port_b = "Tank", pump.displacement = kLargePump, pump.drive.engine = "Engine";
    pump.standby_pressure = 300e5, pump.maximum_torque = limit;
    EngineDef& engine = add<EngineDef>(rig.def, "Engine");
    engine.torque_curve = "Full_Load", engine.inertia = kInertia, engine.speed = kSpeed, engine.stall_speed = kStall;
    engine.droop = 0.08;
    rig.def.curves.push_back({.name = "Full_Load", .points = {{0, kFull}, {300, kFull}}});
    rig.run(20);
    EXPECT_EQ(rig.variable("Engine.is_stalled"), limit > 0 ? 0 : 1);
    if (limit <= 0) continue;
    const double w = kSpeed * (1 + 0.08 * (1 - kLimit / kFull));
    EXPECT_NEAR(rig.variable("Engine.speed"), w, 1e-3 * w);
    EXPECT_NEAR(rig.variable("Pump.torque"), kLimit, 1e-3 * kLimit);
    EXPECT_NEAR(rig.variable("Pump.swash"), kLimit / 450, 1e-3);
  }
}

}  // namespace engine_test
}  // namespace slew::hydraulics::test
