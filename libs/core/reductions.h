// SPDX-License-Identifier: Apache-2.0
// Sums in a fixed order: the result depends on the values and their order only, never on where they lie in memory.
//
// Libraries of linear algebra peel the unaligned head of a reduction, so that its result depends on the address modulo
// 32. These kernels do not: four partial sums over i mod 4, added as (s0 + s1) + (s2 + s3), then the tail in order.
#pragma once

#include <cstddef>
#include <span>

namespace slew {

// Pre-condition: equal sizes.
[[nodiscard]] double fixed_dot(std::span<const double> a, std::span<const double> b) noexcept;

// Largest absolute value; NaN if any element is NaN; 0 for an empty span.
[[nodiscard]] double fixed_max_abs(std::span<const double> a) noexcept;

[[nodiscard]] bool all_finite(std::span<const double> a) noexcept;

}  // namespace slew
