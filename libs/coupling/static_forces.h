// SPDX-License-Identifier: Apache-2.0
// Line forces that hold the ports where they are: W F = -a_free, with the mobility and the free accelerations of a
// MechanismSample.
#pragma once

#include <span>
#include <string_view>

namespace slew::coupling {

// W: m x m, row-major, symmetric; a_free, F: m <= kMaxPorts. Where several actuators move the same coordinate, the F of
// least norm is taken: equal cylinders side by side carry equal shares. False, with F undefined, if no forces hold the
// ports. Does not allocate.
[[nodiscard]] bool static_forces(std::span<const double> W, std::span<const double> a_free,
                                 std::span<double> F) noexcept;

inline constexpr std::string_view kNoStaticForces =
    "no static forces hold the actuators at the start: one of them moves nothing; look at their force elements, or "
    "begin "
    "with hydraulics.start: table13";

}  // namespace slew::coupling
