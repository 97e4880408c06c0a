// The stamped Jacobian against central differences of the right-hand side, at many random states.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "hydraulics/circuit.h"
#include "tests/properties/hydraulics/bench_circuit.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace slew::hydraulics::test {
namespace {

constexpr int kStates = 4000;

// Random states that visit both sides of every switch: pressures from vacuum to beyond the relief settings, often close
// to one another or to a switch.
std::vector<double> random_state(const Circuit& circuit, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<double> y(static_cast<std::size_t>(circuit.state_count()));
  const double common = std::pow(10, 3.5 + 4 * unit(random));
  constexpr double kSwitches[] = {8e4, 1e5, 101e5, 181e5, 189e5, 201e5, 251e5, 261e5, 271e5, 278e5};
  for (int i = 0; i < circuit.volume_count(); ++i) {
    const double choice = unit(random);
    double& p = y[static_cast<std::size_t>(i)];
    p = choice < 0.5    ? std::pow(10, 3.3 + 4.3 * unit(random))
        : choice < 0.75 ? common + 2e5 * (unit(random) - 0.5)
                        : kSwitches[random() % std::size(kSwitches)] + 1e5 * (unit(random) - 0.5);
    p = circuit.is_fixed(i) ? 1e5 : std::max(p, 1e3);
  }
  for (int j = 0; j < circuit.actuator_count(); ++j) {
    const LineForceParameters& line = circuit.actuators()[static_cast<std::size_t>(j)].line_force;
    y[static_cast<std::size_t>(circuit.position(j))] =
        line.minimum_stroke + (line.maximum_stroke - line.minimum_stroke) * unit(random);
    y[static_cast<std::size_t>(circuit.speed(j))] = 0.6 * (unit(random) - 0.5);
  }
  for (std::size_t k = static_cast<std::size_t>(circuit.first_component_state()); k < y.size(); ++k) {
    // LS lines carry pressures, the others -1.1..1.1
    y[k] = circuit.scales()[k] > 1 ? 3e7 * unit(random) : 2.2 * (unit(random) - 0.5);
    if (unit(random) < 0.2 && circuit.scales()[k] == 1) y[k] = 0.32 + 0.01 * (unit(random) - 0.5);
  }
  return y;
}

double difference_step(const Circuit& circuit, int j, double y_j) {
  if (j < circuit.volume_count()) return std::min(5.0, 1e-4 * y_j);  // Pa
  if (j < circuit.speed(0)) return 1e-6;
  return circuit.scales()[static_cast<std::size_t>(j)] > 1 ? 5 : 1e-6;
}

void expect_jacobian_matches(const HydraulicsDef& def, std::uint64_t seed) {
  Problems errors, warnings;
  validate(def, errors, warnings);
  ASSERT_TRUE(errors.empty()) << errors.front().path << ": " << errors.front().what;
  Circuit circuit(def);
  const int n = circuit.state_count();
  std::mt19937_64 random(seed);
  std::vector<double> f(static_cast<std::size_t>(n)), f_plus(f), f_minus(f), J(static_cast<std::size_t>(n * n));
  int mismatches = 0;
  for (int trial = 0; trial < kStates; ++trial) {
    std::vector<double> y = random_state(circuit, random);
    for (int c = 0; c < static_cast<int>(circuit.controls().size()); ++c) circuit.set_control(c, 500);
    circuit.rates(y.data(), f.data());
    const double* stamped = circuit.jacobian(y.data(), f.data());
    std::copy(stamped, stamped + n * n, J.begin());
    for (int j = 0; j < n; ++j) {
      if (j < circuit.volume_count() && circuit.is_fixed(j)) continue;
      const double y_j = y[static_cast<std::size_t>(j)], h = difference_step(circuit, j, y_j);
      y[static_cast<std::size_t>(j)] = y_j + h;
      circuit.rates(y.data(), f_plus.data());
      y[static_cast<std::size_t>(j)] = y_j - h;
      circuit.rates(y.data(), f_minus.data());
      y[static_cast<std::size_t>(j)] = y_j;
      for (int i = 0; i < n; ++i) {
        const auto row = static_cast<std::size_t>(i);
        const double expected = (f_plus[row] - f_minus[row]) / (2 * h);
        const double got = J[static_cast<std::size_t>(i * n + j)];
        // both one-sided differences bound a slope inside a narrow switch
        const double right = (f_plus[row] - f[row]) / h, left = (f[row] - f_minus[row]) / h;
        const double spread = std::fabs(right - left);
        const double rounding = 1e-11 * std::fabs(f[row]) / h;
        if (std::fabs(got - expected) > 1e-4 * std::fabs(expected) + spread + rounding + 1e-9) {
          if (++mismatches < 10) {
            ADD_FAILURE() << "state " << trial << " row " << i << " column " << j << ": stamped " << got
                          << ", difference " << expected << ", spread " << spread;
          }
        }
        if (got != 0) {
          EXPECT_TRUE(circuit.pattern().has(row, static_cast<std::size_t>(j)) ||
                      (i < circuit.volume_count() && circuit.is_fixed(i)))
              << "row " << i << " column " << j << " is outside of the declared pattern";
        }
      }
    }
  }
  EXPECT_EQ(mismatches, 0);
}

TEST(HydraulicJacobian, of_the_crane_circuit_equals_central_differences) {
  expect_jacobian_matches(crane_circuit(), 1);
}

TEST(HydraulicJacobian, of_the_remaining_component_types_equals_central_differences) {
  expect_jacobian_matches(bench_circuit(), 2);
}

TEST(HydraulicJacobian, test_circuits_hold_every_component_type) {
  const HydraulicsDef circuits[] = {crane_circuit(), bench_circuit()};
  for (const ComponentType& type : component_types()) {
    bool is_present = false;
    for (const HydraulicsDef& circuit : circuits) {
      for (const auto& component : circuit.components) is_present = is_present || component->type_name() == type.name;
    }
    EXPECT_TRUE(is_present) << type.name;
  }
}

}  // namespace
}  // namespace slew::hydraulics::test
