// SPDX-License-Identifier: Apache-2.0
// Unit of a port's coordinate, and the dimensions of its quantities.
//
// A port's x, v, F and K are in m, m/s, N and N/m; where the coordinate is an angle (a motor's shaft) rad, rad/s, Nm
// and Nm/rad stand for them. The equations of the coupling do not differ.
#pragma once

#include <cstdint>

#include "core/dimension.h"

namespace slew::coupling {

enum class PortUnit : std::uint8_t { metre, radian };

// Of a torque per kilogram there is no dimension.
struct PortDimensions {
  Dimension position, speed, force, force_per_mass;
};

[[nodiscard]] constexpr PortDimensions dimensions_of(PortUnit unit) noexcept {
  return unit == PortUnit::metre
             ? PortDimensions{Dimension::length, Dimension::velocity, Dimension::force, Dimension::acceleration}
             : PortDimensions{Dimension::angle, Dimension::angular_velocity, Dimension::torque, Dimension::none};
}

}  // namespace slew::coupling
