// SPDX-License-Identifier: Apache-2.0
// The stamped Jacobian against central differences of the right-hand side, at many random states.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "hydraulics/circuit.h"
#include "tests/properties/hydraulics/bench_circuit.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace slew::hydraulics::test {
namespace jacobian_test {

constexpr int kStates = 4000;

// Random states that visit both sides of every switch: pressures from vacuum to beyond the relief settings, often close
// to one another, to a switch, or both.
std::vector<double> random_state(const Circuit& circuit, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<double> y(static_cast<std::size_t>(circuit.state_count()));
  constexpr double kSwitches[] = {8e4, 1e5, 101e5, 181e5, 189e5, 201e5, 251e5, 261e5, 271e5, 278e5};
  const auto near_a_switch = [&] { return kSwitches[random() % std::size(kSwitches)] + 1e5 * (unit(random) - 0.5); };
  const double common = unit(random) < 0.5 ? std::pow(10, 3.5 + 4 * unit(random)) : near_a_switch();
  for (int i = 0; i < circuit.volume_count(); ++i) {
    const double choice = unit(random);
    double& p = y[static_cast<std::size_t>(i)];
    p = choice < 0.5    ? std::pow(10, 3.3 + 4.3 * unit(random))
        : choice < 0.65 ? common + 2e5 * (unit(random) - 0.5)
        : choice < 0.75 ? common + 10 * (unit(random) - 0.5)  // less apart than the differences' step
                        : near_a_switch();
    p = circuit.is_fixed(i) ? 1e5 : std::max(p, 1e3);
  }
  for (int j = 0; j < circuit.actuator_count(); ++j) {
    const LineForceParameters& line = circuit.actuators()[static_cast<std::size_t>(j)].line_force;
    // a motor has no ends
    const double least = std::max(line.minimum_stroke, -100.0), most = std::min(line.maximum_stroke, 100.0);
    y[static_cast<std::size_t>(circuit.position(j))] = least + (most - least) * unit(random);
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

// One entry of the Jacobian against differences of one right-hand side over steps of h.
class Difference {
 public:
  Difference(double minus, double centre, double plus, double h)
      : left_((centre - minus) / h), right_((plus - centre) / h), rounding_(1e-11 * std::fabs(centre) / h) {}

  [[nodiscard]] double central() const { return 0.5 * (left_ + right_); }
  [[nodiscard]] double spread() const { return std::fabs(right_ - left_); }
  [[nodiscard]] bool agrees_with(double slope, double allowance) const {
    return std::fabs(slope - central()) <= 1e-4 * std::fabs(central()) + rounding_ + 1e-9 + allowance;
  }

 private:
  double left_, right_, rounding_;
};

void expect_jacobian_matches(const HydraulicsDef& def, std::uint64_t seed) {
  Problems errors, warnings;
  validate(def, errors, warnings);
  ASSERT_TRUE(errors.empty()) << errors.front().path << ": " << errors.front().what;
  Circuit circuit(def);
  const int n = circuit.state_count();
  std::mt19937_64 random(seed);
  const auto size = static_cast<std::size_t>(n);
  std::vector<double> f(size), f_plus(size), f_minus(size), f_near_plus(size), f_near_minus(size), J(size * size);
  int mismatches = 0;
  for (int trial = 0; trial < kStates; ++trial) {
    std::vector<double> y = random_state(circuit, random);
    for (int c = 0; c < static_cast<int>(circuit.controls().size()); ++c) circuit.set_control(c, 500);
    circuit.rates(y.data(), f.data());
    const double* stamped = circuit.jacobian(y.data(), f.data());
    std::copy(stamped, stamped + n * n, J.begin());
    for (int j = 0; j < n; ++j) {
      if (j < circuit.volume_count() && circuit.is_fixed(j)) continue;
      const double y_j = y[static_cast<std::size_t>(j)], h = difference_step(circuit, j, y_j), near = h / 4;
      const auto rates_at = [&](double value, std::vector<double>& rates) {
        y[static_cast<std::size_t>(j)] = value;
        circuit.rates(y.data(), rates.data());
        y[static_cast<std::size_t>(j)] = y_j;
      };
      rates_at(y_j + h, f_plus), rates_at(y_j - h, f_minus);
      rates_at(y_j + near, f_near_plus), rates_at(y_j - near, f_near_minus);
      for (int i = 0; i < n; ++i) {
        const auto row = static_cast<std::size_t>(i);
        const double got = J[static_cast<std::size_t>(i * n + j)];
        const Difference wide(f_minus[row], f[row], f_plus[row], h);
        const Difference close(f_near_minus[row], f[row], f_near_plus[row], near);
        // inside a narrow switch the slope lies between the one-sided differences, which approach each other with the
        // step; at a kink they would not, at a jump they would move apart
        const bool is_curved = close.spread() < 0.5 * wide.spread();
        if (!wide.agrees_with(got, 0) && !close.agrees_with(got, is_curved ? close.spread() : 0)) {
          if (++mismatches < 10) {
            ADD_FAILURE() << "state " << trial << " row " << i << " column " << j << ": stamped " << got
                          << ", difference " << wide.central() << " and closer " << close.central() << ", spread "
                          << wide.spread() << " and closer " << close.spread();
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

TEST(HydraulicJacobian, of_dividers_and_lines_equals_central_differences) {
  expect_jacobian_matches(divider_circuit(), 4);
}

void expect_same_bits_at_once(const HydraulicsDef& def, std::uint64_t seed) {
  Circuit circuit(def);
  const auto n = static_cast<std::size_t>(circuit.state_count());
  const auto volumes = static_cast<std::size_t>(circuit.volume_count());
  std::mt19937_64 random(seed);
  std::vector<double> f(n), f_at_once(n), J(n * n), slope(n), slope_at_once(n), C(volumes), C_at_once(volumes);
  for (int c = 0; c < static_cast<int>(circuit.controls().size()); ++c) circuit.set_control(c, 500);
  for (int trial = 0; trial < kStates; ++trial) {
    const std::vector<double> y = random_state(circuit, random);
    circuit.rates(y.data(), f.data());
    const double* stamped = circuit.jacobian(y.data(), f.data());
    std::copy(stamped, stamped + n * n, J.begin());
    circuit.outflow_slopes(y.data(), slope.data());
    circuit.capacities(y.data(), C.data());
    stamped = circuit.linearise(y.data(), f_at_once.data());
    ASSERT_EQ(f, f_at_once);
    ASSERT_TRUE(std::equal(J.begin(), J.end(), stamped)) << trial;
    circuit.rates_and_outflow(y.data(), f_at_once.data(), slope_at_once.data(), C_at_once.data());
    ASSERT_EQ(f, f_at_once);
    ASSERT_EQ(slope, slope_at_once);
    ASSERT_EQ(C, C_at_once);
  }
}

TEST(HydraulicJacobian, at_once_with_the_rates_is_the_same_to_the_bit) {
  expect_same_bits_at_once(crane_circuit(), 3);
  expect_same_bits_at_once(bench_circuit(), 4);
  expect_same_bits_at_once(divider_circuit(), 5);
}

TEST(HydraulicJacobian, test_circuits_hold_every_component_type) {
  const HydraulicsDef circuits[] = {crane_circuit(), bench_circuit(), divider_circuit()};
  for (const ComponentType& type : component_types()) {
    bool is_present = false;
    for (const HydraulicsDef& circuit : circuits) {
      for (const auto& component : circuit.components) is_present = is_present || component->type_name() == type.name;
    }
    EXPECT_TRUE(is_present) << type.name;
  }
}

}  // namespace jacobian_test
}  // namespace slew::hydraulics::test
