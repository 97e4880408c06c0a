// SPDX-License-Identifier: Apache-2.0
// The solvers that a circuit may choose, against each other, and volumes without storage against small ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/allocation_guard.h"
#include "hydraulics/circuit_integrator.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace slew::hydraulics::test {
namespace solver_test {

constexpr double kStep = 1e-3;
constexpr Solver kSolvers[] = {Solver::rodas3, Solver::rk4, Solver::implicit_euler, Solver::cvode};

HydraulicsDef with(Solver solver, double relative_tolerance = 1e-4, double max_substep = 1e-4) {
  HydraulicsDef def = crane_circuit();
  def.solver = solver;
  def.relative_tolerance = relative_tolerance;
  def.max_substep = max_substep;
  return def;
}

// The pump line without its hose.
void set_pump_line(HydraulicsDef& def, double volume) {
  std::erase_if(def.components, [](const auto& c) { return c->name == "Hose_MainPump"; });
  def.volumes[0].rigid_volume = volume;
}

// Pressures of all volumes and strokes after every step of 1.5 s: the lift at full command from 0.2 to 1.2 s.
struct Trace {
  std::vector<std::vector<double>> y;
  std::uint32_t flags = 0, restarts = 0, flagged_steps = 0;
  std::uint64_t hash = 0;
  int volumes = 0;
};

Trace lift_and_stop(const HydraulicsDef& def, double duration = 1.5) {
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  const MassLoad load = crane_load();
  integrator.start(kCraneStrokes, kAtRest, kCraneForces);
  Trace trace;
  trace.volumes = circuit.volume_count();
  const int lift = circuit.find_control("L90Lift");
  for (int k = 0; k < static_cast<int>(std::lround(duration / kStep)); ++k) {
    circuit.set_control(lift, k >= 200 && k < 1200 ? 500 : 0);
    const StepReport report = integrator.step(kStep, load);
    trace.flags |= report.flags;
    trace.flagged_steps += report.flags != 0 ? 1 : 0;
    trace.restarts += integrator.last_report().restarts;
    trace.y.emplace_back(integrator.state().begin(), integrator.state().end());
  }
  StateHash hash;
  integrator.add_to(hash);
  trace.hash = hash.digest();
  return trace;
}

// Largest difference of a pressure [bar]; of one volume, or of all.
double difference(const Trace& a, const Trace& b, int volume = -1) {
  double worst = 0;
  for (std::size_t k = 0; k < a.y.size(); ++k) {
    for (int i = 0; i < a.volumes; ++i) {
      const auto v = static_cast<std::size_t>(i);
      if (volume < 0 || i == volume) worst = std::max(worst, std::fabs(a.y[k][v] - b.y[k][v]) / kBar);
    }
  }
  return worst;
}

const Trace& reference() {
  static const Trace trace = lift_and_stop(with(Solver::cvode, 1e-9));
  return trace;
}

TEST(HydraulicSolvers, each_is_as_close_to_the_reference_as_its_method_allows) {
  struct Case {
    Solver solver;
    double relative_tolerance, max_substep, bound;  // bound: bar, of the fast pump line
  };
  for (const Case& c : {Case{Solver::rodas3, 1e-4, 0, 0.1}, Case{Solver::rodas3, 1e-6, 0, 0.01},
                        Case{Solver::rk4, 1e-4, 1e-4, 0.01}, Case{Solver::implicit_euler, 1e-4, 1e-4, 2},
                        Case{Solver::cvode, 1e-4, 0, 0.3}, Case{Solver::cvode, 1e-6, 0, 0.03}}) {
    const Trace trace = lift_and_stop(with(c.solver, c.relative_tolerance, std::max(c.max_substep, 1e-6)));
    const std::string name(kSolverChoices[static_cast<std::size_t>(c.solver)]);
    const double error = difference(trace, reference());
    RecordProperty(name + "_" + std::to_string(-std::log10(c.relative_tolerance)) + "_bar", std::to_string(error));
    EXPECT_LT(error, c.bound) << name << " " << c.relative_tolerance;
    EXPECT_EQ(trace.flags, 0u) << name;
  }
}

TEST(HydraulicSolvers, implicit_euler_is_of_first_order_and_runge_kutta_of_a_higher_one) {
  const auto error = [](Solver solver, double h) {
    return difference(lift_and_stop(with(solver, 1e-7, h)), reference());
  };
  EXPECT_NEAR(error(Solver::implicit_euler, 1e-4) / error(Solver::implicit_euler, 5e-5), 2, 0.5);
  // commands and kinks of the valves are left of the fourth
  EXPECT_GT(error(Solver::rk4, 5e-4) / error(Solver::rk4, 2.5e-4), 2.5);
}

TEST(HydraulicSolvers, give_the_same_bits_twice) {
  for (const Solver solver : kSolvers) {
    const Trace first = lift_and_stop(with(solver)), second = lift_and_stop(with(solver));
    EXPECT_EQ(first.hash, second.hash) << static_cast<int>(solver);
    EXPECT_EQ(first.y, second.y) << static_cast<int>(solver);
  }
}

TEST(HydraulicSolvers, cvode_restarts_at_commands_only) {
  // at the start, and when the command comes and goes
  EXPECT_EQ(lift_and_stop(with(Solver::cvode, 1e-6)).restarts, 3u);
}

TEST(HydraulicSolvers, cvode_takes_small_corrections_of_the_pistons_along) {
  const HydraulicsDef def = with(Solver::cvode, 1e-6);
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  const MassLoad load = crane_load();
  integrator.start(kCraneStrokes, kAtRest, kCraneForces);
  static_cast<void>(integrator.step(kStep, load));
  double x[3], v[3];
  const auto align_by = [&](double dx) {
    for (std::size_t j = 0; j < 3; ++j) x[j] = integrator.actuators()[j].x + dx, v[j] = integrator.actuators()[j].v;
    integrator.align(x, v);
    static_cast<void>(integrator.step(kStep, load));
    return integrator.last_report().restarts;
  };
  EXPECT_EQ(align_by(1e-9), 0u);
  EXPECT_EQ(align_by(1e-4), 1u);
}

TEST(HydraulicSolvers, no_step_allocates) {
  for (const Solver solver : kSolvers) {
    const HydraulicsDef def = with(solver);
    Circuit circuit(def);
    CircuitIntegrator integrator(circuit, def);
    const MassLoad load = crane_load();
    integrator.start(kCraneStrokes, kAtRest, kCraneForces);
    const AllocationGuard guard;
    for (int k = 0; k < 1000; ++k) {
      if (k == 200) circuit.set_control(0, 500);
      static_cast<void>(integrator.step(kStep, load));
    }
    EXPECT_EQ(guard.allocations(), 0u) << static_cast<int>(solver);
  }
}

TEST(HydraulicSolvers, runge_kutta_names_the_volume_that_is_too_fast_for_it) {
  HydraulicsDef def = with(Solver::rk4, 1e-4, 5e-4);
  const MassLoad load = crane_load();
  {
    Circuit circuit(def);
    CircuitIntegrator integrator(circuit, def);
    integrator.start(kCraneStrokes, kAtRest, kCraneForces);
    EXPECT_LT(integrator.explicit_stability(kStep, load).ratio, 1);
    EXPECT_FALSE(integrator.step(kStep, load).has(StepFlag::not_converged));
  }
  set_pump_line(def, 1e-6);
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start(kCraneStrokes, kAtRest, kCraneForces);
  const ExplicitStability stability = integrator.explicit_stability(kStep, load);
  EXPECT_GT(stability.ratio, 1);
  EXPECT_EQ(stability.owner, circuit.find_volume("Vol_MainPump"));
  EXPECT_EQ(stability.substep, 5e-4);
  const StepReport report = integrator.step(kStep, load);
  EXPECT_TRUE(report.has(StepFlag::not_converged));
  EXPECT_EQ(report.offender, circuit.find_volume("Vol_MainPump"));
}

TEST(QuasiStaticVolume, is_the_limit_of_a_small_one) {
  HydraulicsDef def = with(Solver::rodas3, 1e-6);
  set_pump_line(def, 1e-6);
  def.volumes[0].quasi_static = true;
  const Trace limit = lift_and_stop(def, 0.6);
  // the line jumps from 26 to 100 bar when the spool leaves its overlap: no sub-step is short enough for that
  EXPECT_LE(limit.flagged_steps, 2u);
  double larger = 0;
  for (const double volume : {1e-5, 1e-6, 1e-7}) {
    HydraulicsDef small = with(Solver::cvode, 1e-8);
    set_pump_line(small, volume);
    const Trace trace = lift_and_stop(small, 0.6);
    // all but the line itself, whose first peak belongs to its volume
    double chambers = 0;
    for (int i = 1; i < trace.volumes; ++i) chambers = std::max(chambers, difference(limit, trace, i));
    if (larger > 0) {
      EXPECT_LT(chambers, 0.35 * larger + 2e-4) << volume;
    }
    larger = chambers;
  }
  EXPECT_LT(larger, 0.01);
}

TEST(QuasiStaticVolume, has_flows_that_add_up_to_zero) {
  for (const Solver solver : {Solver::rodas3, Solver::implicit_euler}) {
    HydraulicsDef def = with(solver);
    set_pump_line(def, 1e-6);
    def.volumes[0].quasi_static = true;
    Circuit circuit(def);
    CircuitIntegrator integrator(circuit, def);
    const MassLoad load = crane_load();
    integrator.start(kCraneStrokes, kAtRest, kCraneForces);
    std::vector<double> f(integrator.state().size()), C(static_cast<std::size_t>(circuit.volume_count()));
    int flagged = 0;
    for (int k = 0; k < 1000; ++k) {
      if (k == 200) circuit.set_control(circuit.find_control("L90Lift"), 500);
      flagged += integrator.step(kStep, load).flags != 0 ? 1 : 0;
      circuit.rates(integrator.state().data(), f.data());
      circuit.capacities(integrator.state().data(), C.data());
      EXPECT_LT(std::fabs(f[0] * C[0]), 0.05 * kLitrePerMinute) << k;
    }
    EXPECT_LE(flagged, 2) << static_cast<int>(solver);
  }
}

TEST(QuasiStaticVolume, begins_where_its_flows_balance_however_large_it_is) {
  for (const double volume : {1e-6, 1e-3, 1.0}) {
    HydraulicsDef def = with(Solver::rodas3);
    set_pump_line(def, volume);
    def.volumes[0].quasi_static = true;
    Circuit circuit(def);
    CircuitIntegrator integrator(circuit, def);
    // the pump is at rest, so that its line bleeds to the tank
    integrator.start(kCraneStrokes, kAtRest, kCraneForces);
    EXPECT_NEAR(integrator.state()[0], 1e5, 1) << volume;
    EXPECT_FALSE(integrator.step(kStep, crane_load()).has(StepFlag::not_converged)) << volume;
  }
}

TEST(QuasiStaticVolume, is_chosen_by_its_rate) {
  HydraulicsDef def = with(Solver::rodas3);
  def.quasi_static_above = 1e4;
  {
    Circuit circuit(def);
    CircuitIntegrator integrator(circuit, def);
    integrator.start(kCraneStrokes, kAtRest, kCraneForces);
    EXPECT_TRUE(integrator.quasi_static().empty());
  }
  set_pump_line(def, 1e-8);
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start(kCraneStrokes, kAtRest, kCraneForces);
  ASSERT_EQ(integrator.quasi_static().size(), 1u);
  EXPECT_EQ(integrator.quasi_static()[0], circuit.find_volume("Vol_MainPump"));
}

}  // namespace solver_test
}  // namespace slew::hydraulics::test
