// SPDX-License-Identifier: Apache-2.0
#include "tests/validation/cosimulation/split_masses.h"

#include <algorithm>
#include <cmath>

#include "tests/support/reference_algebra.h"

namespace slew::cosimulation {
namespace {

using Matrix = testing::Dense<double>;
using Vector = testing::Dense<double>;

// the pressure force and nothing else
class Line final : public coupling::RowLaws {
 public:
  coupling::RowForce evaluate(std::size_t, double z, double, double) const noexcept override { return {z, 1, 0, 0}; }
};

constexpr double kMicroStep = 0.25e-3;  // s, as the mechanics node's

}  // namespace

SplitMasses::SplitMasses(const TwoMasses& of, double lambda, Scheme scheme, double H, double max_substep)
    : of_(of),
      lambda_(lambda),
      H_(H),
      scheme_(scheme),
      substeps_(std::max(1, static_cast<int>(std::ceil(H / max_substep * (1 - 1e-9))))),
      oil_{-of.kc * (y_[0] - y_[2]), y_[0] - y_[2], y_[1] - y_[3]} {}

// with the springs to the walls inside: M + H D + H^2/2 K
SplitMasses::Reduced SplitMasses::reduced(double over) const {
  const double M1 = of_.m1 + over * of_.c1 + over * over / 2 * of_.k1;
  const double M2 = of_.m2 + over * of_.c2 + over * over / 2 * of_.k2;
  const double f1 = -of_.k1 * (y_[0] + over * y_[1]) - of_.c1 * y_[1];
  const double f2 = -of_.k2 * (y_[2] + over * y_[3]) - of_.c2 * y_[3];
  return {f1 / M1 - f2 / M2, 1 / M1 + 1 / M2};
}

State SplitMasses::rate(const State& y, double F) const {
  return {y[1], (F - of_.k1 * y[0] - of_.c1 * y[1]) / of_.m1, y[3], (-F - of_.k2 * y[2] - of_.c2 * y[3]) / of_.m2};
}

void SplitMasses::step() {
  const double x = y_[0] - y_[2], v = y_[1] - y_[3];
  Reduced known{0, 0};
  if (scheme_.oil != Known::speed_held) known = reduced(scheme_.oil == Known::mobility_of_the_step ? H_ : 0);
  move_masses();
  move_oil(x, v, known);
}

void SplitMasses::move_masses() {
  const double h = H_ / substeps_;
  const int micro_steps = std::max(1, static_cast<int>(std::ceil(h / kMicroStep - 1e-9)));
  coupling::RowPartner partner;
  F_ = oil_[0];
  if (scheme_.mechanics == Force::linear) {
    partner = {-of_.kc * oil_[2] - lambda_ * oil_[0], of_.kc, lambda_, 0, oil_[0], oil_[2]};
    F_ -= of_.kc * (y_[0] - y_[2] - oil_[1]);
  }
  for (int i = 0; i < substeps_; ++i) {
    const Reduced now = reduced(0);
    port_.set_rows(1);
    port_.x()[0] = y_[0] - y_[2];
    port_.v()[0] = y_[1] - y_[3];
    port_.z()[0] = F_;
    port_.a_free()[0] = now.a_free;
    port_.W()[0] = now.W;
    port_.partner()[0] = partner;
    Line line;
    port_.solve(h, micro_steps, line);
    const double mean = port_.f_mean()[0], slope = port_.f_slope()[0];
    const State k1 = rate(y_, mean - h / 2 * slope), k2 = rate(y_ + h / 2 * k1, mean), k3 = rate(y_ + h / 2 * k2, mean),
                k4 = rate(y_ + h * k3, mean + h / 2 * slope);
    y_ += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    // the force follows the true way
    F_ = port_.z()[0] - partner.K * (y_[0] - y_[2] - port_.x()[0]);
  }
}

void SplitMasses::move_oil(double x, double v, const Reduced& known) {
  Matrix A(4, 4);
  A(0, 0) = -lambda_;
  A(0, 2) = -of_.kc;
  A(1, 2) = 1;
  A(2, 0) = known.W;
  A(2, 3) = known.a_free;
  const Vector start = Vector::column({oil_[0] - of_.kc * (x - oil_[1]), x, v, 1});
  const Vector end = testing::exponential(A * H_) * start;
  oil_ = {end[0], end[1], end[2]};
}

State exact_with_oil(const TwoMasses& s, double lambda, double time) {
  Matrix A(5, 5);
  A(0, 1) = A(2, 3) = 1;
  A(1, 0) = -s.k1 / s.m1, A(1, 1) = -s.c1 / s.m1, A(1, 4) = 1 / s.m1;
  A(3, 2) = -s.k2 / s.m2, A(3, 3) = -s.c2 / s.m2, A(3, 4) = -1 / s.m2;
  A(4, 1) = -s.kc, A(4, 3) = s.kc, A(4, 4) = -lambda;
  const Vector start = Vector::column({kStart[0], kStart[1], kStart[2], kStart[3], -s.kc * (kStart[0] - kStart[2])});
  const Vector end = testing::exponential(A * time) * start;
  return {end[0], end[1], end[2], end[3]};
}

}  // namespace slew::cosimulation
