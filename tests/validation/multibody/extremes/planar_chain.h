// SPDX-License-Identifier: Apache-2.0
// Equations of motion of a chain of rods in a plane, written down for its absolute angles: a reference that shares no
// code with the library.
//
// theta_i: angle of rod i from x; mu_i: mass of all that hangs on the end of rod i, m_i and l_i its own mass and length
//   sum_j A_ij cos(theta_i - theta_j) theta_j'' + sum_j A_ij sin(theta_i - theta_j) theta_j'^2 = -g B_i cos theta_i
//   A_ii = m_i l_i^2 / 3 + mu_i l_i^2,  A_ij = (m_k / 2 + mu_k) l_i l_j with k = max(i, j),  B_i = (m_i / 2 + mu_i) l_i
// Runge-Kutta of fourth order.
#pragma once

#include <Eigen/Dense>
#include <vector>

namespace slew::multibody::testing {

struct PlanarRod {
  double mass = 0, length = 0;  // kg, m
};

class PlanarChain {
 public:
  // From rest along x. tip: kg at the end of the last rod.
  PlanarChain(const std::vector<PlanarRod>& rods, double tip, double gravity = 9.81);
  void run(double time, int steps);
  [[nodiscard]] std::vector<double> angles() const { return {theta_.data(), theta_.data() + theta_.size()}; }

 private:
  [[nodiscard]] Eigen::VectorXd accelerations(const Eigen::VectorXd& theta, const Eigen::VectorXd& omega) const;

  Eigen::MatrixXd A_;
  Eigen::VectorXd B_, theta_, omega_;
  double gravity_;
};

}  // namespace slew::multibody::testing
