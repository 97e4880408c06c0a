// SPDX-License-Identifier: Apache-2.0
// Oil temperature: properties over the temperature, heat of every component, what is refused at load.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "core/state_bytes.h"
#include "hydraulics/circuit_integrator.h"
#include "hydraulics/oil_properties.h"
#include "tests/properties/hydraulics/bench_circuit.h"

namespace slew::hydraulics::test {
namespace oil_temperature_test {

constexpr double kZero = 273.15;  // K

void add_temperatures(HydraulicsDef& def) {
  def.oil_temperature = OilTemperature::by_volume;
  def.hot_viscosity = 6.8e-6;
}

double value(Circuit& circuit, const CircuitIntegrator& integrator, const std::string& name) {
  std::vector<double> values(circuit.variables().size());
  circuit.read_variables(integrator.state().data(), values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (circuit.variables()[i].name == name) return values[i];
  }
  ADD_FAILURE() << "no variable " << name;
  return 0;
}

TEST(OilTemperature, properties_pass_through_both_points_and_are_held_beyond_the_range) {
  HydraulicsDef def;
  add_temperatures(def);
  def.hot_density = 830, def.hot_bulk_modulus = 1.1e9;
  const OilPropertyLaw law(def);
  const OilProperties cold = law.at(40 + kZero), hot = law.at(100 + kZero), middle = law.at(70 + kZero);
  EXPECT_NEAR(cold.viscosity, 46e-6, 1e-12 * 46e-6);
  EXPECT_NEAR(hot.viscosity, 6.8e-6, 1e-12 * 6.8e-6);
  EXPECT_EQ(cold.density, 870);
  EXPECT_NEAR(hot.density, 830, 1e-9);
  EXPECT_NEAR(middle.density, 850, 1e-9);
  EXPECT_EQ(cold.bulk_modulus, 1.5e9);
  EXPECT_NEAR(middle.bulk_modulus, 1.3e9, 1e-3);
  EXPECT_EQ(law.at(500).viscosity, law.at(150 + kZero).viscosity);
  EXPECT_EQ(law.at(100).density, law.at(-40 + kZero).density);
}

// Two mineral oils at 30, 60 and 100 degC [mPa s]: Stachowiak and Batchelor 2005, table 2.3, after Cameron. The law
// through the outer points meets the middle one within 4 %; straight lines of lg nu over T would be 10 % off.
TEST(OilTemperature, viscosity_between_the_points_is_that_of_published_oils) {
  for (const auto& [mu_30, mu_60, mu_100] : {std::array{122.0, 26.3, 7.3}, std::array{171.0, 31.0, 7.5}}) {
    HydraulicsDef def;
    add_temperatures(def);
    def.reference_temperature = 30 + kZero, def.oil_density = 877, def.hot_density = 832;
    def.oil_viscosity = 1e-3 * mu_30 / 877, def.hot_viscosity = 1e-3 * mu_100 / 832;
    const OilProperties oil = OilPropertyLaw(def).at(60 + kZero);
    EXPECT_NEAR(oil.viscosity * oil.density, 1e-3 * mu_60, 0.04 * 1e-3 * mu_60);
    const double straight = mu_30 * std::pow(mu_100 / mu_30, 30.0 / 70);
    EXPECT_GT(straight, 1.1 * mu_60);
  }
}

TEST(OilTemperature, without_stated_values_density_and_modulus_fall_as_those_of_mineral_oils) {
  HydraulicsDef def;
  add_temperatures(def);
  def.oil_density = 900, def.oil_bulk_modulus = 1.6e9;
  const OilProperties oil = OilPropertyLaw(def).at(90 + kZero);
  EXPECT_NEAR(oil.density, 900 * (1 - 7e-4 * 50), 1e-9);
  EXPECT_NEAR(oil.bulk_modulus, 1.6e9 * (1 - 4e-3 * 50), 1e-3);
}

// Leaks and laminar passages at 80 degC carry (rho nu)_40/(rho nu)_80 of their flow at 40 degC.
TEST(OilTemperature, laminar_flows_grow_as_the_viscosity_falls) {
  HydraulicsDef def;
  add_temperatures(def);
  add_tank(def, "P", 101e5), add_tank(def, "T", 1e5);
  LaminarRestrictionDef& gap = add<LaminarRestrictionDef>(def, "Gap");
  gap.port_1 = "P", gap.port_2 = "T", gap.diameter = 1e-3, gap.length = 0.5;
  FilterDef& filter = add<FilterDef>(def, "Filter");
  filter.port_1 = "P", filter.port_2 = "T", filter.nominal_flow = 1e-5;
  PumpDef& pump = add<PumpDef>(def, "Pump");
  pump.port_a = "P", pump.port_b = "T", pump.speed = 0, pump.displacement = 1e-5, pump.leak_flow = 1e-5;
  SpoolValveDef& valve = add<SpoolValveDef>(def, "Valve");
  valve.port_p = "P", valve.port_a = "T", valve.port_b = "T", valve.port_t = "T", valve.leak_flow = 1e-6;
  const OilPropertyLaw law(def);
  const OilProperties cold = law.at(40 + kZero), warm = law.at(80 + kZero);
  const double ratio = cold.viscosity * cold.density / (warm.viscosity * warm.density);
  EXPECT_GT(ratio, 3);
  const auto flows = [&](double T) {
    def.start_temperature = T + kZero;
    Circuit circuit(def);
    CircuitIntegrator integrator(circuit, def);
    std::vector<double> Q;
    for (const char* name : {"Gap.flow", "Filter.flow", "Pump.flow", "Valve.flow_pa"}) {
      Q.push_back(value(circuit, integrator, name));
    }
    return Q;
  };
  const std::vector<double> at_40 = flows(40), at_80 = flows(80);
  for (std::size_t k = 0; k < at_40.size(); ++k) {
    EXPECT_NEAR(at_80[k] / at_40[k], ratio, 1e-9 * ratio) << k;
  }
}

TEST(OilTemperature, an_orifice_passes_more_oil_that_is_lighter) {
  HydraulicsDef def;
  add_temperatures(def);
  add_tank(def, "P", 101e5), add_tank(def, "T", 1e5);
  OrificeDef& orifice = add<OrificeDef>(def, "Orifice");
  orifice.port_1 = "P", orifice.port_2 = "T", orifice.diameter = 1e-3;
  const auto flow = [&](double T) {
    def.start_temperature = T + kZero;
    Circuit circuit(def);
    CircuitIntegrator integrator(circuit, def);
    return value(circuit, integrator, "Orifice.flow");
  };
  EXPECT_NEAR(flow(100) / flow(40), std::sqrt(1 / (1 - 7e-4 * 60)), 1e-9);
}

// A closed volume of 1 l with 10 % of its content in a soft hose: C' - C = V (1/B(T) - 1/B_1).
TEST(OilTemperature, the_capacity_of_a_volume_follows_the_bulk_modulus) {
  HydraulicsDef def;
  add_temperatures(def);
  add_volume(def, "P", 100e5).rigid_volume = 9e-4;
  add_hose(def, "Hose", "P", 1e-4 / (0.25 * std::numbers::pi * 1e-4), 0.01);
  static_cast<HoseDef&>(*def.components.back()).bulk_modulus = 6e4;
  const auto capacity = [&](double T) {
    def.start_temperature = T + kZero;
    Circuit circuit(def);
    const double y = 100e5;
    double C = 0;
    circuit.capacities(&y, &C);
    return C;
  };
  const double offset = 1 / (1.5e9 * (1 - 4e-3 * 50)) - 1 / 1.5e9;
  EXPECT_NEAR(capacity(90) - capacity(40), 1e-3 * offset, 1e-9 * 1e-3 * offset);
}

// All work that a component takes out of the oil, or puts in by a shaft, is heat: at random states of a circuit of
// nearly all types the heat of the volumes is  sum over components of (P_shaft - sum_i p_i Q_i).
TEST(OilTemperature, the_heat_of_a_circuit_is_the_work_that_its_components_lose) {
  HydraulicsDef def = bench_circuit();
  add_temperatures(def);
  std::erase_if(def.components, [](const auto& component) {
    return component->type_name() == "accumulator" || component->type_name() == "pressure_source";
  });
  Circuit circuit(def);
  const auto n = static_cast<std::size_t>(circuit.state_count());
  const auto volumes = static_cast<std::size_t>(circuit.volume_count());
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<double> y(n), f(n), values(circuit.variables().size());
  const auto read = [&](const std::string& name) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (circuit.variables()[i].name == name) return values[i];
    }
    return 0.0;
  };
  for (int trial = 0; trial < 300; ++trial) {
    for (std::size_t i = 0; i < n; ++i) y[i] = i < volumes ? 1e5 + 3e7 * unit(random) : unit(random);
    for (int j = 0; j < circuit.actuator_count(); ++j) {
      // m/s, or rad/s of motors, which have no ends
      const bool is_motor = std::isinf(circuit.actuators()[static_cast<std::size_t>(j)].line_force.maximum_stroke);
      y[static_cast<std::size_t>(circuit.speed(j))] = (is_motor ? 400 : 0.4) * (unit(random) - 0.5);
    }
    for (std::size_t i = 0; i < volumes; ++i) {
      if (circuit.is_fixed(static_cast<int>(i))) y[i] = 1e5;
    }
    circuit.begin_heat(y.data());
    circuit.add_heat(1e-3, y.data());
    circuit.end_heat(1e-3, y.data());
    circuit.read_variables(y.data(), values);
    double heat = 0, lost = 0, size = 0;
    for (std::size_t i = 0; i < volumes; ++i) heat += read(circuit.volume_name(static_cast<int>(i)) + ".heat");
    circuit.rates(y.data(), f.data());
    for (std::size_t k = 0; k < def.components.size(); ++k) {
      std::fill(f.begin(), f.end(), 0.0);
      circuit.add_rates_of(k, y.data(), f.data());
      double work = 0;
      for (std::size_t i = 0; i < volumes; ++i) work -= y[i] * f[i];
      const std::string_view type = def.components[k]->type_name();
      if (type == "pump" || type == "ls_pump" || type == "flow_source")
        work += read(def.components[k]->name + ".power");
      lost += work, size += std::fabs(work);
    }
    // pistons and motors take work too
    std::vector<double> F(static_cast<std::size_t>(circuit.actuator_count()));
    circuit.pressure_forces(y.data(), F.data());
    for (int j = 0; j < circuit.actuator_count(); ++j) {
      const Actuator& actuator = circuit.actuators()[static_cast<std::size_t>(j)];
      const double work = (F[static_cast<std::size_t>(j)] - actuator.brake_at(y.data())) *
                          y[static_cast<std::size_t>(circuit.speed(j))];
      lost -= work;
    }
    // the properties have changed with the temperatures: leaks within 1e-3
    EXPECT_NEAR(heat, lost, 1e-3 * size) << trial;
    circuit.start_heat(y.data());
  }
}

TEST(OilTemperature, friction_of_an_actuator_heats_both_sides) {
  HydraulicsDef def;
  add_temperatures(def);
  add_volume(def, "A", 50e5).rigid_volume = 1e-3, add_volume(def, "B", 50e5).rigid_volume = 1e-3;
  DoubleRodCylinderDef& cylinder = add<DoubleRodCylinderDef>(def, "Cylinder");
  cylinder.common.force = "Force", cylinder.common.port_a = "A", cylinder.common.port_b = "B";
  cylinder.common.piston_diameter = 0.1, cylinder.rod_diameter = 0.05, cylinder.common.chamber_length = 1;
  cylinder.common.maximum_stroke = 1;
  Circuit circuit(def);
  std::vector<double> y{50e5, 50e5, 0.5, 0.2};
  circuit.set_friction(0, 1000);
  circuit.begin_heat(y.data()), circuit.add_heat(0.01, y.data()), circuit.end_heat(0.01, y.data());
  std::vector<double> values(circuit.variables().size());
  circuit.read_variables(y.data(), values);
  const double V = 1e-3 + 0.5 * circuit.actuators()[0].area_a;
  for (const double T : circuit.temperatures()) EXPECT_NEAR(T - 313.15, 1 / (870.0 * 1900 * V), 1e-9);
}

TEST(OilTemperature, a_saved_state_continues_with_the_same_bits) {
  HydraulicsDef def = bench_circuit();
  add_temperatures(def);
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  const std::vector<double> x(static_cast<std::size_t>(circuit.actuator_count()), 0.4), zero(x.size(), 0.0);
  integrator.start(x, zero, zero);
  const HeldSpeed held(x.size());
  for (int k = 0; k < 50; ++k) integrator.step(1e-3, held);
  std::vector<std::byte> bytes;
  StateWriter writer(bytes, {1, 2});
  integrator.save(writer);
  writer.finish();
  Circuit other_circuit(def);
  CircuitIntegrator other(other_circuit, def);
  StateReader reader(bytes, {1, 2});
  other.load(reader);
  ASSERT_TRUE(reader.finish("circuit").is_ok());
  for (int k = 0; k < 50; ++k) integrator.step(1e-3, held), other.step(1e-3, held);
  StateHash a, b;
  integrator.add_to(a), other.add_to(b);
  EXPECT_EQ(a.digest(), b.digest());
  // a changed temperature changes the hash
  std::vector<double> T(circuit.temperatures().begin(), circuit.temperatures().end());
  T[0] = std::nextafter(T[0], 1e3);
  circuit.set_temperatures(T, integrator.state().data());
  StateHash changed;
  integrator.add_to(changed);
  EXPECT_NE(a.digest(), changed.digest());
}

TEST(OilTemperature, oil_beyond_the_range_of_its_properties_is_flagged_and_named) {
  HydraulicsDef def;
  add_temperatures(def);
  add_volume(def, "Cold").rigid_volume = 1e-3, add_volume(def, "Hot").rigid_volume = 1e-6;
  HeatLossDef& heater = add<HeatLossDef>(def, "Heater");
  heater.port_1 = "Hot", heater.conductance = 1000, heater.surroundings_temperature = 500;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start({}, {}, {});
  EXPECT_FALSE(integrator.step(1e-3, HeldSpeed(0)).has(StepFlag::beyond_oil_law));
  StepReport report;
  for (int k = 0; k < 50; ++k) report = integrator.step(1e-3, HeldSpeed(0));
  EXPECT_TRUE(report.has(StepFlag::beyond_oil_law));
  EXPECT_EQ(report.offender, 1);
}

std::string what_at(const HydraulicsDef& def, const std::string& path, bool is_warning = false) {
  Problems errors, warnings;
  validate(def, errors, warnings);
  for (const Problem& problem : is_warning ? warnings : errors) {
    if (problem.path == path) return problem.what;
  }
  return {};
}

TEST(OilTemperature, impossible_properties_are_refused) {
  HydraulicsDef def = bench_circuit();
  def.oil_temperature = OilTemperature::by_volume;
  EXPECT_EQ(what_at(def, "hydraulics.hot_viscosity"), "the viscosity at hot_temperature is not stated");
  def.hot_viscosity = 50e-6;
  EXPECT_EQ(what_at(def, "hydraulics.hot_viscosity"), "5e-05 m2/s is not between 1 mm2/s and oil_viscosity");
  def.hot_viscosity = 7e-6;
  EXPECT_EQ(what_at(def, "hydraulics.hot_viscosity"), "");
  def.hot_temperature = 310;
  EXPECT_EQ(what_at(def, "hydraulics.hot_temperature"), "310 K is not above reference_temperature");
  def.hot_temperature = 373.15, def.hot_bulk_modulus = 1e8;
  EXPECT_NE(what_at(def, "hydraulics.hot_bulk_modulus").find("falls below a tenth"), std::string::npos);
  def.hot_bulk_modulus = 0, def.hot_density = 100;
  EXPECT_NE(what_at(def, "hydraulics.hot_density").find("falls below a tenth"), std::string::npos);
}

TEST(OilTemperature, what_has_no_effect_is_warned_of) {
  HydraulicsDef def = bench_circuit();
  EXPECT_EQ(what_at(def, "Cooler", true), "the oil has one temperature, so it cools nothing and is a restriction");
  EXPECT_EQ(what_at(def, "Wall", true), "the oil has one temperature, so it has no effect");
  EXPECT_EQ(what_at(def, "Vol_T.rigid_volume", true), "");
  add_temperatures(def);
  EXPECT_EQ(what_at(def, "Cooler", true), "");
  EXPECT_NE(what_at(def, "Vol_T.rigid_volume", true).find("keeps start_temperature"), std::string::npos);
}

}  // namespace oil_temperature_test
}  // namespace slew::hydraulics::test
