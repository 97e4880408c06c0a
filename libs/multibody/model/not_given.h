// SPDX-License-Identifier: Apache-2.0
// Numbers that a scene may leave open and that then follow from others: no scene can write this value.
#pragma once

#include <limits>

#include "core/field.h"

namespace slew::multibody {

inline constexpr double kNotGiven = std::numeric_limits<double>::infinity();
inline constexpr Triple kNoneGiven = {kNotGiven, kNotGiven, kNotGiven};

[[nodiscard]] constexpr bool is_given(double x) noexcept {
  return x != kNotGiven;
}
[[nodiscard]] constexpr bool is_given(const Triple& x) noexcept {
  return x != kNoneGiven;
}
[[nodiscard]] constexpr double given_or(double x, double other) noexcept {
  return is_given(x) ? x : other;
}
[[nodiscard]] constexpr Triple given_or(const Triple& x, const Triple& other) noexcept {
  return is_given(x) ? x : other;
}

}  // namespace slew::multibody
