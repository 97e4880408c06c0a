// SPDX-License-Identifier: Apache-2.0
#include "math/bounded_least_squares.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/check.h"
#include "math/small_solve.h"

namespace slew::math {

namespace {

constexpr double kWeight = 1e-8;     // w: half of the digits each for (1) and for what is near t
constexpr double kRounding = 1e-12;  // share of a sum's terms
constexpr int kCorrections = 4;      // each multiplies the weight's effect by w / (sigma^2 + w)

class ActiveSet {
 public:
  ActiveSet(std::span<const double> M, std::span<const double> b, std::span<const double> t)
      : M_(M), b_(b), t_(t), m_(b.size()), n_(t.size()), q_(n_, 0.0), is_free_(n_, 0), lambda_(m_, 0.0) {}

  std::vector<double> solve() {
    find_lambda(b_, 1);
    // each unknown enters and leaves a few times at most
    for (std::size_t tries = 0; tries < 4 * n_ + 4; ++tries) {
      const std::size_t next = largest_gradient();
      if (next == n_) break;
      is_free_[next] = 1;
      move_to_minimum();
    }
    for (int i = 0; i < kCorrections; ++i) correct();
    return q_;
  }

 private:
  [[nodiscard]] double along(std::size_t j) const noexcept {
    double sum = 0;
    for (std::size_t i = 0; i < m_; ++i) sum += M_[i * n_ + j] * lambda_[i];
    return sum;
  }

  // unknown at 0 that the minimum wants to raise most; n: none
  [[nodiscard]] std::size_t largest_gradient() const noexcept {
    std::size_t next = n_;
    double largest = 0;
    for (std::size_t j = 0; j < n_; ++j) {
      if (is_free_[j]) continue;
      double size = t_[j];
      for (std::size_t i = 0; i < m_; ++i) size += std::fabs(M_[i * n_ + j] * lambda_[i]);
      const double gradient = along(j) + t_[j];
      if (gradient <= kRounding * size || gradient <= largest) continue;
      largest = gradient;
      next = j;
    }
    return next;
  }

  // (M M^T + w) lambda = right - share M t, of the free unknowns
  void find_lambda(std::span<const double> right, double share) {
    std::vector<double> K(m_ * m_, 0.0);
    lambda_.assign(right.begin(), right.end());
    for (std::size_t i = 0; i < m_; ++i) {
      K[i * m_ + i] = kWeight;
      for (std::size_t j = 0; j < n_; ++j) {
        if (!is_free_[j]) continue;
        lambda_[i] -= share * M_[i * n_ + j] * t_[j];
        for (std::size_t k = 0; k < m_; ++k) K[i * m_ + k] += M_[i * n_ + j] * M_[k * n_ + j];
      }
    }
    SLEW_CHECK(solve_in_place(K.data(), lambda_.data(), m_, 1));
  }

  // the minimum of the free unknowns; those that would fall below 0 stop there and are free no more
  void move_to_minimum() {
    for (std::size_t tries = 0; tries <= n_; ++tries) {
      find_lambda(b_, 1);
      double share = 1;
      std::size_t first = n_;
      for (std::size_t j = 0; j < n_; ++j) {
        const double wanted = t_[j] + along(j);
        if (!is_free_[j] || wanted > 0) continue;
        const double reached = q_[j] > 0 ? q_[j] / (q_[j] - wanted) : 0;
        if (first < n_ && reached >= share) continue;
        share = reached;
        first = j;
      }
      for (std::size_t j = 0; j < n_; ++j) {
        if (is_free_[j]) q_[j] += share * (t_[j] + along(j) - q_[j]);
      }
      if (first == n_) return;
      q_[first] = 0;
      is_free_[first] = 0;
    }
  }

  void correct() {
    std::vector<double> left(b_.begin(), b_.end());
    for (std::size_t i = 0; i < m_; ++i) {
      for (std::size_t j = 0; j < n_; ++j) left[i] -= M_[i * n_ + j] * q_[j];
    }
    find_lambda(left, 0);
    for (std::size_t j = 0; j < n_; ++j) {
      if (is_free_[j]) q_[j] = std::max(0.0, q_[j] + along(j));
    }
  }

  std::span<const double> M_, b_, t_;
  std::size_t m_, n_;
  std::vector<double> q_;
  std::vector<char> is_free_;
  std::vector<double> lambda_;
};

}  // namespace

std::vector<double> bounded_least_squares(std::span<const double> M, std::span<const double> b,
                                          std::span<const double> t) {
  SLEW_CHECK(M.size() == b.size() * t.size());
  return ActiveSet(M, b, t).solve();
}

}  // namespace slew::math
