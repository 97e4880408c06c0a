// SPDX-License-Identifier: Apache-2.0
// Definition of a hydraulic circuit: oil, solver, start state, volumes, components, curves.
//
// Pressures are absolute. Settings of valves and pumps are relative to the tank they are connected to.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/field.h"
#include "core/problem.h"
#include "hydraulics/component_def.h"

namespace slew::hydraulics {

enum class Solver : int { rodas3, rk4, implicit_euler, cvode };
enum class OilLaw : int { oil_and_air, density_parabola };
enum class OilTemperature : int { one, by_volume };
enum class StartState : int { equilibrium, table13 };
enum class Interpolation : int { linear, pchip };

inline constexpr std::string_view kSolverChoices[] = {"rodas3", "rk4", "implicit_euler", "cvode"};
inline constexpr std::string_view kOilLawChoices[] = {"oil_and_air", "density_parabola"};
inline constexpr std::string_view kOilTemperatureChoices[] = {"one", "by_volume"};
inline constexpr std::string_view kStartChoices[] = {"equilibrium", "table13"};
inline constexpr std::string_view kInterpolationChoices[] = {"linear", "pchip"};

// A pressure node. Its oil content is its own rigid volume plus that of every hose and cylinder chamber connected to
// it.
struct VolumeDef {
  std::string name;
  double initial_pressure = 1e5;  // Pa absolute
  double rigid_volume = 0;        // m3, oil in a rigid block at this node
  bool fixed = false;             // true: a tank or an ideal pressure source, held at initial_pressure
  bool quasi_static = false;      // true: no storage; the pressure balances the flows
};

// A function of one variable given by points; the last value is held beyond the ends.
struct CurveDef {
  std::string name;
  Table points;  // argument (SI), value (SI)
  Interpolation interpolation = Interpolation::linear;
  bool odd = false;  // points are given for arguments >= 0, f(-x) = -f(x)
};

struct HydraulicsDef {
  // oil: an ISO VG 46 mineral oil
  OilLaw oil_law = OilLaw::oil_and_air;
  double oil_bulk_modulus = 1.5e9;       // Pa, modulus of the oil without air
  double oil_density = 870;              // kg/m3
  double oil_viscosity = 46e-6;          // m2/s, at working temperature, or at reference_temperature
  double entrained_air = 0.005;          // air volume / oil volume at the reference pressure
  double air_reference_pressure = 1e5;   // Pa absolute
  double polytropic_exponent = 1.2;      // exponent of the entrained air
  double oil_compressibility = 6.5e-10;  // 1/Pa at zero pressure, for the density parabola
  double oil_density_peak = 3000e5;      // Pa absolute, at the top of the density parabola
  OilTemperature oil_temperature = OilTemperature::one;
  double reference_temperature = 313.15;  // K, of all values of the oil and of leaks
  double hot_temperature = 373.15;        // K, of the three values below
  double hot_viscosity = 0;               // m2/s
  double hot_density = 0;                 // kg/m3; 0: by the usual expansion
  double hot_bulk_modulus = 0;            // Pa; 0: by the usual fall
  double oil_specific_heat = 1900;        // J/(kg K)
  double start_temperature = 313.15;      // K
  double pressure_floor = 5e3;            // Pa absolute; below it a volume is cavitating
  double orifice_transition = 1e4;        // Pa; below it an orifice is laminar

  // solver
  Solver solver = Solver::rodas3;
  double relative_tolerance = 1e-4;
  double pressure_scale = 1e6;        // Pa, below it the error of a pressure is judged absolutely
  double minimum_step = 1e-6;         // s
  double max_substep = 1e-4;          // s, fixed sub-step of rk4 and implicit_euler
  std::int64_t substep_budget = 200;  // sub-steps per communication step
  double quasi_static_above = 0;      // 1/s; volumes faster than this at the start become quasi-static; 0: none

  // start state
  StartState start = StartState::equilibrium;
  double start_return_pressure = 5e5;  // Pa absolute, rod side of linear cylinders in equilibrium
  double start_slew_pressure = 20e5;   // Pa absolute, mean of both sides of slew cylinders in equilibrium
  double start_pump_pressure = 26e5;   // Pa absolute, volumes at a pump's outlet in equilibrium

  std::vector<VolumeDef> volumes;
  std::vector<std::unique_ptr<ComponentDef>> components;
  std::vector<CurveDef> curves;
};

inline constexpr Range kToleranceRange{.min = 1e-10, .max = 1e-1};
inline constexpr Range kBudgetRange{.min = 1, .max = 1e6, .min_is_open = false, .max_is_open = false};
// a top below 1300 bar would be within the pressure range of a circuit
inline constexpr Range kPeakRange{.min = 1300e5};
inline constexpr Range kAirRange{.min = 0, .max = 0.2, .min_is_open = false, .max_is_open = false};
// range of the laws of the oil's properties: -40 to 150 degC
inline constexpr Range kOilTemperatureRange{.min = 233.15, .max = 423.15, .min_is_open = false, .max_is_open = false};
inline constexpr Range kPolytropicRange{.min = 1, .max = 2, .min_is_open = false, .max_is_open = false};

inline constexpr ReadBy kReadByAir[] = {
    read_by<&HydraulicsDef::oil_law, OilLaw::oil_and_air>("oil_law", "oil_law: oil_and_air")};
inline constexpr ReadBy kReadByAirThere[] = {
    read_by<&HydraulicsDef::oil_law, OilLaw::oil_and_air>("oil_law", "oil_law: oil_and_air"),
    read_by_set<&HydraulicsDef::entrained_air>("entrained_air", "entrained_air above 0")};
inline constexpr ReadBy kReadByParabola[] = {
    read_by<&HydraulicsDef::oil_law, OilLaw::density_parabola>("oil_law", "oil_law: density_parabola")};
inline constexpr ReadBy kReadByTemperatures[] = {read_by<&HydraulicsDef::oil_temperature, OilTemperature::by_volume>(
    "oil_temperature", "oil_temperature: by_volume", ReadBy::Otherwise::error_in_files)};
inline constexpr ReadBy kReadByTemperaturesOfAir[] = {
    read_by<&HydraulicsDef::oil_temperature, OilTemperature::by_volume>("oil_temperature", "oil_temperature: by_volume",
                                                                        ReadBy::Otherwise::error_in_files),
    read_by<&HydraulicsDef::oil_law, OilLaw::oil_and_air>("oil_law", "oil_law: oil_and_air")};
inline constexpr ReadBy kReadByTolerance[] = {
    read_by<&HydraulicsDef::solver, Solver::rodas3, Solver::implicit_euler, Solver::cvode>(
        "solver", "solver: rodas3, implicit_euler or cvode", ReadBy::Otherwise::warning)};
inline constexpr ReadBy kReadByHalving[] = {read_by<&HydraulicsDef::solver, Solver::rodas3, Solver::implicit_euler>(
    "solver", "solver: rodas3 or implicit_euler", ReadBy::Otherwise::error_in_files)};
inline constexpr ReadBy kReadByFixedStep[] = {read_by<&HydraulicsDef::solver, Solver::rk4, Solver::implicit_euler>(
    "solver", "solver: rk4 or implicit_euler", ReadBy::Otherwise::error_in_files)};
inline constexpr ReadBy kReadByEquilibrium[] = {
    read_by<&HydraulicsDef::start, StartState::equilibrium>("start", "start: equilibrium")};

inline constexpr Field kHydraulicsFields[] = {
    field<&HydraulicsDef::oil_law>(
        "oil_law", {.choices = kOilLawChoices,
                    .doc = "oil_and_air: bulk modulus with entrained air; density_parabola: density over pressure as a "
                           "parabola, no air"}),
    field<&HydraulicsDef::oil_bulk_modulus>("oil_bulk_modulus", {.dimension = Dimension::pressure,
                                                                 .range = kPositive,
                                                                 .read_by = kReadByAir,
                                                                 .doc = "bulk modulus of the oil without air"}),
    field<&HydraulicsDef::oil_density>("oil_density",
                                       {.dimension = Dimension::density, .range = kPositive, .doc = "oil density"}),
    field<&HydraulicsDef::oil_viscosity>(
        "oil_viscosity", {.dimension = Dimension::kinematic_viscosity,
                          .range = kPositive,
                          .doc = "kinematic viscosity at working temperature, or at reference_temperature"}),
    field<&HydraulicsDef::entrained_air>(
        "entrained_air", {.range = kAirRange,
                          .read_by = kReadByAir,
                          .doc = "volume of entrained air per volume of oil at air_reference_pressure"}),
    field<&HydraulicsDef::air_reference_pressure>("air_reference_pressure",
                                                  {.dimension = Dimension::pressure,
                                                   .range = kPositive,
                                                   .read_by = kReadByAirThere,
                                                   .doc = "absolute pressure of entrained_air"}),
    field<&HydraulicsDef::polytropic_exponent>(
        "polytropic_exponent",
        {.range = kPolytropicRange, .read_by = kReadByAirThere, .doc = "polytropic exponent of the air"}),
    field<&HydraulicsDef::oil_compressibility>("oil_compressibility", {.dimension = Dimension::pressure_gain,
                                                                       .range = kPositive,
                                                                       .read_by = kReadByParabola,
                                                                       .doc = "compressibility at zero pressure"}),
    field<&HydraulicsDef::oil_density_peak>("oil_density_peak",
                                            {.dimension = Dimension::pressure,
                                             .range = kPeakRange,
                                             .read_by = kReadByParabola,
                                             .doc = "absolute pressure at the top of the density parabola"}),
    field<&HydraulicsDef::oil_temperature>("oil_temperature",
                                           {.choices = kOilTemperatureChoices,
                                            .doc = "one: constant, of all oil; by_volume: every volume has its own, "
                                                   "with the heat of losses, and the properties follow"}),
    field<&HydraulicsDef::reference_temperature>(
        "reference_temperature",
        {.dimension = Dimension::temperature,
         .range = kOilTemperatureRange,
         .read_by = kReadByTemperatures,
         .doc = "temperature of oil_viscosity, oil_density, oil_bulk_modulus and of stated leaks"}),
    field<&HydraulicsDef::hot_temperature>("hot_temperature", {.dimension = Dimension::temperature,
                                                               .range = kOilTemperatureRange,
                                                               .read_by = kReadByTemperatures,
                                                               .doc = "second temperature of known properties"}),
    field<&HydraulicsDef::hot_viscosity>("hot_viscosity",
                                         {.dimension = Dimension::kinematic_viscosity,
                                          .range = kNotNegative,
                                          .read_by = kReadByTemperatures,
                                          .doc = "kinematic viscosity at hot_temperature; must be stated"}),
    field<&HydraulicsDef::hot_density>("hot_density", {.dimension = Dimension::density,
                                                       .range = kNotNegative,
                                                       .read_by = kReadByTemperatures,
                                                       .doc = "density at hot_temperature; 0: 7e-4 less per K"}),
    field<&HydraulicsDef::hot_bulk_modulus>(
        "hot_bulk_modulus", {.dimension = Dimension::pressure,
                             .range = kNotNegative,
                             .read_by = kReadByTemperaturesOfAir,
                             .doc = "bulk modulus of the oil without air at hot_temperature; 0: 4e-3 less per K"}),
    field<&HydraulicsDef::oil_specific_heat>("oil_specific_heat", {.dimension = Dimension::specific_heat,
                                                                   .range = kPositive,
                                                                   .read_by = kReadByTemperatures,
                                                                   .doc = "specific heat"}),
    field<&HydraulicsDef::start_temperature>("start_temperature", {.dimension = Dimension::temperature,
                                                                   .range = kOilTemperatureRange,
                                                                   .read_by = kReadByTemperatures,
                                                                   .doc = "temperature of all volumes at the start"}),
    field<&HydraulicsDef::pressure_floor>(
        "pressure_floor", {.dimension = Dimension::pressure,
                           .range = kPositive,
                           .doc = "absolute pressure below which the oil cavitates and vapour fills the volume"}),
    field<&HydraulicsDef::orifice_transition>(
        "orifice_transition", {.dimension = Dimension::pressure,
                               .range = kPositive,
                               .doc = "pressure drop below which an orifice turns from square root to linear"}),
    field<&HydraulicsDef::solver>("solver",
                                  {.choices = kSolverChoices,
                                   .doc = "rodas3: adaptive, L-stable; rk4, implicit_euler: sub-steps of fixed size; "
                                          "cvode: adaptive BDF of variable order, for reference runs"}),
    field<&HydraulicsDef::relative_tolerance>(
        "relative_tolerance",
        {.range = kToleranceRange, .read_by = kReadByTolerance, .doc = "relative error of a sub-step"}),
    field<&HydraulicsDef::pressure_scale>(
        "pressure_scale",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure added to the scale of the error"}),
    field<&HydraulicsDef::minimum_step>("minimum_step", {.dimension = Dimension::time,
                                                         .range = kPositive,
                                                         .read_by = kReadByHalving,
                                                         .doc = "smallest sub-step; shorter only after a failure"}),
    field<&HydraulicsDef::max_substep>(
        "max_substep",
        {.dimension = Dimension::time, .range = kPositive, .read_by = kReadByFixedStep, .doc = "sub-step size"}),
    field<&HydraulicsDef::substep_budget>("substep_budget",
                                          {.range = kBudgetRange,
                                           .read_by = kReadByHalving,
                                           .doc = "sub-steps in one communication step; beyond, rodas3 loosens its "
                                                  "tolerances, implicit_euler accepts steps, and the step is flagged"}),
    field<&HydraulicsDef::quasi_static_above>(
        "quasi_static_above",
        {.dimension = Dimension::frequency,
         .range = kNotNegative,
         .doc = "rate at the start above which volumes without a chamber are quasi-static; 0: marked volumes only"}),
    field<&HydraulicsDef::start>(
        "start", {.choices = kStartChoices,
                  .doc = "equilibrium: cylinders hold the static load; table13: every volume at its initial pressure"}),
    field<&HydraulicsDef::start_return_pressure>("start_return_pressure",
                                                 {.dimension = Dimension::pressure,
                                                  .range = kPositive,
                                                  .read_by = kReadByEquilibrium,
                                                  .doc = "absolute rod-side pressure of linear cylinders"}),
    field<&HydraulicsDef::start_slew_pressure>("start_slew_pressure",
                                               {.dimension = Dimension::pressure,
                                                .range = kPositive,
                                                .read_by = kReadByEquilibrium,
                                                .doc = "absolute mean pressure of slew cylinders"}),
    field<&HydraulicsDef::start_pump_pressure>("start_pump_pressure", {.dimension = Dimension::pressure,
                                                                       .range = kPositive,
                                                                       .read_by = kReadByEquilibrium,
                                                                       .doc = "absolute pressure of pump volumes"}),
};

inline constexpr Field kVolumeFields[] = {
    field<&VolumeDef::initial_pressure>(
        "initial_pressure", {.dimension = Dimension::pressure, .range = kPositive, .doc = "absolute start pressure"}),
    field<&VolumeDef::rigid_volume>(
        "rigid_volume",
        {.dimension = Dimension::volume, .range = kNotNegative, .doc = "oil in a rigid block at this node"}),
    field<&VolumeDef::fixed>("fixed", {.doc = "held at its initial pressure: a tank or an ideal pressure source"}),
    field<&VolumeDef::quasi_static>(
        "quasi_static", {.doc = "stores nothing: its pressure makes the flows add up to zero at every instant"}),
};

inline constexpr Field kCurveFields[] = {
    field<&CurveDef::points>(
        "points", {.presence = Presence::required, .doc = "[argument, value] in SI units, arguments increasing"}),
    field<&CurveDef::interpolation>("interpolation",
                                    {.choices = kInterpolationChoices, .doc = "straight lines or monotone cubics"}),
    field<&CurveDef::odd>("odd", {.doc = "points are for positive arguments; f(-x) = -f(x)"}),
};

// Checks ranges and references by the field tables, then every rule between fields and elements. Problems are appended
// with paths like "Cyl_Lift.rod_diameter"; a circuit builds only when errors stays empty. Warnings do not stop it.
// Force elements are named here but live in the mechanics: the scene checks that they exist.
void validate(const HydraulicsDef& def, Problems& errors, Problems& warnings);

// The actuator with a chamber in the volume; null if there is none.
[[nodiscard]] const ComponentDef* find_chamber(const HydraulicsDef& def, const VolumeDef& volume);

}  // namespace slew::hydraulics
