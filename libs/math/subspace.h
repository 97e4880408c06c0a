// SPDX-License-Identifier: Apache-2.0
// Bases of subspaces and definite systems of a few unknowns, for searches before a run: dense, row-major, allocating.
#pragma once

#include <cstddef>
#include <vector>

namespace slew::math {

// a . b
[[nodiscard]] double product(const std::vector<double>& a, const std::vector<double>& b);
// to += factor from
void add(double factor, const std::vector<double>& from, std::vector<double>& to);
// Scales v to length 1; zero stays.
void make_unit(std::vector<double>& v);

// Orthonormal basis of what `vectors` span: the longest remainder is the next one, until all are at most `shortest`.
[[nodiscard]] std::vector<std::vector<double>> orthonormal(std::vector<std::vector<double>> vectors, double shortest);

// Solves (K + mu G) x = f. False if the matrix is not positive definite; x is then undefined.
[[nodiscard]] bool solve_definite(const std::vector<double>& K, const std::vector<double>& G, double mu,
                                  const std::vector<double>& f, std::vector<double>& x);

// A unit vector d with d^T A d <= 0, A size x size and symmetric; empty if A is positive definite. From the first
// leading block that is not: d = (-A_11^-1 a_1, 1, 0).
[[nodiscard]] std::vector<double> falling_direction(const std::vector<double>& A, std::size_t size);

}  // namespace slew::math
