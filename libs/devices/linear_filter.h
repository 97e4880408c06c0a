// SPDX-License-Identifier: Apache-2.0
// Linear filter of order 2 or 3 with constant coefficients, advanced exactly for an input that is constant over a step.
//
//   y^(n) + c_n-1 y^(n-1) + ... + c_0 y = u,    states y, y', ..., y^(n-1)
//   z_n+1 = e^(A h) z_n + (integral of e^(A t) dt) B u_n
//
// From one exponential of the augmented matrix [A B; 0 0] h at build. Card: docs/models/motion_platform.md.
#pragma once

#include <array>
#include <cstddef>

namespace slew::devices {

inline constexpr std::size_t kMaxFilterOrder = 3;

// Immutable.
struct LinearFilter {
  std::size_t order = 0;
  std::array<std::array<double, kMaxFilterOrder>, kMaxFilterOrder> transition{};  // e^(A h)
  std::array<double, kMaxFilterOrder> input{};                                    // gain of u on the states
};

struct FilterState {
  std::array<double, kMaxFilterOrder> z{};  // y and its derivatives
};

// coefficients: c_0, c_1, .. of `order` numbers. Pre-condition: order 2 or 3, step above 0 [s].
[[nodiscard]] LinearFilter build_filter(std::size_t order, const std::array<double, kMaxFilterOrder>& coefficients,
                                        double step) noexcept;

void advance(const LinearFilter& filter, double u, FilterState& state) noexcept;

}  // namespace slew::devices
