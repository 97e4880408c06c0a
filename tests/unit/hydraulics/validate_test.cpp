// SPDX-License-Identifier: Apache-2.0
// Everything that is wrong with a circuit is found at load and named.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tests/properties/hydraulics/bench_circuit.h"

namespace slew::hydraulics::test {
namespace validate_test {

struct Findings {
  Problems errors, warnings;
};

Findings findings(const HydraulicsDef& def) {
  Findings found;
  validate(def, found.errors, found.warnings);
  return found;
}

// Empty when there is no problem at the path.
std::string what_at(const Problems& problems, const std::string& path) {
  for (const Problem& problem : problems) {
    if (problem.path == path) return problem.what;
  }
  return {};
}

std::string listing(const Problems& problems) {
  std::string text;
  for (const Problem& problem : problems) text += problem.path + ": " + problem.what + "\n";
  return text;
}

template <typename Def>
Def& component(HydraulicsDef& def, const std::string& name) {
  for (auto& c : def.components) {
    if (c->name == name) return dynamic_cast<Def&>(*c);
  }
  throw std::runtime_error("no component " + name);
}

TEST(HydraulicsValidation, the_test_circuits_are_sound) {
  EXPECT_TRUE(findings(crane_circuit()).errors.empty()) << listing(findings(crane_circuit()).errors);
  EXPECT_TRUE(findings(bench_circuit()).errors.empty()) << listing(findings(bench_circuit()).errors);
}

// Sets every numeric field of the element to NaN and beyond each end of its range, one at a time.
void expect_ranges_are_checked(const HydraulicsDef& def, const std::string& element, std::span<const Field> fields,
                               void* address) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const Field& row : fields) {
    if (row.type != FieldType::number) continue;
    double& value = *static_cast<double*>(row.member(address));
    const double good = value;
    std::vector<double> bad{kNan};
    if (std::isfinite(row.range.min)) bad.push_back(row.range.min_is_open ? row.range.min : row.range.min - 1e-3);
    if (std::isfinite(row.range.max)) bad.push_back(row.range.max_is_open ? row.range.max : row.range.max + 1e-3);
    for (const double wrong : bad) {
      value = wrong;
      const std::string path = element + "." + std::string(row.key);
      EXPECT_NE(what_at(findings(def).errors, path).find("is out of range"), std::string::npos)
          << path << " = " << wrong;
    }
    value = good;
  }
}

TEST(HydraulicsValidation, every_number_of_every_component_is_checked_against_its_range) {
  for (const auto make : {crane_circuit, bench_circuit}) {
    HydraulicsDef def = make();
    for (auto& c : def.components) {
      expect_ranges_are_checked(def, c->name, find_component_type(c->type_name())->fields, c->address());
    }
  }
}

TEST(HydraulicsValidation, every_number_of_volumes_and_of_the_circuit_is_checked_against_its_range) {
  HydraulicsDef def = crane_circuit();
  expect_ranges_are_checked(def, "hydraulics", kHydraulicsFields, &def);
  expect_ranges_are_checked(def, def.volumes[0].name, kVolumeFields, &def.volumes[0]);
  def.substep_budget = 0;
  EXPECT_NE(what_at(findings(def).errors, "hydraulics.substep_budget"), "");
}

TEST(HydraulicsValidation, every_missing_or_dangling_name_is_reported) {
  for (const auto make : {crane_circuit, bench_circuit}) {
    HydraulicsDef def = make();
    for (auto& c : def.components) {
      for (const Field& row : find_component_type(c->type_name())->fields) {
        if (row.type != FieldType::text || row.reference.empty()) continue;
        std::string& name = *static_cast<std::string*>(row.member(c->address()));
        const std::string good = name, path = c->name + "." + std::string(row.key);
        if (row.reference != "force") {
          name = "Nowhere";
          EXPECT_EQ(what_at(findings(def).errors, path), "there is no " + std::string(row.reference) + " 'Nowhere'");
        }
        name.clear();
        if (row.presence == Presence::required) {
          EXPECT_EQ(what_at(findings(def).errors, path), "the name is missing");
        }
        name = good;
      }
    }
  }
}

TEST(HydraulicsValidation, rod_thicker_than_the_piston_is_refused) {
  HydraulicsDef def = crane_circuit();
  component<DoubleActingCylinderDef>(def, "Cyl_Lift").rod_diameter = 0.2;
  EXPECT_EQ(what_at(findings(def).errors, "Cyl_Lift.rod_diameter"), "the rod is not thinner than the piston");
}

TEST(HydraulicsValidation, swapped_stroke_limits_are_refused) {
  HydraulicsDef def = crane_circuit();
  DoubleActingCylinderDef& lift = component<DoubleActingCylinderDef>(def, "Cyl_Lift");
  std::swap(lift.common.minimum_stroke, lift.common.maximum_stroke);
  EXPECT_EQ(what_at(findings(def).errors, "Cyl_Lift.maximum_stroke"),
            "the stroke limits are swapped: minimum 1.05 m, maximum 0.7 m");
}

TEST(HydraulicsValidation, a_chamber_that_closes_within_the_stops_compression_is_refused) {
  HydraulicsDef def = crane_circuit();
  component<DoubleActingCylinderDef>(def, "Cyl_Lift").common.dead_volume = 0;
  component<DoubleActingCylinderDef>(def, "Cyl_Lift").common.maximum_stroke = 1.06;
  component<SlewCylinderDef>(def, "SlewCyl_CraneSlew").common.minimum_stroke = 0.001;
  const Problems errors = findings(def).errors;
  EXPECT_NE(what_at(errors, "Cyl_Lift.maximum_stroke").find("chamber B is not positive"), std::string::npos);
  EXPECT_NE(what_at(errors, "SlewCyl_CraneSlew.minimum_stroke").find("chamber A is not positive"), std::string::npos);
}

TEST(HydraulicsValidation, a_chamber_not_longer_than_its_piston_is_refused) {
  HydraulicsDef def = crane_circuit();
  component<SlewCylinderDef>(def, "SlewCyl_CraneSlew").common.piston_length = 1.3;
  EXPECT_EQ(what_at(findings(def).errors, "SlewCyl_CraneSlew.chamber_length"),
            "the chamber is not longer than the piston");
}

TEST(HydraulicsValidation, both_ports_on_one_volume_are_refused) {
  HydraulicsDef def = crane_circuit();
  component<DoubleActingCylinderDef>(def, "Cyl_Jib").common.port_b = "Vol_JibCyl_A";
  component<L90lsValveDef>(def, "L90Lift").port_b = "Vol_LiftCyl_A";
  const Problems errors = findings(def).errors;
  EXPECT_NE(what_at(errors, "Cyl_Jib.port_b"), "");
  EXPECT_NE(what_at(errors, "L90Lift.port_b"), "");
}

TEST(HydraulicsValidation, a_pump_or_a_valve_without_a_tank_is_refused) {
  HydraulicsDef def = crane_circuit();
  component<LsPumpDef>(def, "MainPump").port_b = "Vol_JibCyl_A";
  component<L90lsValveDef>(def, "L90Lift").port_t = "Vol_JibCyl_A";
  const Problems errors = findings(def).errors;
  EXPECT_NE(what_at(errors, "MainPump.port_b").find("the pump has no tank"), std::string::npos);
  EXPECT_NE(what_at(errors, "L90Lift.port_t").find("the valve has no tank"), std::string::npos);
}

TEST(HydraulicsValidation, a_volume_without_content_is_refused) {
  HydraulicsDef def = crane_circuit();
  add_volume(def, "Vol_Empty");
  EXPECT_NE(what_at(findings(def).errors, "Vol_Empty.rigid_volume").find("has no content"), std::string::npos);
  // one that stores nothing needs none
  def.volumes.back().quasi_static = true;
  EXPECT_EQ(what_at(findings(def).errors, "Vol_Empty.rigid_volume"), "");
}

TEST(HydraulicsValidation, a_name_used_twice_is_refused) {
  HydraulicsDef def = crane_circuit();
  add_volume(def, "Cyl_Lift").rigid_volume = 1e-3;
  EXPECT_EQ(what_at(findings(def).errors, "Cyl_Lift"), "the name is used twice");
}

TEST(HydraulicsValidation, two_cylinders_on_one_force_are_refused) {
  HydraulicsDef def = crane_circuit();
  component<DoubleActingCylinderDef>(def, "Cyl_Jib").common.force = "ForceT_Lift";
  EXPECT_EQ(what_at(findings(def).errors, "Cyl_Jib.force"), "'ForceT_Lift' is driven by another cylinder already");
}

TEST(HydraulicsValidation, load_sensing_chains_must_end_at_valves_without_a_loop) {
  HydraulicsDef def = crane_circuit();
  component<LsShuttleDef>(def, "LSPressure_Lift_Jib").port_1 = "LSPressure_MainPump";
  EXPECT_EQ(what_at(findings(def).errors, "LSPressure_Lift_Jib"), "the load-sensing chain returns to itself");
  component<LsShuttleDef>(def, "LSPressure_Lift_Jib").port_1 = "Cyl_Lift";
  EXPECT_EQ(what_at(findings(def).errors, "LSPressure_Lift_Jib.port_1"), "'Cyl_Lift' has no load-sensing port");
  component<LsShuttleDef>(def, "LSPressure_Lift_Jib").port_1 = "L90Jib";
  const Findings found = findings(def);
  EXPECT_TRUE(found.errors.empty());
  EXPECT_EQ(what_at(found.warnings, "L90Lift"), "no pump or shuttle takes its load-sensing pressure");
}

TEST(HydraulicsValidation, curves_must_increase_and_friction_must_brake) {
  HydraulicsDef def = crane_circuit();
  def.curves[0].points[3][0] = 0.01;
  EXPECT_NE(what_at(findings(def).errors, "Spline_CylinderFriction.points").find("does not increase"),
            std::string::npos);
  def = crane_circuit();
  def.curves[0].points.resize(1);
  EXPECT_EQ(what_at(findings(def).errors, "Spline_CylinderFriction.points"), "a curve needs at least two points");
  def = crane_circuit();
  def.curves[0].odd = false;
  EXPECT_EQ(what_at(findings(def).errors, "Cyl_Lift.friction_curve"),
            "the curve 'Spline_CylinderFriction' would drive the actuator");
  def = crane_circuit();
  def.curves[0].points[0] = {0, 0.1};
  EXPECT_EQ(what_at(findings(def).errors, "Spline_CylinderFriction.points"),
            "an odd curve does not begin at zero and would jump there");
  def.curves[0].points = {{0.001, 1}, {1, 0.8}};
  EXPECT_EQ(what_at(findings(def).errors, "Spline_CylinderFriction.points"),
            "an odd curve does not begin at zero and would jump there");
  def.curves[0].points[0] = {-1, 0.1};
  EXPECT_EQ(what_at(findings(def).errors, "Spline_CylinderFriction.points"),
            "an odd curve has points at negative arguments");
  def.curves[0].points[0] = {0, std::numeric_limits<double>::quiet_NaN()};
  EXPECT_EQ(what_at(findings(def).errors, "Spline_CylinderFriction.points"), "point 1 is not finite");
}

// typed over mm/s or rev/min, as in a data sheet
TEST(HydraulicsValidation, curves_beyond_every_speed_are_warnings) {
  HydraulicsDef def = crane_circuit();
  EXPECT_EQ(what_at(findings(def).warnings, "Cyl_Lift.friction_curve"), "");
  for (auto& point : def.curves[0].points) point[0] *= 1000;
  EXPECT_NE(what_at(findings(def).warnings, "Cyl_Lift.friction_curve").find("an actuator does not exceed 20 m/s"),
            std::string::npos);
  HydraulicsDef bench = bench_circuit();
  EXPECT_EQ(what_at(findings(bench).warnings, "Engine.torque_curve"), "");
  for (CurveDef& curve : bench.curves) {
    if (curve.name != "Full_Load") continue;
    for (auto& point : curve.points) point[0] *= 30 / 3.14159;
  }
  EXPECT_NE(what_at(findings(bench).warnings, "Engine.torque_curve").find("its first torque holds there"),
            std::string::npos)
      << listing(findings(bench).warnings);
}

// the start takes another pressure in the place of the stated one
TEST(HydraulicsValidation, start_pressures_that_an_equilibrium_start_replaces_are_warnings) {
  const auto what = [](double pump_line, double chamber, StartState start) {
    HydraulicsDef def = crane_circuit();
    def.start = start;
    for (VolumeDef& volume : def.volumes) {
      if (volume.name == "Vol_MainPump") volume.initial_pressure = pump_line;
      if (volume.name == "Vol_LiftCyl_A") volume.initial_pressure = chamber;
    }
    const Problems warnings = findings(def).warnings;
    return what_at(warnings, "Vol_MainPump.initial_pressure") + "|" +
           what_at(warnings, "Vol_LiftCyl_A.initial_pressure");
  };
  EXPECT_EQ(
      what(90e5, 40e5, StartState::equilibrium),
      "an equilibrium start does not read it: the volume begins at hydraulics.start_pump_pressure, 26 bar|"
      "an equilibrium start does not read it: the volume begins at the pressure by which 'Cyl_Lift' holds its load");
  EXPECT_EQ(what(1e5, 1e5, StartState::equilibrium), "|");
  EXPECT_EQ(what(26e5, 1e5, StartState::equilibrium), "|");
  EXPECT_EQ(what(90e5, 40e5, StartState::table13), "|");
}

TEST(HydraulicsValidation, quasi_static_volumes_are_refused_by_solvers_without_algebraic_rows) {
  HydraulicsDef def = crane_circuit();
  def.volumes[0].quasi_static = true;
  for (const Solver solver : {Solver::rodas3, Solver::implicit_euler}) {
    def.solver = solver;
    EXPECT_TRUE(findings(def).errors.empty()) << listing(findings(def).errors);
  }
  def.solver = Solver::rk4;
  EXPECT_EQ(what_at(findings(def).errors, "Vol_MainPump.quasi_static"), "the solver rk4 has no algebraic pressures");
  def.solver = Solver::cvode;
  EXPECT_EQ(what_at(findings(def).errors, "Vol_MainPump.quasi_static"), "the solver cvode has no algebraic pressures");
  def.volumes[0].quasi_static = false;
  EXPECT_TRUE(findings(def).errors.empty());
  def.quasi_static_above = 1e5;
  EXPECT_EQ(what_at(findings(def).errors, "hydraulics.quasi_static_above"),
            "the solver cvode has no algebraic pressures");
}

TEST(HydraulicsValidation, quasi_static_chambers_and_tanks_are_refused) {
  HydraulicsDef def = crane_circuit();
  for (VolumeDef& volume : def.volumes) volume.quasi_static = true;
  const Problems errors = findings(def).errors;
  EXPECT_EQ(what_at(errors, "Vol_Tank.quasi_static"), "the volume is fixed already");
  EXPECT_EQ(what_at(errors, "Vol_JibCyl_A.quasi_static"),
            "a chamber of 'Cyl_Jib' is part of the volume: without storage it would be rigid");
  EXPECT_EQ(what_at(errors, "Vol_MainPump.quasi_static"), "");
}

// ended with code 5 and advice that does not help
TEST(HydraulicsValidation, quasi_static_volumes_without_an_outlet_are_refused) {
  HydraulicsDef def = crane_circuit();
  add_volume(def, "Dead").quasi_static = true;
  add_volume(def, "End").quasi_static = true;
  auto orifice = std::make_unique<OrificeDef>();
  orifice->name = "Between";
  orifice->port_1 = "Dead";
  orifice->port_2 = "End";
  def.components.push_back(std::move(orifice));
  for (const char* volume : {"Dead", "End"}) {
    const std::string what = what_at(findings(def).errors, std::string(volume) + ".quasi_static");
    EXPECT_NE(what.find("nothing determines its pressure"), std::string::npos) << what;
  }
  // with an outlet the one is determined, and the other while the orifice is open
  static_cast<OrificeDef&>(*def.components.back()).port_1 = "Vol_MainPump";
  Findings found = findings(def);
  EXPECT_EQ(what_at(found.errors, "End.quasi_static"), "");
  EXPECT_NE(what_at(found.warnings, "End.quasi_static").find("'Between' alone leads to the volume"), std::string::npos);
  EXPECT_EQ(what_at(found.errors, "Dead.quasi_static").empty(), false) << "nothing leads to it";
}

TEST(HydraulicsValidation, a_double_rod_thicker_than_its_piston_is_refused) {
  HydraulicsDef def = bench_circuit();
  component<DoubleRodCylinderDef>(def, "Cylinder").rod_diameter = 0.2;
  EXPECT_EQ(what_at(findings(def).errors, "Cylinder.rod_diameter"), "the rod is not thinner than the piston");
}

TEST(HydraulicsValidation, start_pressures_below_the_floor_are_refused) {
  HydraulicsDef def = crane_circuit();
  def.pressure_floor = 6e5;
  const Problems errors = findings(def).errors;
  EXPECT_NE(what_at(errors, "hydraulics.start_return_pressure"), "");
  EXPECT_NE(what_at(errors, "Vol_MainPump.initial_pressure"), "");
}

// a number in another unit is a warning that names the unit
TEST(HydraulicsValidation, implausible_oil_is_a_warning_with_the_unit_that_was_meant) {
  const auto warning = [](double HydraulicsDef::*member, double value, const std::string& key) {
    HydraulicsDef def = bench_circuit();
    def.*member = value;
    const Problems warnings = findings(def).warnings;
    const auto found = std::find_if(warnings.begin(), warnings.end(),
                                    [&](const Problem& one) { return one.path == "hydraulics." + key; });
    return found == warnings.end() ? std::string() : found->what + "; expected " + found->expected;
  };
  const auto modulus = [&](double value) {
    return warning(&HydraulicsDef::oil_bulk_modulus, value, "oil_bulk_modulus");
  };
  EXPECT_EQ(modulus(15000),
            "15000 Pa is the bulk modulus of no hydraulic liquid (1e+08 to 1e+10 Pa); expected '15000 bar' if that was "
            "meant, the value with its unit");
  EXPECT_NE(modulus(1500).find("'1500 MPa'"), std::string::npos);
  EXPECT_NE(modulus(1).find("'1 GPa'"), std::string::npos);
  EXPECT_NE(modulus(217557).find("'217557 psi'"), std::string::npos);
  EXPECT_NE(modulus(1e15).find("expected a value with its unit, such as '1.5e+09 Pa'"), std::string::npos);
  for (const double sound : {1e8, 0.7e9, 1.5e9, 2.2e9, 1e10}) EXPECT_EQ(modulus(sound), "") << sound;
  const auto density = [&](double value) { return warning(&HydraulicsDef::oil_density, value, "oil_density"); };
  EXPECT_NE(density(0.87).find("'0.87 g/cm3'"), std::string::npos);
  EXPECT_NE(density(8.7e-7).find("'8.7e-07 kg/mm3'"), std::string::npos);
  EXPECT_NE(density(54.3).find("'54.3 lb/ft3'"), std::string::npos);
  EXPECT_NE(density(1e-3).find("is the density of no hydraulic liquid"), std::string::npos);
  for (const double sound : {700.0, 870.0, 1000.0, 1900.0}) EXPECT_EQ(density(sound), "") << sound;
  const auto viscosity = [&](double value) { return warning(&HydraulicsDef::oil_viscosity, value, "oil_viscosity"); };
  EXPECT_NE(viscosity(46).find("'46 cSt'"), std::string::npos);
  EXPECT_NE(viscosity(1e3).find("'1000 cSt'"), std::string::npos);
  EXPECT_NE(viscosity(0.46).find("'0.46 St'"), std::string::npos);
  EXPECT_NE(viscosity(0.04).find("'47.1 cSt' if 0.04 Pa s was meant: the dynamic viscosity by the density"),
            std::string::npos)
      << viscosity(0.04);
  for (const double sound : {1e-8, 1e-6, 46e-6, 0.01}) EXPECT_EQ(viscosity(sound), "") << sound;
  EXPECT_NE(warning(&HydraulicsDef::air_reference_pressure, 1, "air_reference_pressure").find("'1 bar'"),
            std::string::npos);
  // what nothing reads is not judged
  EXPECT_EQ(warning(&HydraulicsDef::oil_compressibility, 6.5e-5, "oil_compressibility"), "");
  EXPECT_EQ(warning(&HydraulicsDef::oil_specific_heat, 1.9, "oil_specific_heat"), "");
}

TEST(HydraulicsValidation, anti_cavitation_stated_at_a_drop_below_its_crack_pressure_is_refused) {
  HydraulicsDef def = crane_circuit();
  component<L90lsValveDef>(def, "L90Lift").anti_cavitation_pressure_drop = 1e4;
  EXPECT_NE(what_at(findings(def).errors, "L90Lift.anti_cavitation_pressure_drop"), "");
}

TEST(HydraulicsValidation, hose_walls_without_effect_and_valves_that_never_open_fully_are_warnings) {
  HydraulicsDef def = crane_circuit();
  component<L90lsValveDef>(def, "L90Lift").nominal_control_signal = 600;
  component<HoseDef>(def, "Hose_Lift_A").bulk_modulus = 8e9;
  const Findings found = findings(def);
  EXPECT_TRUE(found.errors.empty());
  EXPECT_EQ(what_at(found.warnings, "Hose_Lift_B.bulk_modulus"), "");  // the default, which the law caps too
  EXPECT_NE(what_at(found.warnings, "Hose_Lift_A.bulk_modulus").find("at its upper bound"), std::string::npos);
  EXPECT_EQ(what_at(found.warnings, "L90Lift.nominal_control_signal"), "the valve never opens fully");
  component<HoseDef>(def, "Hose_Lift_A").minimum_bulk_modulus = 6e8;
  EXPECT_NE(what_at(findings(def).errors, "Hose_Lift_A.minimum_bulk_modulus"), "");
}

// a pump on a block, and the connections of a test
HydraulicsDef pump_on_a_block() {
  HydraulicsDef def;
  add_volume(def, "Vol_P").rigid_volume = 1e-3;
  add_volume(def, "Vol_Q").rigid_volume = 1e-3;
  add_tank(def, "Vol_T");
  LsPumpDef& pump = add<LsPumpDef>(def, "Pump");
  pump.port_a = "Vol_P", pump.port_b = "Vol_T", pump.speed = 157, pump.displacement = 10e-6, pump.leak_flow = kLeak;
  return def;
}

OrificeDef& connect(HydraulicsDef& def, const char* from, const char* to) {
  OrificeDef& orifice = add<OrificeDef>(def, std::string("Orifice_") + from + to);
  orifice.port_1 = from, orifice.port_2 = to, orifice.diameter = 3e-3;
  return orifice;
}

void relieve(HydraulicsDef& def, const char* volume) {
  DirectReliefValveDef& relief = add<DirectReliefValveDef>(def, "Relief");
  relief.port_1 = volume, relief.port_2 = "Vol_T", relief.seat_diameter = 0.01, relief.crack_pressure = 200 * kBar;
  relief.spring_constant = 4e4;
}

TEST(PumpLines, without_relief_are_warned_about_with_the_pressure_that_ends_them) {
  HydraulicsDef def = pump_on_a_block();
  component<LsPumpDef>(def, "Pump").standby_pressure = 1000e5;
  const Findings found = findings(def);
  EXPECT_TRUE(found.errors.empty()) << listing(found.errors);
  EXPECT_NE(what_at(found.warnings, "Pump.port_a").find("'Vol_P' is closed off"), std::string::npos);
  EXPECT_NE(what_at(found.warnings, "Pump.port_a").find("1000 bar above tank"), std::string::npos);
}

TEST(PumpLines, are_relieved_through_what_is_always_open) {
  HydraulicsDef direct = pump_on_a_block();
  relieve(direct, "Vol_P");
  EXPECT_EQ(what_at(findings(direct).warnings, "Pump.port_a"), "");
  HydraulicsDef behind = pump_on_a_block();
  relieve(behind, "Vol_Q");
  EXPECT_NE(what_at(findings(behind).warnings, "Pump.port_a"), "");
  OrificeDef& orifice = connect(behind, "Vol_Q", "Vol_P");
  EXPECT_EQ(what_at(findings(behind).warnings, "Pump.port_a"), "");
  orifice.opening = 0;
  EXPECT_NE(what_at(findings(behind).warnings, "Pump.port_a"), "");
  HydraulicsDef to_tank = pump_on_a_block();
  connect(to_tank, "Vol_P", "Vol_T");
  EXPECT_EQ(what_at(findings(to_tank).warnings, "Pump.port_a"), "");
}

// the pump delivers 94 l/min; at 1000 bar 1 mm passes 15 of them, 3 mm 136
TEST(PumpLines, are_not_relieved_by_what_passes_less_than_the_pump_or_opens_too_late) {
  HydraulicsDef narrow = pump_on_a_block();
  OrificeDef& orifice = connect(narrow, "Vol_P", "Vol_T");
  orifice.diameter = 1e-3;
  EXPECT_NE(what_at(findings(narrow).warnings, "Pump.port_a"), "");
  HydraulicsDef bled = pump_on_a_block();
  BleedDef& bleed = add<BleedDef>(bled, "Bleed");
  bleed.port_1 = "Vol_P", bleed.port_2 = "Vol_T", bleed.nominal_flow = 2.0 / 60000, bleed.nominal_pressure_drop = 1e7;
  EXPECT_NE(what_at(findings(bled).warnings, "Pump.port_a"), "");
  bleed.nominal_flow = 30.0 / 60000;
  EXPECT_EQ(what_at(findings(bled).warnings, "Pump.port_a"), "");
  HydraulicsDef late = pump_on_a_block();
  relieve(late, "Vol_P");
  component<DirectReliefValveDef>(late, "Relief").crack_pressure = 2700 * kBar;
  EXPECT_NE(what_at(findings(late).warnings, "Pump.port_a"), "");
}

// a relief valve on Vol_Q, behind a component that passes the pump's flow
TEST(PumpLines, are_relieved_behind_a_filter_as_dirty_as_it_is) {
  HydraulicsDef def = pump_on_a_block();
  relieve(def, "Vol_Q");
  FilterDef& filter = add<FilterDef>(def, "Filter");
  filter.port_1 = "Vol_P", filter.port_2 = "Vol_Q", filter.nominal_flow = 100.0 / 60000;
  EXPECT_EQ(what_at(findings(def).warnings, "Pump.port_a"), "");
  std::swap(filter.port_1, filter.port_2);
  EXPECT_EQ(what_at(findings(def).warnings, "Pump.port_a"), "");
  filter.clogging = 1;
  EXPECT_NE(what_at(findings(def).warnings, "Pump.port_a"), "");
  filter.bypass.nominal_flow = 100.0 / 60000;  // in the other direction
  EXPECT_NE(what_at(findings(def).warnings, "Pump.port_a"), "");
  std::swap(filter.port_1, filter.port_2);
  EXPECT_EQ(what_at(findings(def).warnings, "Pump.port_a"), "");
}

TEST(PumpLines, are_relieved_behind_a_shuttle_valve) {
  for (const bool is_first : {true, false}) {
    HydraulicsDef def = pump_on_a_block();
    add_volume(def, "Vol_R").rigid_volume = 1e-3;
    relieve(def, "Vol_Q");
    ShuttleValveDef& shuttle = add<ShuttleValveDef>(def, "Shuttle");
    shuttle.port_1 = is_first ? "Vol_P" : "Vol_R", shuttle.port_2 = is_first ? "Vol_R" : "Vol_P";
    shuttle.port_3 = "Vol_Q", shuttle.nominal_flow = 100.0 / 60000;
    EXPECT_EQ(what_at(findings(def).warnings, "Pump.port_a"), "");
    shuttle.nominal_flow = 1.0 / 60000;
    EXPECT_NE(what_at(findings(def).warnings, "Pump.port_a"), "");
    // the outlet is no inlet
    shuttle.nominal_flow = 100.0 / 60000;
    std::swap(is_first ? shuttle.port_1 : shuttle.port_2, shuttle.port_3);
    EXPECT_NE(what_at(findings(def).warnings, "Pump.port_a"), "");
  }
}

ReliefValveDef& relieve_into(HydraulicsDef& def, const char* from, const char* to) {
  ReliefValveDef& relief = add<ReliefValveDef>(def, std::string("Relief_") + from + to);
  relief.port_1 = from, relief.port_2 = to, relief.nominal_flow = 100.0 / 60000;
  relief.setting_pressure = 200 * kBar;
  return relief;
}

TEST(PumpLines, are_relieved_by_a_valve_that_their_pressure_opens) {
  HydraulicsDef def = pump_on_a_block();
  ReliefValveDef& relief = relieve_into(def, "Vol_P", "Vol_T");
  EXPECT_EQ(what_at(findings(def).warnings, "Pump.port_a"), "");
  relief.port_3 = "Vol_Q";  // no oil reaches the pilot
  EXPECT_NE(what_at(findings(def).warnings, "Pump.port_a"), "");
  // a pilot needs no flow
  OrificeDef& pilot_line = connect(def, "Vol_P", "Vol_Q");
  pilot_line.diameter = 0.5e-3;
  EXPECT_EQ(what_at(findings(def).warnings, "Pump.port_a"), "");
  pilot_line.port_1 = "Vol_T";  // a tank holds its pressure
  EXPECT_NE(what_at(findings(def).warnings, "Pump.port_a"), "");
}

TEST(PumpLines, are_relieved_by_a_valve_whose_outlet_leads_to_a_tank) {
  HydraulicsDef def = pump_on_a_block();
  relieve_into(def, "Vol_P", "Vol_Q");
  EXPECT_NE(what_at(findings(def).warnings, "Pump.port_a"), "");
  OrificeDef& back = connect(def, "Vol_Q", "Vol_T");
  EXPECT_EQ(what_at(findings(def).warnings, "Pump.port_a"), "");
  back.diameter = 1e-3;
  EXPECT_NE(what_at(findings(def).warnings, "Pump.port_a"), "");
  relieve_into(def, "Vol_Q", "Vol_T");
  EXPECT_EQ(what_at(findings(def).warnings, "Pump.port_a"), "");
  // the pump's own inlet takes the oil, as in a closed loop
  HydraulicsDef loop = pump_on_a_block();
  relieve_into(loop, "Vol_P", "Vol_Q");
  component<LsPumpDef>(loop, "Pump").port_b = "Vol_Q";
  EXPECT_EQ(what_at(findings(loop).warnings, "Pump.port_a"), "");
}

template <typename Divider>
Divider& divide(HydraulicsDef& def) {
  add_volume(def, "Vol_R").rigid_volume = 1e-3;
  Divider& divider = add<Divider>(def, "Divider");
  divider.port_1 = "Vol_P", divider.port_2 = "Vol_Q", divider.port_3 = "Vol_R";
  relieve(def, "Vol_R");
  return divider;
}

// a branch that stands still stops the gears, and leaves the spool's other edge its least opening
TEST(PumpLines, are_relieved_behind_a_flow_divider_whose_branches_both_are) {
  HydraulicsDef gears = pump_on_a_block();
  GearFlowDividerDef& gear = divide<GearFlowDividerDef>(gears);
  gear.displacement_2 = gear.displacement_3 = 1e-6;
  EXPECT_NE(what_at(findings(gears).warnings, "Pump.port_a"), "");
  relieve_into(gears, "Vol_Q", "Vol_T");
  EXPECT_EQ(what_at(findings(gears).warnings, "Pump.port_a"), "");
  // at 1000 bar 0.5 0.02/sqrt(0.02^2 + 0.4) sqrt(200) = 0.224 of the nominal flow, for 94 l/min
  HydraulicsDef spool = pump_on_a_block();
  FlowDividerDef& divider = divide<FlowDividerDef>(spool);
  divider.nominal_flow = 400.0 / 60000;
  EXPECT_NE(what_at(findings(spool).warnings, "Pump.port_a"), "");
  divider.nominal_flow = 440.0 / 60000;
  EXPECT_EQ(what_at(findings(spool).warnings, "Pump.port_a"), "");
  divider.nominal_flow = 100.0 / 60000;
  relieve_into(spool, "Vol_Q", "Vol_T");
  EXPECT_EQ(what_at(findings(spool).warnings, "Pump.port_a"), "");
}

TEST(PumpLines, are_relieved_by_a_counterbalance_valve_at_its_setting) {
  HydraulicsDef def = pump_on_a_block();
  CounterbalanceValveDef& valve = add<CounterbalanceValveDef>(def, "Valve");
  valve.port_1 = "Vol_T", valve.port_2 = "Vol_P", valve.port_3 = "Vol_Q";
  valve.setting_pressure = 100 * kBar, valve.nominal_flow = 100.0 / 60000, valve.check.nominal_flow = 100.0 / 60000;
  EXPECT_EQ(what_at(findings(def).warnings, "Pump.port_a"), "");
  valve.setting_pressure = 2700 * kBar;
  EXPECT_NE(what_at(findings(def).warnings, "Pump.port_a"), "");
}

TEST(PumpLines, of_the_crane_have_their_relief_valve) {
  EXPECT_EQ(what_at(findings(crane_circuit()).warnings, "MainPump.port_a"), "");
}

// A pump of 30 l/min behind a relief valve, an accumulator behind a check valve.
HydraulicsDef charging_circuit(double setting, double precharge) {
  HydraulicsDef def;
  add_tank(def, "Tank", 1 * kBar);
  add_volume(def, "Line").rigid_volume = 1e-4, add_volume(def, "Store").rigid_volume = 1e-4;
  PumpDef& pump = add<PumpDef>(def, "Pump");
  pump.port_a = "Line", pump.port_b = "Tank", pump.speed = 157, pump.displacement = 3e-6;
  ReliefValveDef& relief = add<ReliefValveDef>(def, "Relief");
  relief.port_1 = "Line", relief.port_2 = "Tank", relief.nominal_flow = 1e-3, relief.setting_pressure = setting;
  CheckValveDef& check = add<CheckValveDef>(def, "Check");
  check.port_1 = "Line", check.port_2 = "Store", check.common.nominal_flow = 1e-3;
  AccumulatorDef& accumulator = add<AccumulatorDef>(def, "Accumulator");
  accumulator.port_1 = "Store", accumulator.gas_volume = 1e-3, accumulator.precharge_pressure = precharge;
  accumulator.nominal_flow = 1e-3;
  return def;
}

TEST(HydraulicsValidation, accumulators_that_no_line_fills_are_named_with_both_pressures) {
  const std::string path = "Accumulator.precharge_pressure";
  const auto warning = [&](const HydraulicsDef& def) {
    const Findings found = findings(def);
    EXPECT_TRUE(found.errors.empty()) << listing(found.errors);
    return what_at(found.warnings, path);
  };
  EXPECT_EQ(
      warning(charging_circuit(160 * kBar, 180 * kBar)),
      "the accumulator never fills: its precharge of 180 bar is not below the 161 bar at which 'Relief' opens (both "
      "absolute)");
  EXPECT_EQ(warning(charging_circuit(160 * kBar, 160 * kBar)), "");
  // on the pump's line itself
  HydraulicsDef beside = charging_circuit(160 * kBar, 180 * kBar);
  component<AccumulatorDef>(beside, "Accumulator").port_1 = "Line";
  EXPECT_NE(warning(beside), "");
  // a second pump without a limit feeds the store
  HydraulicsDef fed = charging_circuit(160 * kBar, 180 * kBar);
  FlowSourceDef& source = add<FlowSourceDef>(fed, "Source");
  source.port_1 = "Tank", source.port_2 = "Store", source.flow = 1e-4;
  EXPECT_EQ(warning(fed), "");
  // piloted by another line, the valve limits nothing
  HydraulicsDef piloted = charging_circuit(160 * kBar, 180 * kBar);
  component<ReliefValveDef>(piloted, "Relief").port_3 = "Store";
  EXPECT_EQ(warning(piloted), "");
  // a poppet, and a valve whose outlet is held at 40 bar
  HydraulicsDef poppet = charging_circuit(500 * kBar, 150 * kBar);
  add_tank(poppet, "Back", 40 * kBar);
  DirectReliefValveDef& direct = add<DirectReliefValveDef>(poppet, "Direct");
  direct.port_1 = "Store", direct.port_2 = "Back", direct.seat_diameter = 0.01, direct.crack_pressure = 100 * kBar;
  direct.spring_constant = 4e4;
  EXPECT_NE(warning(poppet).find("the 140 bar at which 'Direct' opens"), std::string::npos) << warning(poppet);
}

TEST(HydraulicsValidation, volumes_in_which_nothing_moves_are_named) {
  HydraulicsDef def = charging_circuit(160 * kBar, 50 * kBar);
  EXPECT_EQ(listing(findings(def).warnings), "");
  add_volume(def, "Return", 1 * kBar).rigid_volume = 1e-3;
  add_volume(def, "Behind", 1 * kBar).rigid_volume = 1e-3;
  add_volume(def, "Alone", 7 * kBar).rigid_volume = 1e-3;
  for (const auto& [name, from, to] : {std::array{"Orifice_1", "Return", "Tank"}, {"Orifice_2", "Return", "Behind"}}) {
    OrificeDef& orifice = add<OrificeDef>(def, name);
    orifice.port_1 = from, orifice.port_2 = to, orifice.diameter = 1e-3;
  }
  add_hose(def, "Hose", "Tank", 1, 0.02);
  const Problems warnings = findings(def).warnings;
  EXPECT_EQ(warnings.size(), 4U) << listing(warnings);
  EXPECT_NE(what_at(warnings, "Return").find("begins at 1 bar"), std::string::npos) << listing(warnings);
  EXPECT_NE(what_at(warnings, "Behind"), "");
  EXPECT_NE(what_at(warnings, "Alone").find("no component leads to another one"), std::string::npos);
  EXPECT_EQ(what_at(warnings, "Hose.volume"),
            "the hose does nothing: the pressure of 'Tank' is fixed, whatever it contains");
  // one that a pressure source feeds moves, and what it feeds
  HydraulicsDef fed = charging_circuit(160 * kBar, 50 * kBar);
  add_volume(fed, "Fed", 1 * kBar).rigid_volume = 1e-3;
  PressureSourceDef& source = add<PressureSourceDef>(fed, "Source");
  source.port_1 = "Fed", source.set_pressure = 20 * kBar, source.nominal_flow = 1e-4;
  EXPECT_EQ(listing(findings(fed).warnings), "");
  // one that begins above the tank empties
  for (VolumeDef& volume : def.volumes) {
    if (volume.name == "Behind") volume.initial_pressure = 20 * kBar;
  }
  EXPECT_EQ(findings(def).warnings.size(), 2U) << listing(findings(def).warnings);
}

}  // namespace validate_test
}  // namespace slew::hydraulics::test
