// SPDX-License-Identifier: Apache-2.0
// The pump's limits at numbers worked out by hand. D n = 1e-5 x 150 = 1.5e-3 m3/s.
#include "hydraulics/components/pump.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "hydraulics/circuit_integrator.h"
#include "hydraulics/components/ls_pump.h"
#include "tests/properties/hydraulics/crane_circuit.h"
#include "tests/support/circuit_rig.h"

namespace slew::hydraulics::test {
namespace pump_test {

class Rig {
 public:
  explicit Rig(double pressure_bar) {
    add_tank(def_, "Line", pressure_bar * kBar), add_tank(def_, "Tank", 1 * kBar);
    PumpDef& pump = add<PumpDef>(def_, "Pump");
    pump.port_a = "Line", pump.port_b = "Tank", pump.speed = 150, pump.displacement = 1e-5;
    pump.mechanical_coefficient = 0.9, pump.volumetric_coefficient = 0.95, pump.time_constant = 0.05;
  }
  PumpDef& pump() { return dynamic_cast<PumpDef&>(*def_.components.front()); }
  // after `seconds` under a signal
  void run(double signal, double seconds) {
    if (!integrator_) {
      circuit_ = std::make_unique<Circuit>(def_);
      integrator_ = std::make_unique<CircuitIntegrator>(*circuit_, def_);
      integrator_->start({}, {}, {});
    }
    circuit_->set_control(0, signal);
    for (int k = 0; k < std::lround(seconds / 1e-3); ++k) integrator_->step(1e-3, HeldSpeed(0));
  }
  double variable(const std::string& name) {
    std::vector<double> values(circuit_->variables().size());
    circuit_->read_variables(integrator_->state().data(), values);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (circuit_->variables()[i].name == "Pump." + name) return values[i];
    }
    ADD_FAILURE() << name;
    return 0;
  }

 private:
  HydraulicsDef def_;
  std::unique_ptr<Circuit> circuit_;
  std::unique_ptr<CircuitIntegrator> integrator_;
};

TEST(Pump, of_fixed_displacement_delivers_its_flow_less_the_leak) {
  Rig rig(201);
  rig.pump().leak_flow = 1e-5;
  rig.run(0, 1);
  EXPECT_NEAR(rig.variable("flow"), 1.5e-3 * 0.95 - 2e-5, 1e-9);
  EXPECT_NEAR(rig.variable("torque"), 1e-5 * 200e5 / 0.9, 1e-6);
  EXPECT_NEAR(rig.variable("power"), 150 * 1e-5 * 200e5 / 0.9, 1e-3);
}

TEST(Pump, follows_its_signal_with_a_lag) {
  Rig rig(101);
  rig.pump().swash = 0.2, rig.pump().swash_per_signal = 0.1;
  rig.run(0, 0.5);
  EXPECT_NEAR(rig.variable("swash"), 0.2, 1e-6);
  rig.run(6, 0.05);
  EXPECT_NEAR(rig.variable("swash"), 0.8 - 0.6 * std::exp(-1), 1e-4);
  rig.run(20, 1);
  EXPECT_NEAR(rig.variable("swash"), 1, 1e-4);
}

// The error over tau, 0.8/0.05, is far above 2/s until the last 0.1.
TEST(Pump, its_swash_turns_no_faster_than_its_limit) {
  Rig rig(101);
  rig.pump().swash = 0.2, rig.pump().swash_per_signal = 0.1, rig.pump().swash_rate_limit = 2;
  rig.run(8, 0.1);
  EXPECT_NEAR(rig.variable("swash"), 0.4, 1e-4);
  rig.run(8, 0.15);
  EXPECT_NEAR(rig.variable("swash"), 0.7, 1e-4);
  rig.run(8, 0.5);
  EXPECT_NEAR(rig.variable("swash"), 1, 1e-3);
}

TEST(Pump, the_power_limit_is_a_hyperbola) {
  for (const auto& [bar, swash] : {std::pair{50.0, 1.0}, {100.0, 0.9}, {150.0, 0.6}, {300.0, 0.3}}) {
    Rig rig(bar + 1);
    rig.pump().maximum_power = 15e3;  // 0.9 x 15 kW / 1.5e-3 m3/s = 90 bar at full swash
    rig.run(0, 1);
    EXPECT_NEAR(rig.variable("swash"), swash, 1e-4) << bar;
    EXPECT_LE(rig.variable("power"), 15e3 * (1 + 1e-4)) << bar;
  }
}

TEST(Pump, the_cut_off_ends_the_flow_at_its_pressure) {
  for (const auto& [bar, swash] : {std::pair{150.0, 1.0}, {190.0, 0.5}, {195.0, 0.25}, {210.0, 0.0}}) {
    Rig rig(bar + 1);
    rig.pump().maximum_pressure = 200 * kBar, rig.pump().controller_gain = 0.05 / kBar;
    rig.run(0, 1);
    EXPECT_NEAR(rig.variable("swash"), swash, 1e-4) << bar;
  }
}

// Negative control takes the swash back from 10 bar on, to none at 35 bar; positive control is the line the other way.
TEST(Pump, its_control_pressure_sets_the_swash_by_a_straight_line) {
  for (const auto& [bar, negative] : {std::pair{5.0, 1.0}, {15.0, 0.8}, {20.0, 0.6}, {30.0, 0.2}, {40.0, 0.0}}) {
    for (const bool is_negative : {true, false}) {
      CircuitRig rig;
      add_tank(rig.def, "Line", 101 * kBar), add_tank(rig.def, "Tank", 1 * kBar),
          add_tank(rig.def, "Pilot", (bar + 1) * kBar);
      PumpDef& pump = add<PumpDef>(rig.def, "Pump");
      pump.port_a = "Line", pump.port_b = "Tank", pump.speed = 150, pump.displacement = 1e-5, pump.time_constant = 0.05;
      pump.control_port = "Pilot";
      pump.full_swash_pressure = (is_negative ? 10 : 35) * kBar,
      pump.zero_swash_pressure = (is_negative ? 35 : 10) * kBar;
      rig.run(1);
      EXPECT_NEAR(rig.variable("Pump.swash"), is_negative ? negative : 1 - negative, 1e-4) << bar;
    }
  }
}

TEST(Pump, the_lowest_of_command_control_pressure_cut_off_and_power_holds) {
  for (const auto& [command, pilot_bar, power, swash] :
       {std::tuple{0.4, 15.0, 0.0, 0.4}, {1.0, 25.0, 0.0, 0.4}, {1.0, 15.0, 8e3, 8.0 / 15}, {1.0, 25.0, 8e3, 0.4}}) {
    CircuitRig rig;
    add_tank(rig.def, "Line", 101 * kBar), add_tank(rig.def, "Tank", 1 * kBar),
        add_tank(rig.def, "Pilot", (pilot_bar + 1) * kBar);
    PumpDef& pump = add<PumpDef>(rig.def, "Pump");
    pump.port_a = "Line", pump.port_b = "Tank", pump.speed = 150, pump.displacement = 1e-5, pump.swash = command;
    pump.control_port = "Pilot", pump.full_swash_pressure = 10 * kBar, pump.zero_swash_pressure = 35 * kBar;
    pump.maximum_power = power;
    rig.run(2);
    EXPECT_NEAR(rig.variable("Pump.swash"), swash, 1e-4);
  }
}

// A pump whose flow runs through an orifice K into the tank, controlled by the pressure before it:
// K sqrt(p) = Q_1 (p_0 - p)/(p_0 - p_1)
TEST(Pump, in_negative_control_circulates_the_flow_at_which_orifice_and_control_agree) {
  CircuitRig rig;
  rig.def.orifice_transition = 10;
  add_volume(rig.def, "Line").rigid_volume = 1e-3;
  add_tank(rig.def, "Tank", 1 * kBar);
  PumpDef& pump = add<PumpDef>(rig.def, "Pump");
  pump.port_a = "Line", pump.port_b = "Tank", pump.speed = 150, pump.displacement = 1e-5, pump.control_port = "Line";
  pump.full_swash_pressure = 10 * kBar, pump.zero_swash_pressure = 35 * kBar;
  BleedDef& orifice = add<BleedDef>(rig.def, "Orifice");
  orifice.port_1 = "Line", orifice.port_2 = "Tank", orifice.nominal_flow = 4e-4;
  orifice.nominal_pressure_drop = 30 * kBar;
  rig.run(3);
  const double K = 4e-4 / std::sqrt(30 * kBar), slope = 1.5e-3 / (25 * kBar);
  // slope x^2 + K x - slope p_0 = 0 for x = sqrt(p)
  const double x = (-K + std::sqrt(K * K + 4 * slope * slope * 35 * kBar)) / (2 * slope);
  EXPECT_NEAR(rig.variable("Line.pressure") - 1 * kBar, x * x, 1e-4 * x * x);
  EXPECT_NEAR(rig.variable("Pump.flow"), K * x, 1e-4 * K * x);
}

// P eta_m eta_v / p = K sqrt(p) for the rise p
TEST(Pump, at_its_power_limit_settles_where_the_orifice_takes_its_flow) {
  HydraulicsDef def;
  def.orifice_transition = 10;
  add_volume(def, "Line").rigid_volume = 1e-3;
  add_tank(def, "Tank", 1 * kBar);
  PumpDef& pump = add<PumpDef>(def, "Pump");
  pump.port_a = "Line", pump.port_b = "Tank", pump.speed = 150, pump.displacement = 1e-5, pump.maximum_power = 8e3;
  pump.mechanical_coefficient = 0.9, pump.volumetric_coefficient = 0.95;
  BleedDef& orifice = add<BleedDef>(def, "Orifice");
  orifice.port_1 = "Line", orifice.port_2 = "Tank", orifice.nominal_flow = 5e-4;
  orifice.nominal_pressure_drop = 100 * kBar;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start({}, {}, {});
  for (int k = 0; k < 3000; ++k) integrator.step(1e-3, HeldSpeed(0));
  const double K = 5e-4 / std::sqrt(100 * kBar), p = std::pow(8e3 * 0.9 * 0.95 / K, 2.0 / 3);
  EXPECT_NEAR(integrator.state()[0] - 1 * kBar, p, 1e-4 * p);
}

// Over centre everything is mirrored: a pump at -alpha between exchanged pressures is one at alpha.
TEST(Pump, over_centre_is_the_mirror_image_within_both_limits) {
  for (const double command : {0.3, 0.9}) {
    for (const double limit_bar : {0.0, 215.0}) {
      for (const double power : {0.0, 15e3}) {
        CircuitRig rig;
        add_tank(rig.def, "High", 201 * kBar), add_tank(rig.def, "Low", 1 * kBar);
        for (const double side : {1.0, -1.0}) {
          PumpDef& pump = add<PumpDef>(rig.def, side > 0 ? "Forth" : "Back");
          pump.port_a = side > 0 ? "High" : "Low", pump.port_b = side > 0 ? "Low" : "High";
          pump.speed = 150, pump.displacement = 1e-5, pump.mechanical_coefficient = 0.9, pump.leak_flow = 1e-6;
          pump.time_constant = 0.02, pump.minimum_swash = -1, pump.swash = side * command;
          pump.maximum_pressure = limit_bar * kBar, pump.maximum_power = power;
        }
        rig.run(1);
        const double swash = rig.variable("Forth.swash");
        const double cut_off = limit_bar > 0 ? 3.5e-7 * 15e5 : 1, full = power > 0 ? 0.9 * power / (1.5e-3 * 200e5) : 1;
        EXPECT_NEAR(swash, std::min({command, cut_off, full}), 5e-3);
        EXPECT_NEAR(rig.variable("Back.swash"), -swash, 1e-9);
        EXPECT_NEAR(rig.variable("Back.flow"), -rig.variable("Forth.flow"), 1e-12);
        EXPECT_NEAR(rig.variable("Back.torque"), rig.variable("Forth.torque"), 1e-9);
      }
    }
  }
}

// 200 bar at port b drive a pump that turns forwards: no limit acts, and its torque is that of a motor.
TEST(Pump, oil_that_drives_it_gives_its_torque_less_the_losses) {
  CircuitRig rig;
  add_tank(rig.def, "Low", 1 * kBar), add_tank(rig.def, "High", 201 * kBar);
  PumpDef& pump = add<PumpDef>(rig.def, "Pump");
  pump.port_a = "Low", pump.port_b = "High", pump.speed = 150, pump.displacement = 1e-5;
  pump.mechanical_coefficient = 0.9, pump.minimum_swash = -1, pump.swash = 0.8, pump.maximum_pressure = 100 * kBar;
  pump.maximum_power = 1e3;
  rig.run(1);
  EXPECT_NEAR(rig.variable("Pump.swash"), 0.8, 1e-6);
  EXPECT_NEAR(rig.variable("Pump.torque"), -0.8 * 1e-5 * 200e5 * 0.9, 1e-6);
}

// Oil and shaft exchange power with a loss in all four quadrants: alpha and the rise p of either sign. As a pump Q = D
// n alpha eta_v and T = D alpha p / eta_m; driven by its oil Q = D n alpha / eta_v and T = D alpha p eta_m.
TEST(Pump, loses_power_in_every_quadrant) {
  constexpr double kEta_m = 0.96, kEta_v = 0.9, kFlow = 1.5e-3;
  for (const double swash : {0.8, -0.8}) {
    for (const double bar : {-200.0, -20.0, -2.0, -1.9, -0.5, -0.01, 0.0, 0.01, 0.5, 1.9, 2.0, 20.0, 200.0}) {
      CircuitRig rig;
      const double p = bar * kBar;
      add_tank(rig.def, "A", 201 * kBar + std::min(p, 0.0)), add_tank(rig.def, "B", 201 * kBar - std::max(p, 0.0));
      PumpDef& pump = add<PumpDef>(rig.def, "Pump");
      pump.port_a = "A", pump.port_b = "B", pump.speed = 150, pump.displacement = 1e-5, pump.minimum_swash = -1;
      pump.swash = swash, pump.mechanical_coefficient = kEta_m, pump.volumetric_coefficient = kEta_v;
      rig.run(0.01);
      const double flow = rig.variable("Pump.flow"), power = rig.variable("Pump.power"), oil = flow * p;
      EXPECT_GE(power - oil, 0) << swash << " " << bar;
      EXPECT_GE(std::fabs(flow), 0.8 * kFlow * kEta_v * (1 - 1e-12));
      EXPECT_LE(std::fabs(flow), 0.8 * kFlow / kEta_v * (1 + 1e-12));
      if (bar == 0) EXPECT_NEAR(flow, swash * kFlow, 1e-12);
      if (std::fabs(bar) < 2) continue;
      const bool is_driven = swash * bar < 0;
      EXPECT_NEAR(flow, swash * kFlow * (is_driven ? 1 / kEta_v : kEta_v), 1e-12) << swash << " " << bar;
      EXPECT_NEAR(power, swash * kFlow * p * (is_driven ? kEta_m : 1 / kEta_m), 1e-6) << swash << " " << bar;
    }
  }
}

TEST(Pump, leaks_into_its_case_from_both_ports) {
  CircuitRig rig;
  add_tank(rig.def, "High", 201 * kBar), add_tank(rig.def, "Low", 21 * kBar), add_tank(rig.def, "Case", 1 * kBar);
  PumpDef& pump = add<PumpDef>(rig.def, "Pump");
  pump.port_a = "High", pump.port_b = "Low", pump.port_c = "Case", pump.speed = 150, pump.displacement = 1e-5;
  pump.case_leak_flow = 2e-6;
  rig.run(0.01);
  EXPECT_NEAR(rig.variable("Pump.case_flow"), 2e-6 * (200 + 20) / 100, 1e-12);
}

TEST(Pump, a_control_pressure_without_a_range_is_refused) {
  HydraulicsDef def;
  add_tank(def, "A"), add_tank(def, "B");
  PumpDef& pump = add<PumpDef>(def, "Pump");
  pump.port_a = "A", pump.port_b = "B", pump.speed = 150, pump.displacement = 1e-5, pump.control_port = "A";
  pump.full_swash_pressure = pump.zero_swash_pressure = 20 * kBar;
  Problems errors, warnings;
  validate(def, errors, warnings);
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].path, "Pump.zero_swash_pressure");
  pump.zero_swash_pressure = 30 * kBar, errors.clear();
  validate(def, errors, warnings);
  EXPECT_TRUE(errors.empty());
}

TEST(Pump, a_swash_below_its_least_one_is_refused) {
  HydraulicsDef def;
  add_tank(def, "A"), add_tank(def, "B");
  PumpDef& pump = add<PumpDef>(def, "Pump");
  pump.port_a = "A", pump.port_b = "B", pump.speed = 150, pump.displacement = 1e-5, pump.swash = -0.5;
  Problems errors, warnings;
  validate(def, errors, warnings);
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].path, "Pump.swash");
  pump.minimum_swash = -1;
  errors.clear();
  validate(def, errors, warnings);
  EXPECT_TRUE(errors.empty());
}

// A controller that demands the full swash, against a line of constant pressure: alpha = eta_m T/(D p), at most 1.
TEST(LsPump, its_torque_limiter_holds_the_torque_at_every_pressure) {
  for (const double pressure : {20.0, 60.0, 120.0, 250.0}) {
    CircuitRig rig;
    add_tank(rig.def, "Line", (pressure + 1) * kBar), add_tank(rig.def, "Tank", 1 * kBar);
    LsPumpDef& pump = add<LsPumpDef>(rig.def, "Pump");
    pump.port_a = "Line", pump.port_b = "Tank", pump.speed = 150, pump.displacement = 1e-5;
    pump.mechanical_coefficient = 0.9, pump.standby_pressure = 400 * kBar, pump.maximum_torque = 80;
    rig.run(2);
    const double full = 0.9 * 80 / (1e-5 * pressure * kBar);
    EXPECT_NEAR(rig.variable("Pump.swash"), std::min(1.0, full), 2e-3) << pressure;
    EXPECT_LT(rig.variable("Pump.torque"), 80.01);
    rig.set("Pump.maximum_torque", 40);
    rig.run(2);
    EXPECT_NEAR(rig.variable("Pump.swash"), std::min(1.0, 0.5 * full), 2e-3) << pressure;
    rig.set("Pump.maximum_torque", 0);
    rig.run(2);
    EXPECT_NEAR(rig.variable("Pump.swash"), 1, 2e-3) << pressure;
  }
}

// a tank under pressure drives the pump: the published torque is the one that an engine receives
TEST(LsPump, oil_that_drives_it_gives_its_torque_less_the_losses) {
  CircuitRig rig;
  add_tank(rig.def, "Line", 1 * kBar), add_tank(rig.def, "Tank", 21 * kBar);
  LsPumpDef& pump = add<LsPumpDef>(rig.def, "Pump");
  pump.port_a = "Line", pump.port_b = "Tank", pump.speed = 150, pump.displacement = 1e-5;
  pump.mechanical_coefficient = 0.9, pump.volumetric_coefficient = 0.95;
  rig.run(2);
  EXPECT_NEAR(rig.variable("Pump.swash"), 1, 1e-6);
  EXPECT_NEAR(rig.variable("Pump.torque"), -1e-5 * 20e5 * 0.9, 1e-6);
  EXPECT_NEAR(rig.variable("Pump.flow"), 1.5e-3 / 0.95, 1e-10);
}

}  // namespace pump_test
}  // namespace slew::hydraulics::test
