// SPDX-License-Identifier: Apache-2.0
#include "math/subspace.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "math/small_cholesky.h"

namespace slew::math {

using Vector = std::vector<double>;

double product(const Vector& a, const Vector& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

void add(double factor, const Vector& from, Vector& to) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += factor * from[i];
}

void make_unit(Vector& v) {
  const double size = std::sqrt(product(v, v));
  if (!(size > 0)) return;
  for (double& one : v) one /= size;
}

std::vector<Vector> orthonormal(std::vector<Vector> vectors, double shortest) {
  std::vector<Vector> basis;
  while (!vectors.empty()) {
    const auto longest = std::max_element(
        vectors.begin(), vectors.end(), [](const Vector& a, const Vector& b) { return product(a, a) < product(b, b); });
    if (!(std::sqrt(product(*longest, *longest)) > shortest)) break;
    Vector next = std::move(*longest);
    vectors.erase(longest);
    make_unit(next);
    // once more: rounding of a short remainder
    for (const Vector& known : basis) add(-product(known, next), known, next);
    make_unit(next);
    for (Vector& one : vectors) add(-product(next, one), next, one);
    basis.push_back(std::move(next));
  }
  return basis;
}

bool solve_definite(const Vector& K, const Vector& G, double mu, const Vector& f, Vector& x) {
  Vector A = K;
  add(mu, G, A);
  const int size = static_cast<int>(f.size());
  x = f;
  if (!factorize_cholesky(A.data(), size)) return false;
  substitute_forward(A.data(), size, x.data());
  substitute_backward(A.data(), size, x.data());
  return true;
}

Vector falling_direction(const Vector& A, std::size_t size) {
  for (std::size_t k = 0; k < size; ++k) {
    Vector block;
    for (std::size_t r = 0; r <= k; ++r) block.insert(block.end(), &A[r * size], &A[r * size] + k + 1);
    if (factorize_cholesky(block.data(), static_cast<int>(k) + 1)) continue;
    Vector leading, column;
    for (std::size_t r = 0; r < k; ++r) {
      leading.insert(leading.end(), &A[r * size], &A[r * size] + k);
      column.push_back(-A[r * size + k]);
    }
    Vector d;
    if (!solve_definite(leading, Vector(k * k), 0, column, d)) d.assign(k, 0.0);
    d.resize(size);
    d[k] = 1;
    make_unit(d);
    return d;
  }
  return {};
}

}  // namespace slew::math
