// Line forces that hold the ports where they are: W F = -a_free, with the mobility and the free accelerations of a
// MechanismSample.
#pragma once

#include <span>
#include <string_view>

namespace slew::coupling {

// W: m x m, row-major; a_free, F: m <= kMaxPorts. False, and F is of no use, when no forces do. Does not allocate.
[[nodiscard]] bool static_forces(std::span<const double> W, std::span<const double> a_free,
                                 std::span<double> F) noexcept;

inline constexpr std::string_view kNoStaticForces =
    "no static force holds the actuators at the start: two of them move the same coordinate, or one moves nothing; "
    "look "
    "at their force elements";

}  // namespace slew::coupling
