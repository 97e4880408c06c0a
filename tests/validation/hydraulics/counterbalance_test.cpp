// SPDX-License-Identifier: Apache-2.0
// Counterbalance valve: its law by hand, and the limit at which it lowers a stiff load without oscillation, from the
// linear model of docs/models/hydraulics_counterbalance_valve.md, which does not use the circuit's equations.
#include "hydraulics/components/counterbalance_valve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "hydraulics/circuit_integrator.h"
#include "tests/properties/hydraulics/bench_circuit.h"

namespace slew::hydraulics::test {
namespace counterbalance_test {

double variable(Circuit& circuit, const double* y, const std::string& name) {
  std::vector<double> values(circuit.variables().size());
  circuit.read_variables(y, values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (circuit.variables()[i].name == name) return values[i];
  }
  ADD_FAILURE() << "no variable " << name;
  return 0;
}

// pressures in bar; setting 200 bar, pilot ratio 4, 30 bar to full opening
struct Pressures {
  double valve, load, pilot, spring;
};

double steady_opening(const Pressures& p, bool is_vented) {
  HydraulicsDef def;
  def.orifice_transition = 1;
  add_tank(def, "P1", p.valve * kBar), add_tank(def, "P2", p.load * kBar);
  add_tank(def, "P3", p.pilot * kBar), add_tank(def, "P4", p.spring * kBar);
  CounterbalanceValveDef& valve = add<CounterbalanceValveDef>(def, "Valve");
  valve.port_1 = "P1", valve.port_2 = "P2", valve.port_3 = "P3", valve.port_4 = is_vented ? "P4" : "";
  valve.setting_pressure = 200 * kBar, valve.pilot_ratio = 4, valve.opening_pressure_rise = 30 * kBar;
  valve.nominal_flow = 1e-3, valve.nominal_pressure_drop = 10 * kBar, valve.step_response = 0.03;
  valve.check.nominal_flow = 1e-3;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start({}, {}, {});
  // it begins at rest: the opening of the start stays
  const double started = variable(circuit, integrator.state().data(), "Valve.opening");
  for (int k = 0; k < 100; ++k) integrator.step(1e-3, HeldSpeed(0));
  const double opening = variable(circuit, integrator.state().data(), "Valve.opening");
  EXPECT_NEAR(opening, started, 1e-9);
  const double flow = variable(circuit, integrator.state().data(), "Valve.flow");
  if (p.load > p.valve) {
    EXPECT_NEAR(flow, -opening * 1e-3 * std::sqrt((p.load - p.valve) / 10), 1e-9);
  }
  return opening;
}

TEST(CounterbalanceValve, opens_by_load_and_pilot_pressure_against_its_setting) {
  // relief without pilot: 201 bar above 1 bar is just closed, 15 bar more half open
  EXPECT_NEAR(steady_opening({1, 201, 1, 1}, false), 0, 1e-9);
  EXPECT_NEAR(steady_opening({1, 216, 1, 1}, false), 0.5, 1e-9);
  EXPECT_NEAR(steady_opening({1, 240, 1, 1}, false), 1, 1e-9);
  // a load of 100 bar needs 100 / 4 bar of pilot pressure above 1 bar, 3.75 bar more for half
  EXPECT_NEAR(steady_opening({1, 101, 26, 1}, false), 0, 1e-9);
  EXPECT_NEAR(steady_opening({1, 101, 29.75, 1}, false), 0.5, 1e-9);
}

TEST(CounterbalanceValve, a_back_pressure_raises_the_setting_by_one_and_the_pilot_ratio_unless_vented) {
  // 3 bar of back pressure: 15 bar of 30
  EXPECT_NEAR(steady_opening({4, 216, 1, 1}, false), 0, 1e-9);
  EXPECT_NEAR(steady_opening({4, 231, 1, 1}, false), 0.5, 1e-9);
  EXPECT_NEAR(steady_opening({4, 216, 1, 1}, true), 0.5, 1e-9);
}

TEST(CounterbalanceValve, passes_oil_freely_towards_the_load) {
  HydraulicsDef def;
  def.orifice_transition = 1;
  add_tank(def, "P1", 105 * kBar), add_tank(def, "P2", 100 * kBar), add_tank(def, "P3", 1 * kBar);
  CounterbalanceValveDef& valve = add<CounterbalanceValveDef>(def, "Valve");
  valve.port_1 = "P1", valve.port_2 = "P2", valve.port_3 = "P3";
  valve.setting_pressure = 200 * kBar, valve.nominal_flow = 1e-3, valve.check.nominal_flow = 2e-3;
  Circuit circuit(def);
  std::vector<double> y(static_cast<std::size_t>(circuit.state_count()));
  circuit.start_at_initial_pressures(y);
  EXPECT_NEAR(variable(circuit, y.data(), "Valve.flow"), 2e-3, 1e-9);
}

TEST(CounterbalanceValve, its_check_valve_must_be_open_at_its_drop) {
  HydraulicsDef def = bench_circuit();
  for (auto& component : def.components) {
    if (component->name == "Counterbalance") {
      dynamic_cast<CounterbalanceValveDef&>(*component).check.nominal_pressure_drop = 0.6 * kBar;
    }
  }
  Problems errors, warnings;
  validate(def, errors, warnings);
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors.front().path, "Counterbalance.check_pressure_drop");
  EXPECT_EQ(errors.front().what, "at this drop the valve is not fully open: it is from 0.7 bar on");
}

// A cylinder lowers a load at v_0 = Q/A_B: constant flow Q into the rod side B, which is the pilot line, the bottom
// side A through the valve to tank. Oil of constant bulk modulus in large volumes, no friction, no leak.
struct Lowering {
  double pilot_ratio = 3, step_response = 0.02;
  static constexpr double D = 0.1, d = 0.06, mass = 4000, load = 70e3;                      // m, kg, N
  static constexpr double V_A = 5e-3, V_B = 10e-3, B = 1.5e9, Q = 5e-5;                     // m3, Pa, m3/s
  static constexpr double p_T = 1e5, setting = 140e5, rise = 30e5, K = 5e-4 / 3162.277660;  // K: 30 l/min at 100 bar
  static constexpr double A_A = std::numbers::pi / 4 * D * D, A_B = std::numbers::pi / 4 * (D * D - d * d);

  struct Steady {
    double p_A, p_B, u, v;
  };
  // u K sqrt(p_A - p_T) = A_A v_0, p_A A_A - p_B A_B = load, (1) of the valve's header, by iteration on u
  [[nodiscard]] Steady steady() const {
    Steady s{0, 0, 0.1, -Q / A_B};
    for (int k = 0; k < 200; ++k) {
      // p_A + r p_B = sum, p_B = (p_A A_A - load)/A_B
      const double sum = rise * s.u + setting + (1 + pilot_ratio) * p_T;
      s.p_A = (sum + pilot_ratio * load / A_B) / (1 + pilot_ratio * A_A / A_B);
      s.p_B = (s.p_A * A_A - load) / A_B;
      s.u = A_A * -s.v / (K * std::sqrt(s.p_A - p_T));
    }
    return s;
  }

  // coefficients a_0..a_4 of the linear model's characteristic polynomial
  //   (s + gamma)(s^2 + w_B^2)(1 + tau s) + w_A^2 s (1 + tau s) + kappa (s^2 + R w_B^2),  R = 1 + r A_A/A_B
  [[nodiscard]] std::vector<double> polynomial() const {
    const Steady s = steady();
    const double C_A = V_A / B, C_B = V_B / B, tau = step_response / 3;
    const double gamma = s.u * K / (2 * std::sqrt(s.p_A - p_T)) / C_A;
    const double kappa = K * std::sqrt(s.p_A - p_T) / rise / C_A;
    const double w_A2 = A_A * A_A / (mass * C_A), w_B2 = A_B * A_B / (mass * C_B);
    const double R = 1 + pilot_ratio * A_A / A_B;
    return {w_B2 * (gamma + kappa * R), w_A2 + w_B2 * (1 + gamma * tau), gamma + kappa + tau * (w_A2 + w_B2),
            1 + gamma * tau, tau};
  }
  // Routh: a_3 a_2 a_1 - a_4 a_1^2 - a_3^2 a_0, positive when stable
  [[nodiscard]] double routh() const {
    const std::vector<double> a = polynomial();
    return a[3] * a[2] * a[1] - a[4] * a[1] * a[1] - a[3] * a[3] * a[0];
  }
  // root near the oscillation of the mass on both oil columns
  [[nodiscard]] std::complex<double> oscillating_root() const {
    const std::vector<double> a = polynomial();
    std::complex<double> s(0, std::sqrt(A_A * A_A * B / V_A / mass + A_B * A_B * B / V_B / mass));
    for (int k = 0; k < 50; ++k) {
      const std::complex<double> f = a[0] + s * (a[1] + s * (a[2] + s * (a[3] + s * a[4])));
      s -= f / (a[1] + s * (2 * a[2] + s * (3 * a[3] + s * 4.0 * a[4])));
    }
    return s;
  }

  [[nodiscard]] HydraulicsDef circuit() const {
    HydraulicsDef def;
    def.oil_bulk_modulus = B, def.entrained_air = 0, def.orifice_transition = 1, def.relative_tolerance = 1e-8;
    def.minimum_step = 1e-9;
    add_volume(def, "A").rigid_volume = V_A - 0.5 * A_A;
    add_volume(def, "B").rigid_volume = V_B - 0.5 * A_B;
    add_tank(def, "Tank", p_T), add_tank(def, "Supply", 400e5);
    CounterbalanceValveDef& valve = add<CounterbalanceValveDef>(def, "Valve");
    valve.port_1 = "Tank", valve.port_2 = "A", valve.port_3 = "B";
    valve.setting_pressure = setting, valve.pilot_ratio = pilot_ratio, valve.opening_pressure_rise = rise;
    valve.nominal_flow = K * std::sqrt(100e5), valve.nominal_pressure_drop = 100e5;
    valve.step_response = step_response, valve.check.nominal_flow = 1e-3;
    // its compensator makes the flow independent of p_B
    CompensatedOrificeDef& source = add<CompensatedOrificeDef>(def, "Source");
    source.port_p = "Supply", source.port_a = "B", source.port_t = "Tank", source.area = 1e-6;
    DoubleActingCylinderDef& cylinder = add<DoubleActingCylinderDef>(def, "Cylinder");
    cylinder.rod_diameter = d, cylinder.rod_length = 1, cylinder.common.force = "Force";
    cylinder.common.port_a = "A", cylinder.common.port_b = "B", cylinder.common.bulk_modulus = 1e18;
    cylinder.common.piston_diameter = D, cylinder.common.chamber_length = 1;
    cylinder.common.minimum_stroke = 0.05, cylinder.common.maximum_stroke = 0.95;
    return def;
  }

  // share of v_0 up to which a disturbance counts as small: the spool's opening stays within its limits
  static constexpr double kSmall = 0.1;

  // growth [1/s] of a small disturbance of the speed, from the peaks of |v - v_0| of the first and the last small
  // swing; the compensated source is scaled to Q
  [[nodiscard]] double simulated_growth() const {
    HydraulicsDef def = circuit();
    auto& source = dynamic_cast<CompensatedOrificeDef&>(*def.components[1]);
    for (int k = 0; k < 2; ++k) {
      Circuit probe(def);
      std::vector<double> y(static_cast<std::size_t>(probe.state_count()));
      probe.start_at_initial_pressures(y);
      source.area *= Q / variable(probe, y.data(), "Source.flow");
    }
    Circuit circuit(def);
    CircuitIntegrator integrator(circuit, def);
    const Steady s = steady();
    const double x[] = {0.5}, v[] = {s.v * 1.002}, F[] = {load};
    integrator.start(x, v, F);
    std::span<double> y = integrator.mutable_state();
    y[0] = s.p_A, y[1] = s.p_B, y[static_cast<std::size_t>(circuit.first_component_state())] = s.u;
    integrator.refresh();
    MassLoad moved({{mass, load, 0}});
    constexpr double kStep = 5e-4;
    constexpr std::size_t kSwings = 14;
    std::vector<std::pair<double, double>> peaks;  // time, |v - v_0|
    double before = v[0] - s.v, at = before;
    for (int k = 1; k <= 2000 && peaks.size() < kSwings; ++k) {
      EXPECT_FALSE(integrator.step(kStep, moved).has_failed());
      const double now = integrator.actuators()[0].v - s.v;
      // parabola through the three values about a peak
      if (std::fabs(now) > kSmall * -s.v) break;
      if (k > 2 && std::fabs(at) >= std::fabs(before) && std::fabs(at) > std::fabs(now)) {
        const double bend = before - 2 * at + now, slope = 0.5 * (now - before);
        peaks.emplace_back((k - 1 - slope / bend) * kStep, std::fabs(at - 0.5 * slope * slope / bend));
      }
      before = at, at = now;
    }
    // two neighbours together: a drift of the mean speed falls out
    const auto swing = [&](std::size_t i) { return 0.5 * (peaks[i].second + peaks[i + 1].second); };
    const std::size_t last = peaks.size() - 2;
    return std::log(swing(last) / swing(2)) / (peaks[last].first - peaks[2].first);
  }
};

// (tau -> 0) r* = (1 + gamma/kappa) (A_A/C_A)/(A_B/C_B), in general R* = a_1 (a_2 a_3 - a_4 a_1)/(a_3^2 kappa w_B^2) -
// gamma/kappa; the steady point depends on r a little, so that the limit is found by bisection of Routh's determinant
double limiting_pilot_ratio(double step_response) {
  double low = 0.1, high = 20;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (Lowering{middle, step_response}.routh() > 0 ? low : high) = middle;
  }
  return low;
}

TEST(CounterbalanceStability, the_limit_is_the_ratio_of_the_sides_pressures_per_stroke) {
  using L = Lowering;
  // by hand: C_B/C_A = 2, A_A/A_B = 1/0.64; gamma/kappa = u rise/(2 (p_A - p_T))
  const double r = limiting_pilot_ratio(1e-9);
  const L::Steady s = L{r, 1e-9}.steady();
  EXPECT_NEAR(r, 2 / 0.64 * (1 + s.u * L::rise / (2 * (s.p_A - L::p_T))), 1e-4 * r);
}

TEST(CounterbalanceStability, a_disturbance_grows_and_decays_at_the_rate_of_the_linear_model) {
  for (const double step_response : {0.006, 0.03, 0.15}) {
    const double limit = limiting_pilot_ratio(step_response);
    for (const double share : {0.5, 0.8, 1.25, 2.0}) {
      const Lowering lowering{share * limit, step_response};
      const double expected = lowering.oscillating_root().real(), simulated = lowering.simulated_growth();
      EXPECT_EQ(expected < 0, share < 1);
      EXPECT_NEAR(simulated, expected, 0.05 * std::fabs(expected) + 0.05) << step_response << " s, " << share;
    }
  }
}

}  // namespace counterbalance_test
}  // namespace slew::hydraulics::test
