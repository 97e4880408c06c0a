// SPDX-License-Identifier: Apache-2.0
#include "tests/validation/multibody/extremes/planar_chain.h"

#include <algorithm>

namespace slew::multibody::testing {

using Eigen::VectorXd;

PlanarChain::PlanarChain(const std::vector<PlanarRod>& rods, double tip, double gravity) : gravity_(gravity) {
  const auto n = static_cast<Eigen::Index>(rods.size());
  std::vector<double> beyond(rods.size(), tip);
  for (std::size_t i = rods.size() - 1; i > 0; --i) beyond[i - 1] = beyond[i] + rods[i].mass;
  A_.resize(n, n);
  B_.resize(n);
  theta_.setZero(n);
  omega_.setZero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = [&](Eigen::Index k) { return static_cast<std::size_t>(k); };
    const PlanarRod& rod = rods[at(i)];
    B_[i] = (0.5 * rod.mass + beyond[at(i)]) * rod.length;
    for (Eigen::Index j = 0; j < n; ++j) {
      const std::size_t k = at(std::max(i, j));
      const double share = i == j ? rods[k].mass / 3 : rods[k].mass / 2;
      A_(i, j) = (share + beyond[k]) * rod.length * rods[at(j)].length;
    }
  }
}

VectorXd PlanarChain::accelerations(const VectorXd& theta, const VectorXd& omega) const {
  const Eigen::Index n = theta.size();
  const Eigen::ArrayXd c = theta.array().cos(), s = theta.array().sin();
  Eigen::MatrixXd M(n, n);
  VectorXd right(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    double sum = gravity_ * B_[i] * c[i];
    for (Eigen::Index j = 0; j < n; ++j) {
      M(i, j) = A_(i, j) * (c[i] * c[j] + s[i] * s[j]);
      sum += A_(i, j) * (s[i] * c[j] - c[i] * s[j]) * omega[j] * omega[j];
    }
    right[i] = -sum;
  }
  return M.llt().solve(right);
}

void PlanarChain::run(double time, int steps) {
  const double h = time / steps;
  for (int i = 0; i < steps; ++i) {
    const VectorXd a1 = accelerations(theta_, omega_);
    const VectorXd w2 = omega_ + 0.5 * h * a1, a2 = accelerations(theta_ + 0.5 * h * omega_, w2);
    const VectorXd w3 = omega_ + 0.5 * h * a2, a3 = accelerations(theta_ + 0.5 * h * w2, w3);
    const VectorXd w4 = omega_ + h * a3, a4 = accelerations(theta_ + h * w3, w4);
    theta_ += h / 6 * (omega_ + 2 * w2 + 2 * w3 + w4);
    omega_ += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
}

}  // namespace slew::multibody::testing
