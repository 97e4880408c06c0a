// SPDX-License-Identifier: Apache-2.0
// Requirements of the truck crane's circuit: metering, limits, balances, dissipation, extremes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/allocation_guard.h"
#include "hydraulics/circuit_integrator.h"
#include "tests/properties/hydraulics/bench_circuit.h"
#include "tests/properties/hydraulics/crane_circuit.h"
#include "tests/support/nightly.h"

namespace slew::hydraulics::test {
namespace crane_circuit_test {

constexpr double kStep = 1e-3;

// The crane's circuit with masses on its pistons, started in equilibrium.
class CraneCircuit {
 public:
  explicit CraneCircuit(HydraulicsDef circuit_def = crane_circuit(), MassLoad pistons = crane_load())
      : def(std::move(circuit_def)), circuit(def), integrator(circuit, def), load(std::move(pistons)) {
    std::vector<double> F;
    for (const MassLoad::Load& l : load.loads()) F.push_back(l.force);
    integrator.start(kCraneStrokes, kAtRest, F);
    values.resize(circuit.variables().size());
  }

  StepReport run(double seconds, double H = kStep) {
    StepReport all;
    for (int k = 0; k < static_cast<int>(std::lround(seconds / H)); ++k) {
      const StepReport report = integrator.step(H, load);
      all.flags |= report.flags;
      all.substeps = std::max(all.substeps, report.substeps);
      all.iterations += report.iterations;
    }
    return all;
  }

  void command(const char* valve, double signal) { circuit.set_control(circuit.find_control(valve), signal); }

  double variable(const std::string& name) {
    circuit.read_variables(integrator.state().data(), values);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (circuit.variables()[i].name == name) return values[i];
    }
    ADD_FAILURE() << "no variable " << name;
    return 0;
  }

  HydraulicsDef def;
  Circuit circuit;
  CircuitIntegrator integrator;
  MassLoad load;
  std::vector<double> values;
};

TEST(CraneCircuit, full_command_meters_33_5_litres_per_minute_and_lifts_at_17_8_mm_per_second) {
  CraneCircuit crane;
  crane.command("L90Lift", 500);
  crane.run(2);
  EXPECT_NEAR(crane.variable("L90Lift.flow_pa") / kLitrePerMinute, 70 * std::sqrt(8.0 / 35), 0.05);
  EXPECT_NEAR(crane.variable("Cyl_Lift.speed"), 17.8e-3, 0.1e-3);
}

TEST(CraneCircuit, half_of_the_spool_travel_beyond_the_overlap_meters_half_of_the_flow) {
  CraneCircuit crane;
  crane.command("L90Lift", 500 * (0.32 + 0.5 * 0.68));
  crane.run(2);
  EXPECT_NEAR(crane.variable("L90Lift.flow_pa") / kLitrePerMinute, 35 * std::sqrt(8.0 / 35), 0.05);
}

TEST(CraneCircuit, a_signal_inside_the_overlap_moves_nothing_but_leaks) {
  CraneCircuit crane;
  crane.command("L90Lift", 0.3 * 500);
  crane.run(1);
  EXPECT_LT(std::fabs(crane.variable("Cyl_Lift.speed")), 2e-4);
  EXPECT_EQ(crane.variable("L90Lift.ls_pressure"), 0);
}

TEST(CraneCircuit, metering_flow_does_not_depend_on_the_load_below_the_limit) {
  for (const double force : {100e3, 251e3, 450e3}) {
    MassLoad load = crane_load();
    load.loads()[0].force = force;
    CraneCircuit crane(crane_circuit(), load);
    crane.command("L90Lift", 500);
    crane.run(3);
    EXPECT_NEAR(crane.variable("L90Lift.flow_pa") / kLitrePerMinute, 33.47, 0.1) << force;
  }
}

TEST(CraneCircuit, lifting_stops_at_188_bar) {
  // F = p_A A_A - p_B A_B with p_B near the return pressure: loads that need 185 and 189 bar above tank
  const double A = 0.25 * std::numbers::pi * 0.2 * 0.2, B = A - 0.25 * std::numbers::pi * 0.105 * 0.105;
  for (const auto& [bar, is_lifted] : {std::pair{183.0, true}, std::pair{189.5, false}}) {
    MassLoad load = crane_load();
    load.loads()[0].force = (bar + 1) * kBar * A - 3 * kBar * B;
    load.loads()[0].damping = 1e6;
    CraneCircuit crane(crane_circuit(), load);
    crane.command("L90Lift", 500);
    crane.run(4);
    EXPECT_EQ(crane.variable("Cyl_Lift.speed") > 1e-3, is_lifted) << bar;
  }
}

TEST(CraneCircuit, a_released_load_sinks_by_leaks_only) {
  MassLoad load = crane_load();
  load.loads()[0].damping = 1e7;
  CraneCircuit crane(crane_circuit(), load);
  crane.run(1);
  const double x_0 = crane.variable("Cyl_Lift.stroke"), p_0 = crane.variable("Cyl_Lift.pressure_a");
  crane.run(2);
  const double p_1 = crane.variable("Cyl_Lift.pressure_a");
  const double speed = (crane.variable("Cyl_Lift.stroke") - x_0) / 2;
  // leak A-T of 0.1 l/min per 100 bar, 0.01 l/min per 100 bar across the piston, and the return of the oil column
  const double C = crane.variable("Vol_LiftCyl_A.content") / crane.variable("Vol_LiftCyl_A.effective_bulk_modulus");
  const double leaks =
      (kLeak * (p_1 - kBar) + 0.1 * kLeak * (p_1 - crane.variable("Cyl_Lift.pressure_b"))) / (100 * kBar);
  const double expected = -(leaks + C * (p_1 - p_0) / 2) / (0.25 * std::numbers::pi * 0.04);
  EXPECT_NEAR(speed, expected, 0.01 * std::fabs(expected));
  EXPECT_NEAR(speed, -4e-5, 1e-5);
}

TEST(CraneCircuit, pump_line_rests_at_stand_by_less_the_droop_of_bleed_and_leak) {
  CraneCircuit crane;
  crane.run(2);
  const double flow = crane.variable("MainPump.swash");
  EXPECT_NEAR(crane.variable("Vol_MainPump.pressure"), 26e5 - flow / 3.5e-7, 0.02e5);
  EXPECT_GT(flow, 0.009);
}

TEST(CraneCircuit, full_swash_against_a_closed_line_settles_at_271_4_bar_above_tank) {
  HydraulicsDef def = crane_circuit();
  for (auto& component : def.components) {
    if (component->name == "MainPump") static_cast<LsPumpDef&>(*component).standby_pressure = 400 * kBar;
  }
  CraneCircuit crane(std::move(def));
  const StepReport report = crane.run(2);
  // by hand, in bar above tank and l/min: what pump leak and bleed leave of the pump's flow opens the valve by a fifth
  double p = 270;
  for (int i = 0; i < 20; ++i) {
    const double flow = 0.140 * 1500 * 0.93 - 0.1 * p / 100 - 2 * std::sqrt(p / 25);
    p = 270 + 7 * flow / (180 * std::sqrt(p / 10));
  }
  EXPECT_NEAR(p, 271.41, 0.01);
  // the spools' leaks out of P take up to 2 l/min more
  EXPECT_NEAR(crane.variable("Vol_MainPump.pressure") / kBar, 1 + p, 0.02);
  EXPECT_TRUE(report.has(StepFlag::relief_open));
}

TEST(CraneCircuit, oil_metered_into_the_lift_cylinder_equals_its_change_of_volume) {
  CraneCircuit crane;
  crane.command("L90Lift", 500);
  const int volume = crane.circuit.find_volume("Vol_LiftCyl_A");
  std::vector<double> C(static_cast<std::size_t>(crane.circuit.volume_count()));
  const double A = 0.25 * std::numbers::pi * 0.04, x_0 = crane.integrator.actuators()[0].x;
  double inflow = 0, compressed = 0;
  constexpr double kFine = 1e-4;
  for (int k = 0; k < 10000; ++k) {
    const double Q_0 = crane.integrator.actuators()[0].Q_a, p_0 = crane.integrator.actuators()[0].p_a;
    crane.circuit.capacities(crane.integrator.state().data(), C.data());
    const double C_0 = C[static_cast<std::size_t>(volume)];
    crane.run(kFine, kFine);
    crane.circuit.capacities(crane.integrator.state().data(), C.data());
    inflow += 0.5 * kFine * (Q_0 + crane.integrator.actuators()[0].Q_a);
    compressed += 0.5 * (C_0 + C[static_cast<std::size_t>(volume)]) * (crane.integrator.actuators()[0].p_a - p_0);
  }
  const double moved = A * (crane.integrator.actuators()[0].x - x_0);
  ASSERT_GT(moved, 3e-4);
  EXPECT_NEAR(inflow, moved + compressed, 1e-5 * moved);
}

TEST(CraneCircuit, work_and_impulse_of_a_step_are_the_integrals_of_the_force) {
  CraneCircuit coarse, fine;
  coarse.command("L90Lift", 500), fine.command("L90Lift", 500);
  double work = 0, impulse = 0, fine_work = 0, fine_impulse = 0;
  for (int k = 0; k < 1000; ++k) {
    coarse.run(1e-3);
    work += coarse.integrator.actuators()[0].work;
    impulse += coarse.integrator.actuators()[0].impulse;
    for (int i = 0; i < 20; ++i) {
      fine.run(5e-5, 5e-5);
      fine_work += fine.integrator.actuators()[0].work;
      fine_impulse += fine.integrator.actuators()[0].impulse;
    }
  }
  EXPECT_NEAR(work, fine_work, 2e-4 * std::fabs(fine_work));
  EXPECT_NEAR(impulse, fine_impulse, 1e-5 * fine_impulse);
  // the mass receives the same impulse: m v = int F dt - load - damping
  const double x = fine.integrator.actuators()[0].x, v = fine.integrator.actuators()[0].v;
  EXPECT_NEAR(42e3 * v, fine_impulse - 251e3 * 1.0 - 1e4 * (x - kCraneStrokes[0]), 1.0);
}

TEST(CraneCircuit, passive_parts_never_create_power) {
  // flows of everything but pumps, sources and what stores energy (accumulators, gears, lines) at random states: sum of
  // p Q into the volumes, tank included, is not positive
  const auto is_active = [](const auto& component) {
    constexpr std::string_view kActive[] = {"ls_pump",         "pump", "accumulator",      "flow_source",
                                            "pressure_source", "line", "gear_flow_divider"};
    return std::find(std::begin(kActive), std::end(kActive), component->type_name()) != std::end(kActive);
  };
  for (const auto make : {crane_circuit, bench_circuit, divider_circuit}) {
    HydraulicsDef def = make();
    std::erase_if(def.components, is_active);
    Circuit circuit(def);
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(0, 1);
    const auto n = static_cast<std::size_t>(circuit.state_count());
    std::vector<double> y(n), f(n), C(n);
    for (int trial = 0; trial < testing::rounds(20'000, 1'000'000); ++trial) {
      for (int i = 0; i < circuit.volume_count(); ++i) {
        y[static_cast<std::size_t>(i)] = circuit.is_fixed(i) ? 1e5 : std::pow(10, 3.5 + 4.1 * unit(random));
      }
      for (int j = 0; j < circuit.actuator_count(); ++j) y[static_cast<std::size_t>(circuit.position(j))] = 0.75;
      for (auto k = static_cast<std::size_t>(circuit.first_component_state()); k < n; ++k) {
        y[k] = circuit.scales()[k] > 1 ? 2e7 * unit(random) : 2 * unit(random) - 1;  // LS pressures, spools
      }
      // a relief valve's opening is never negative
      y.back() = std::fabs(y.back());
      circuit.rates(y.data(), f.data());
      circuit.capacities(y.data(), C.data());
      double power = 0, tank_flow = 0, size = 0;
      for (int i = 0; i < circuit.volume_count(); ++i) {
        const auto v = static_cast<std::size_t>(i);
        power += y[v] * C[v] * f[v];
        tank_flow -= C[v] * f[v];
        size += std::fabs(y[v] * C[v] * f[v]);
      }
      EXPECT_LE(power + 1e5 * tank_flow, 1e-9 * size);
    }
  }
}

TEST(CraneCircuit, a_tighter_tolerance_converges) {
  const auto final_state = [](double tolerance) {
    HydraulicsDef def = crane_circuit();
    def.relative_tolerance = tolerance;
    CraneCircuit crane(std::move(def));
    crane.command("L90Lift", 500);
    crane.run(1.0);
    crane.command("L90Lift", 0);
    crane.run(0.5);
    return crane.integrator.actuators()[0];
  };
  const ActuatorLinearisation reference = final_state(1e-8);
  double last = 1e9;
  for (const double tolerance : {1e-3, 1e-4, 1e-5, 1e-6}) {
    const ActuatorLinearisation result = final_state(tolerance);
    const double error = std::fabs(result.p_a - reference.p_a);
    EXPECT_LT(error, tolerance * 200 * kBar) << tolerance;
    EXPECT_LT(std::fabs(result.x - reference.x), 1e-6);
    last = std::min(last, error);
  }
  EXPECT_LT(last, 1e3);
}

TEST(CraneCircuit, stiff_extremes_stay_finite_and_inside_the_budget) {
  struct Extreme {
    const char* name;
    void (*change)(HydraulicsDef&);
  };
  const Extreme extremes[] = {
      {"pump line of 1 ml",
       [](HydraulicsDef& def) {
         std::erase_if(def.components, [](const auto& c) { return c->name == "Hose_MainPump"; });
         def.volumes[0].rigid_volume = 1e-6;
       }},
      {"spool of 1 ms",
       [](HydraulicsDef& def) {
         for (auto& c : def.components) {
           if (c->type_name() == "l90ls_valve") static_cast<L90lsValveDef&>(*c).step_response = 1e-3;
         }
       }},
      {"orifice transition of 1 kPa", [](HydraulicsDef& def) { def.orifice_transition = 1e3; }},
      {"all three",
       [](HydraulicsDef& def) {
         std::erase_if(def.components, [](const auto& c) { return c->name == "Hose_MainPump"; });
         def.volumes[0].rigid_volume = 1e-6;
         def.orifice_transition = 1e3;
         for (auto& c : def.components) {
           if (c->type_name() == "l90ls_valve") static_cast<L90lsValveDef&>(*c).step_response = 1e-3;
         }
       }},
      {"no air", [](HydraulicsDef& def) { def.entrained_air = 0; }},
      {"start at 1 bar", [](HydraulicsDef& def) { def.start = StartState::table13; }},
  };
  for (const Extreme& extreme : extremes) {
    HydraulicsDef def = crane_circuit();
    extreme.change(def);
    CraneCircuit crane(std::move(def));
    StepReport all = crane.run(0.2);
    for (const char* valve : {"L90Lift", "L90Jib", "L90Slew"}) {
      for (const double signal : {500.0, -500.0, 0.0}) {
        crane.command(valve, signal);
        const StepReport report = crane.run(0.4);
        all.flags |= report.flags;
        all.substeps = std::max(all.substeps, report.substeps);
      }
    }
    EXPECT_FALSE(all.has(StepFlag::non_finite)) << extreme.name;
    EXPECT_FALSE(all.has(StepFlag::step_budget)) << extreme.name << " worst " << all.substeps;
    for (const double value : crane.integrator.state()) EXPECT_TRUE(std::isfinite(value)) << extreme.name;
    const int volumes = crane.circuit.volume_count();
    for (int i = 0; i < volumes; ++i) {
      const double p = crane.integrator.state()[static_cast<std::size_t>(i)];
      EXPECT_GT(p, 0) << extreme.name << " " << crane.circuit.volume_name(i);
      EXPECT_LT(p, 600 * kBar) << extreme.name << " " << crane.circuit.volume_name(i);
    }
  }
}

TEST(CraneCircuit, cavitation_is_flagged_and_recovers) {
  // pull the slew piston out of a volume that nothing refills
  HydraulicsDef def = crane_circuit();
  for (auto& c : def.components) {
    if (c->type_name() == "l90ls_valve") static_cast<L90lsValveDef&>(*c).anti_cavitation_flow = 0;
  }
  CraneCircuit crane(std::move(def));
  const double still[] = {0, 0, 0}, pulled[] = {0, 0, 0.6}, pushed[] = {0, 0, -0.6};
  const HeldSpeed motion(3);
  const double p_0 = crane.variable("Vol_SlewCyl_A.pressure");
  bool was_cavitating = false;
  for (const double* v : {pulled, pushed, still}) {
    for (int k = 0; k < 100; ++k) {
      std::vector<double> x;
      for (const ActuatorLinearisation& a : crane.integrator.actuators()) x.push_back(a.x);
      crane.integrator.align(x, {v, 3});
      const StepReport report = crane.integrator.step(kStep, motion);
      was_cavitating = was_cavitating || report.has(StepFlag::cavitating);
      EXPECT_FALSE(report.has(StepFlag::non_finite));
    }
  }
  EXPECT_TRUE(was_cavitating);
  EXPECT_NEAR(crane.variable("Vol_SlewCyl_A.pressure"), p_0, 2e5);
}

TEST(CraneCircuit, one_thousand_steps_do_not_allocate) {
  CraneCircuit crane;
  crane.run(0.1);
  const int lift = crane.circuit.find_control("L90Lift"), overlap = crane.circuit.find_parameter("L90Lift.overlap");
  std::vector<double> x(3), v(3);
  AllocationGuard guard;
  for (int k = 0; k < 1000; ++k) {
    crane.circuit.set_control(lift, k < 500 ? 500 : -500);
    crane.circuit.set_parameter(overlap, 0.3 + 1e-5 * k);
    for (std::size_t j = 0; j < 3; ++j) {
      x[j] = crane.integrator.actuators()[j].x + 1e-8;
      v[j] = crane.integrator.actuators()[j].v;
    }
    crane.integrator.align(x, v);
    crane.integrator.step(kStep, crane.load);
    crane.circuit.read_variables(crane.integrator.state().data(), crane.values);
    StateHash hash;
    crane.integrator.add_to(hash);
  }
  EXPECT_EQ(guard.allocations(), 0u);
  EXPECT_EQ(guard.frees(), 0u);
}

TEST(OilTemperature, two_hundred_steps_of_every_component_do_not_allocate) {
  for (const auto make : {bench_circuit, divider_circuit}) {
    HydraulicsDef def = make();
    def.oil_temperature = OilTemperature::by_volume, def.hot_viscosity = 6.8e-6;
    def.start = StartState::table13, def.volumes[0].initial_pressure = 100e5;
    Circuit circuit(def);
    CircuitIntegrator integrator(circuit, def);
    const std::vector<double> x(static_cast<std::size_t>(circuit.actuator_count()), 0.4), zero(x.size(), 0.0);
    const HeldSpeed held(x.size());
    integrator.start(x, zero, zero);
    std::vector<double> values(circuit.variables().size());
    integrator.step(kStep, held);
    const std::vector<double> before(circuit.temperatures().begin(), circuit.temperatures().end());
    const AllocationGuard guard;
    for (int k = 0; k < 200; ++k) {
      integrator.step(kStep, held);
      circuit.read_variables(integrator.state().data(), values);
      StateHash hash;
      integrator.add_to(hash);
    }
    EXPECT_EQ(guard.allocations(), 0u);
    EXPECT_EQ(guard.frees(), 0u);
    EXPECT_FALSE(std::equal(before.begin(), before.end(), circuit.temperatures().begin()));
  }
}

}  // namespace crane_circuit_test
}  // namespace slew::hydraulics::test
