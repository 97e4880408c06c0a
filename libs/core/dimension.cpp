// SPDX-License-Identifier: Apache-2.0
#include "core/dimension.h"

#include <cstddef>

namespace slew {
namespace {

constexpr std::array<DimensionInfo, static_cast<std::size_t>(Dimension::number_of_dimensions)> kTable = {{
    {"number", "1", "0.5", {0, 0, 0, 0, 0}},
    {"length", "m", "1.5 m", {0, 1, 0, 0, 0}},
    {"area", "m2", "12 cm2", {0, 2, 0, 0, 0}},
    {"volume", "m3", "0.1 l", {0, 3, 0, 0, 0}},
    {"mass", "kg", "500 kg", {1, 0, 0, 0, 0}},
    {"time", "s", "10 ms", {0, 0, 1, 0, 0}},
    {"angle", "rad", "37.5 deg", {0, 0, 0, 0, 1}},
    {"velocity", "m/s", "0.01 m/s", {0, 1, -1, 0, 0}},
    {"angular velocity", "rad/s", "1500 rpm", {0, 0, -1, 0, 1}},
    {"acceleration", "m/s2", "9.81 m/s2", {0, 1, -2, 0, 0}},
    {"angular acceleration", "rad/s2", "1 rad/s2", {0, 0, -2, 0, 1}},
    {"force", "N", "1 kN", {1, 1, -2, 0, 0}},
    {"torque", "N m", "800 Nm", {1, 2, -2, 0, 0}},
    {"impulse", "N s", "10 N s", {1, 1, -1, 0, 0}},
    {"inertia", "kg m2", "230 kg m2", {1, 2, 0, 0, 0}},
    {"density", "kg/m3", "870 kg/m3", {1, -3, 0, 0, 0}},
    {"pressure", "Pa", "250 bar", {1, -1, -2, 0, 0}},
    {"pressure gain", "1/Pa", "3.5e-7 1/Pa", {-1, 1, 2, 0, 0}},
    {"volume flow", "m3/s", "70 l/min", {0, 3, -1, 0, 0}},
    {"kinematic viscosity", "m2/s", "46 cSt", {0, 2, -1, 0, 0}},
    {"temperature", "K", "40 degC", {0, 0, 0, 1, 0}},
    {"energy", "J", "1 kJ", {1, 2, -2, 0, 0}},
    {"power", "W", "1 kW", {1, 2, -3, 0, 0}},
    {"frequency", "Hz", "10 Hz", {0, 0, -1, 0, 0}},
    {"stiffness", "N/m", "5e7 N/m", {1, 0, -2, 0, 0}},
    {"damping", "N s/m", "5e5 Ns/m", {1, 0, -1, 0, 0}},
    {"rotational stiffness", "N m/rad", "2e7 Nm/rad", {1, 2, -2, 0, -1}},
    {"rotational damping", "N m s/rad", "5000 Nms/rad", {1, 2, -1, 0, -1}},
    {"displacement", "m3/rad", "140 cm3/rev", {0, 3, 0, 0, -1}},
    {"flow coefficient", "m3/s/Pa^0.5", "6.2e-7", {0, 0, 0, 0, 0}},
    {"leakage", "m3/s/Pa", "1.67e-13 m3/s/Pa", {-1, 4, 1, 0, 0}},
    {"pressure rate", "Pa/s", "1 bar/s", {1, -1, -3, 0, 0}},
    {"force rate", "N/s", "1 kN/s", {1, 1, -3, 0, 0}},
    {"mobility", "1/kg", "1e-4 1/kg", {-1, 0, 0, 0, 0}},
    {"second moment of area", "m4", "450 cm4", {0, 4, 0, 0, 0}},
    {"control signal", "1", "500", {0, 0, 0, 0, 0}},
    {"specific heat", "J/kg/K", "1900 J/kg/K", {0, 2, -2, -1, 0}},
    {"thermal conductance", "W/K", "50 W/K", {1, 2, -3, -1, 0}},
    {"temperature difference", "K", "0.5 K", {0, 0, 0, 1, 0}},
}};

}  // namespace

const DimensionInfo& info(Dimension dimension) noexcept {
  return kTable[static_cast<std::size_t>(dimension)];
}

}  // namespace slew
