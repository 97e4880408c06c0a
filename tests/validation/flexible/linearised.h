// SPDX-License-Identifier: Apache-2.0
// Frequencies of a mechanism about a state of rest, from its accelerations at displaced coordinates.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "math/rotation.h"
#include "tests/support/reference_algebra.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody::testing {

// Springs along the rows, which carry what holds the mechanism.
struct RowSpring {
  double force = 0, stiffness = 0;  // N, N/m
};

class Linearised {
 public:
  Linearised(Mechanism& mechanism, std::vector<RowSpring> springs) : m_(mechanism), springs_(std::move(springs)) {
    std::fill(m_.state.u.begin(), m_.state.u.end(), 0.0);
    evaluate(m_.model, m_.state, m_.ws);
    rest_.assign(row_positions(m_.ws).begin(), row_positions(m_.ws).end());
  }

  // residual of the equilibrium [m/s2, rad/s2, 1/s2 of modes]
  [[nodiscard]] double unrest() {
    double worst = 0;
    for (const double a : accelerations_at(m_.state)) worst = std::max(worst, std::fabs(a));
    return worst;
  }

  // [Hz], ascending; without what moves freely
  [[nodiscard]] std::vector<double> frequencies() {
    const auto n = static_cast<slew::testing::Index>(m_.state.u.size());
    slew::testing::Dense<double> A(n, n);
    for (std::size_t k = 0; k < m_.state.u.size(); ++k) {
      const std::vector<double> above = accelerations_at(displaced(k, kStep)),
                                below = accelerations_at(displaced(k, -kStep));
      for (slew::testing::Index i = 0; i < n; ++i) {
        const auto at = static_cast<std::size_t>(i);
        A(i, static_cast<slew::testing::Index>(k)) = -(above[at] - below[at]) / (2 * kStep);
      }
    }
    std::vector<double> f;
    for (const std::complex<double> square : slew::testing::eigenvalues(A)) {
      const double hertz = std::sqrt(std::abs(square)) / (2 * M_PI);
      if (hertz < 0.01) continue;
      EXPECT_LT(std::fabs(square.imag()), 1e-6 * square.real());
      f.push_back(hertz);
    }
    std::sort(f.begin(), f.end());
    return f;
  }

 private:
  static constexpr double kStep = 1e-5;  // rad, m sqrt(kg)

  // one coordinate moved along its own speed
  [[nodiscard]] State displaced(std::size_t k, double step) {
    State moved = m_.state;
    moved.u[k] = 1;
    observe(m_.model, moved, m_.ws);
    for (std::size_t i = 1; i < m_.model.links.size(); ++i) {
      const Link& link = m_.model.links[i];
      const auto q = static_cast<std::size_t>(link.q), u = static_cast<std::size_t>(link.u);
      if (link.joint == LinkJoint::revolute) moved.q[q] += step * moved.u[u];
      if (link.joint != LinkJoint::spherical) continue;
      const math::Quaternion turned = math::turn_by(m_.ws.motion[i].w * step) *
                                      math::Quaternion{moved.q[q], moved.q[q + 1], moved.q[q + 2], moved.q[q + 3]};
      moved.q[q] = turned.w, moved.q[q + 1] = turned.x, moved.q[q + 2] = turned.y, moved.q[q + 3] = turned.z;
    }
    for_each_mode(m_.model, [&](std::size_t q, std::size_t u) { moved.q[q] += step * moved.u[u]; });
    moved.u[k] = 0;
    return moved;
  }

  [[nodiscard]] std::vector<double> accelerations_at(const State& state) {
    evaluate(m_.model, state, m_.ws);
    std::vector<double> forces, udot(state.u.size());
    for (std::size_t row = 0; row < springs_.size(); ++row) {
      forces.push_back(springs_[row].force - springs_[row].stiffness * (row_positions(m_.ws)[row] - rest_[row]));
    }
    accelerations(m_.model, m_.ws, forces, udot);
    return udot;
  }

  Mechanism& m_;
  std::vector<RowSpring> springs_;
  std::vector<double> rest_;
};

}  // namespace slew::multibody::testing
