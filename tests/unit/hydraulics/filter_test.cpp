// SPDX-License-Identifier: Apache-2.0
// The filter at numbers worked out by hand: 60 l/min through the clean element at 0.5 bar, bypass 120 l/min at 5 bar.
#include "hydraulics/components/filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "hydraulics/circuit_integrator.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace slew::hydraulics::test {
namespace filter_test {

struct Flows {
  double all, bypass;  // l/min
};

Flows flows_at(double drop_bar, double clogging, double bypass_flow) {
  HydraulicsDef def;
  def.orifice_transition = 10;
  add_tank(def, "In", (1 + drop_bar) * kBar), add_tank(def, "Out", 1 * kBar);
  FilterDef& filter = add<FilterDef>(def, "Filter");
  filter.port_1 = "In", filter.port_2 = "Out", filter.nominal_flow = 60 * kLitrePerMinute;
  filter.bypass.nominal_flow = bypass_flow * kLitrePerMinute;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  EXPECT_EQ(circuit.set_parameter(circuit.find_parameter("Filter.clogging"), clogging), ParameterResult::ok);
  std::vector<double> values(circuit.variables().size());
  circuit.read_variables(integrator.state().data(), values);
  const std::size_t first = values.size() - 3;
  EXPECT_EQ(circuit.variables()[first].name, "Filter.flow");
  EXPECT_NEAR(values[first + 2], drop_bar * kBar, 1e-6);
  return {values[first] / kLitrePerMinute, values[first + 1] / kLitrePerMinute};
}

TEST(Filter, passes_oil_in_proportion_to_the_drop_and_to_what_is_not_clogged) {
  EXPECT_NEAR(flows_at(0.5, 0, 120).all, 60, 1e-9);
  EXPECT_NEAR(flows_at(0.25, 0, 120).all, 30, 1e-9);
  EXPECT_NEAR(flows_at(1, 0.75, 120).all, 30, 1e-9);
  EXPECT_NEAR(flows_at(-0.5, 0.5, 120).all, -30, 1e-9);
}

// Open from 3 bar on: K root(drop) with 120 l/min at 5 bar.
TEST(Filter, its_bypass_takes_the_flow_of_a_blocked_element) {
  EXPECT_NEAR(flows_at(2, 1, 120).all, 0, 1e-9);
  const Flows open = flows_at(4, 1, 120);
  EXPECT_NEAR(open.all, 120 * std::sqrt(4.0 / 5), 1e-3);
  EXPECT_NEAR(open.bypass, open.all, 1e-12);
  EXPECT_NEAR(flows_at(4, 0.9, 120).all, 120 * std::sqrt(4.0 / 5) + 48, 1e-3);
}

TEST(Filter, without_a_bypass_a_blocked_element_stops_the_flow) {
  EXPECT_EQ(flows_at(50, 1, 0).all, 0);
  EXPECT_EQ(flows_at(-50, 1, 120).all, 0);
}

TEST(Filter, a_bypass_that_is_not_open_at_its_drop_is_refused) {
  HydraulicsDef def;
  add_tank(def, "In"), add_tank(def, "Out");
  FilterDef& filter = add<FilterDef>(def, "Filter");
  filter.port_1 = "In", filter.port_2 = "Out", filter.nominal_flow = 1e-3;
  filter.bypass.nominal_flow = 1e-3, filter.bypass.nominal_pressure_drop = 2.6 * kBar;
  Problems errors, warnings;
  validate(def, errors, warnings);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_EQ(errors[0].path, "Filter.bypass_pressure_drop");
  EXPECT_EQ(errors[0].what, "at this drop the bypass is not fully open: it is from 3 bar on");
}

}  // namespace filter_test
}  // namespace slew::hydraulics::test
