// SPDX-License-Identifier: Apache-2.0
// Physical dimensions of scene fields and variables, with the SI unit each is kept in.
//
// The angle is a base dimension of its own, so that Hz is not taken for rad/s and a stiffness per radian is not one per
// metre. All quantities inside the program are in the SI unit named here.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace slew {

enum class Dimension : std::uint8_t {
  none,  // dimensionless number
  length,
  area,
  volume,
  mass,
  time,
  angle,
  velocity,
  angular_velocity,
  acceleration,
  angular_acceleration,
  force,
  torque,
  impulse,
  inertia,
  density,
  pressure,
  pressure_gain,  // 1/Pa
  volume_flow,
  kinematic_viscosity,
  temperature,
  energy,
  power,
  frequency,
  stiffness,              // N/m
  damping,                // N s/m
  rotational_stiffness,   // N m/rad
  rotational_damping,     // N m s/rad
  displacement_volume,    // m3/rad
  flow_coefficient,       // m3/s/sqrt(Pa)
  leakage,                // m3/s/Pa
  pressure_rate,          // Pa/s
  force_rate,             // N/s
  mobility,               // 1/kg
  second_moment_of_area,  // m4
  electric_signal,        // the valve's control signal, V or mA as the maker states it: a plain number
  specific_heat,          // J/(kg K)
  thermal_conductance,    // W/K
  // K; 0.5 degC is a temperature, 273.65 K, and no difference
  temperature_difference,
  number_of_dimensions
};

struct DimensionInfo {
  std::string_view name;                // "pressure"
  std::string_view si_unit;             // "Pa"
  std::string_view example;             // "250 bar": for messages and the schema
  std::array<std::int8_t, 5> exponent;  // powers of kg, m, s, K, rad
};

[[nodiscard]] const DimensionInfo& info(Dimension dimension) noexcept;

}  // namespace slew
