// SPDX-License-Identifier: Apache-2.0
// Relief valves whose setting follows a control signal, against their closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "hydraulics/components/direct_relief_valve.h"
#include "hydraulics/components/relief_valve.h"
#include "hydraulics/components/sources.h"
#include "tests/properties/hydraulics/crane_circuit.h"
#include "tests/support/circuit_rig.h"

namespace slew::hydraulics::test {
namespace proportional_relief_test {

constexpr double kMinimum = 10 * kBar, kSetting = 200 * kBar, kRise = 7 * kBar, kFullSignal = 800;
constexpr double kFlow = 30 * kLitrePerMinute, kNominalFlow = 60 * kLitrePerMinute;

// 30 l/min into a line of 0.1 l that the valve relieves to a tank of 1 bar.
class Rig : public CircuitRig {
 public:
  Rig() {
    def.orifice_transition = 10, def.start = StartState::table13;
    add_tank(def, "Tank", 1 * kBar), add_volume(def, "Line", 11 * kBar).rigid_volume = 1e-4;
    FlowSourceDef& source = add<FlowSourceDef>(def, "Source");
    source.port_1 = "Tank", source.port_2 = "Line", source.flow = kFlow;
  }
  double above_tank() { return variable("Line.pressure") - 1 * kBar; }
};

class Pilot : public Rig {
 public:
  Pilot() {
    ReliefValveDef& valve = add<ReliefValveDef>(def, "Valve");
    valve.port_1 = "Line", valve.port_2 = "Tank", valve.nominal_flow = kNominalFlow, valve.setting_pressure = kSetting;
    valve.opening_pressure_rise = kRise, valve.is_proportional = true;
    valve.solenoid = {.minimum_pressure = kMinimum, .maximum_control_signal = kFullSignal, .solenoid_response = 0.06};
  }
};

class Poppet : public Rig {
 public:
  Poppet() {
    def.oil_density = 850;
    DirectReliefValveDef& valve = add<DirectReliefValveDef>(def, "Valve");
    valve.port_1 = "Line", valve.port_2 = "Tank", valve.seat_diameter = 0.01, valve.crack_pressure = kSetting;
    valve.spring_constant = 4e4, valve.flow_force = FlowForce::included, valve.is_proportional = true;
    valve.solenoid = {.minimum_pressure = kMinimum, .maximum_control_signal = kFullSignal};
  }
};

// Root of an increasing function of a pressure.
template <typename Function>
double root_of(Function&& f) {
  double low = 0, high = 1000 * kBar;
  for (int k = 0; k < 200; ++k) {
    const double p = 0.5 * (low + high);
    (f(p) < 0 ? low : high) = p;
  }
  return low;
}

double opens_at(double signal) {
  return kMinimum + std::fmin(std::fmax(signal / kFullSignal, 0), 1) * (kSetting - kMinimum);
}

constexpr double kSignals[] = {-500, 0, 100, 400, 800, 2000};

TEST(ProportionalRelief, holds_the_line_of_a_pilot_operated_valve_at_its_signal) {
  for (const double signal : kSignals) {
    Pilot rig;
    rig.set_signal("Valve", signal);
    rig.run(2);
    EXPECT_NEAR(rig.variable("Valve.set_pressure"), opens_at(signal), 1) << signal;
    const double p = root_of([signal](double p) {
      return (p - opens_at(signal)) / kRise * kNominalFlow * std::sqrt(p / (10 * kBar)) - kFlow;
    });
    EXPECT_NEAR(rig.above_tank(), p, 0.02 * kRise) << signal;
    EXPECT_NEAR(rig.variable("Valve.flow"), kFlow, 1e-4 * kFlow) << signal;
  }
}

TEST(ProportionalRelief, holds_the_line_of_a_poppet_at_its_signal) {
  const double A = std::numbers::pi / 4 * 1e-4, w = std::numbers::pi * 0.01 * std::sqrt(0.5), Cd = 0.62;
  for (const double signal : kSignals) {
    Poppet rig;
    rig.set_signal("Valve", signal);
    rig.run(2);
    const double p = root_of([&](double p) {
      const double y = (p - opens_at(signal)) * A / (4e4 + 2 * Cd * w * p * std::sqrt(0.5));
      return Cd * w * y * std::sqrt(2 * p / 850) - kFlow;
    });
    EXPECT_NEAR(rig.above_tank(), p, 1e-4 * p) << signal;
    EXPECT_NEAR(rig.variable("Valve.flow"), kFlow, 1e-4 * kFlow) << signal;
  }
}

TEST(ProportionalRelief, follows_a_step_of_its_signal_with_the_lag_of_the_solenoid) {
  for (const double t : {0.01, 0.02, 0.06, 0.1}) {
    Pilot step;
    step.set_signal("Valve", 400);
    step.run(t);
    const double e = 0.5 * (1 - std::exp(-t / 0.02));
    EXPECT_NEAR(step.variable("Valve.set_pressure"), kMinimum + e * (kSetting - kMinimum), 0.02 * kBar) << t;
  }
}

// at no signal and at one that is not a number the line is at the minimum
TEST(ProportionalRelief, without_a_number_has_no_force) {
  Pilot rig;
  rig.set_signal("Valve", 800);
  rig.run(1);
  EXPECT_GT(rig.above_tank(), kSetting);
  rig.set_signal("Valve", std::numeric_limits<double>::quiet_NaN());
  rig.run(1);
  EXPECT_NEAR(rig.variable("Valve.set_pressure"), kMinimum, 1);
}

TEST(ProportionalRelief, takes_live_limits_of_its_setting) {
  Pilot rig;
  rig.set_signal("Valve", 400);
  rig.set("Valve.setting_pressure", 100 * kBar);
  rig.set("Valve.minimum_pressure", 20 * kBar);
  rig.run(1);
  EXPECT_NEAR(rig.variable("Valve.set_pressure"), 60 * kBar, 1);
}

TEST(ProportionalRelief, of_a_valve_with_one_setting_has_no_signal) {
  Pilot rig;
  static_cast<ReliefValveDef&>(*rig.def.components.back()).is_proportional = false;
  Circuit plain(rig.def), proportional(Pilot().def);
  EXPECT_LT(plain.find_control("Valve"), 0);
  EXPECT_EQ(plain.state_count() + 1, proportional.state_count());
  EXPECT_EQ(plain.variables().size() + 1, proportional.variables().size());
  EXPECT_FALSE(rig.def.components.back()->takes_signal());
  EXPECT_TRUE(Pilot().def.components.back()->takes_signal());
}

TEST(ProportionalRelief, of_a_minimum_above_the_setting_is_refused) {
  for (const bool is_poppet : {false, true}) {
    Pilot pilot;
    Poppet poppet;
    static_cast<ReliefValveDef&>(*pilot.def.components.back()).solenoid.minimum_pressure = kSetting;
    static_cast<DirectReliefValveDef&>(*poppet.def.components.back()).solenoid.minimum_pressure = kSetting;
    Problems errors, warnings;
    validate(is_poppet ? poppet.def : pilot.def, errors, warnings);
    ASSERT_EQ(errors.size(), 1U);
    EXPECT_EQ(errors[0].path, "Valve.minimum_pressure");
    EXPECT_EQ(errors[0].expected, is_poppet ? "less than crack_pressure" : "less than setting_pressure");
  }
}

}  // namespace proportional_relief_test
}  // namespace slew::hydraulics::test
