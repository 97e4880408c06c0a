// Sums in a fixed order: the result depends on the values and their order only, never on where they lie in memory.
//
// Eigen peels the unaligned head of a run-time sized reduction, so its result depends on the address modulo 32. These
// kernels do not: four partial sums over i mod 4, added as (s0 + s1) + (s2 + s3), then the tail in order.
#pragma once

#include <cstddef>
#include <span>

namespace slew {

[[nodiscard]] double fixed_sum(std::span<const double> a) noexcept;

// Pre-condition: equal sizes.
[[nodiscard]] double fixed_dot(std::span<const double> a, std::span<const double> b) noexcept;

// Largest absolute value; NaN if any element is NaN; 0 for an empty span.
[[nodiscard]] double fixed_max_abs(std::span<const double> a) noexcept;

// y = A x, A row-major rows x columns; x and y must not overlap.
void fixed_multiply(std::span<const double> A, std::span<const double> x, std::span<double> y) noexcept;

[[nodiscard]] bool all_finite(std::span<const double> a) noexcept;

}  // namespace slew
