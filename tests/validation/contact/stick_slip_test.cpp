// SPDX-License-Identifier: Apache-2.0
// Case D01: a mass dragged by a spring sticks and slips (Canudas de Wit et al. 1995, fig. 5); reference of
// data/lugre_stick_slip.csv, whose end is the published one of EXUDYN's lugreFrictionODE1. Tolerances of the case: x
// 1e-3, onset of slip 0.02 s. The reference has a constant sigma_1; ours is limited above 3 mm/s, which moves x
// by 1.5e-4.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "contact/friction_law.h"
#include "tests/validation/multibody/csv_table.h"

namespace slew::contact {
namespace stick_slip_test {

using math::Vec3;
using multibody::testing::read_table;

constexpr double kMass = 1, kSpring = 2, kDragSpeed = 0.1;

FrictionLaw dragged_law() {
  return build({.stiffness = 1e5,
                .damping = std::sqrt(1e5),
                .stribeck_speed = 1e-3,
                .viscosity = 0.4,
                .static_coefficient = 1.5,
                .dynamic_coefficient = 1});
}

SlidingContact pressed(double v) {
  return {.n_W = {0, 0, 1}, .v_W = {v, 0, 0}, .normal_force = 1};
}

struct Sample {
  double x = 0, v = 0, z = 0, force = 0;
};

// backward Euler of (x, v) with the law's own bristles at the end of the step; Newton over v
class ImplicitMass {
 public:
  explicit ImplicitMass(double h) : h_(h) {}

  void step(double t_end) {
    double v = now_.v;
    FrictionForce friction;
    for (int i = 0; i < 50; ++i) {
      friction = evaluate(law_, pressed(v), h_, {Vec3(now_.z, 0, 0)});
      const double drive = kSpring * (kDragSpeed * t_end - now_.x - h_ * v);
      const double residual = kMass * (v - now_.v) - h_ * (drive - friction.f_W[0]);
      const double slope = kMass + h_ * (h_ * kSpring + friction.d_velocity(0, 0));
      const double change = -residual / slope;
      v += change;
      if (std::fabs(change) < 1e-15) break;
    }
    friction = evaluate(law_, pressed(v), h_, {Vec3(now_.z, 0, 0)});
    now_ = {now_.x + h_ * v, v, friction.z_W[0], friction.f_W[0]};
  }
  [[nodiscard]] const Sample& now() const { return now_; }

 private:
  FrictionLaw law_ = dragged_law();
  double h_;
  Sample now_;
};

// the continuous equations, fourth-order Runge-Kutta
Sample rates(const FrictionLaw& law, double t, const Sample& y) {
  const Vec3 z(y.z, 0, 0);
  const double force = evaluate(law, pressed(y.v), 0, {z}).f_W[0];
  return {y.v, (kSpring * (kDragSpeed * t - y.x) - force) / kMass, bristle_rate(law, pressed(y.v), z)[0], force};
}

Sample moved(const Sample& y, const Sample& rate, double h) {
  return {y.x + h * rate.x, y.v + h * rate.v, y.z + h * rate.z, 0};
}

Sample runge_kutta(const FrictionLaw& law, double t, double h, const Sample& y) {
  const Sample k1 = rates(law, t, y), k2 = rates(law, t + h / 2, moved(y, k1, h / 2));
  const Sample k3 = rates(law, t + h / 2, moved(y, k2, h / 2)), k4 = rates(law, t + h, moved(y, k3, h));
  Sample sum = moved(y, k1, h / 6);
  sum = moved(moved(moved(sum, k2, h / 3), k3, h / 3), k4, h / 6);
  return sum;
}

constexpr double kOnsets[] = {7.46, 13.83, 20.19};

TEST(StickSlip, FollowsTheTableWithTheContinuousEquations) {
  const FrictionLaw law = dragged_law();
  const auto table = read_table("lugre_stick_slip.csv");
  ASSERT_EQ(table.size(), 2501u);
  Sample y;
  std::vector<double> onsets;
  double worst = 0, peak = 0;
  bool slips = false;
  const int per_row = 500;
  const double h = 0.01 / per_row;
  for (std::size_t row = 1; row < table.size(); ++row) {
    for (int i = 0; i < per_row; ++i) {
      const double t = table[row - 1][0] + i * h;
      y = runge_kutta(law, t, h, y);
      peak = std::max(peak, evaluate(law, pressed(y.v), 0, {Vec3(y.z, 0, 0)}).f_W[0]);
      const bool slips_now = y.v > 0.01;
      if (slips_now && !slips) onsets.push_back(t + h);
      slips = slips_now;
    }
    worst = std::max(worst, std::fabs(y.x - table[row][1]));
  }
  RecordProperty("worst_x_error_um", std::to_string(worst * 1e6));
  EXPECT_LT(worst, 3e-4);
  EXPECT_NEAR(y.x, 1.908839199226505, 1e-3);
  EXPECT_NEAR(y.z, 1.1816795455868868e-05, 1e-3 * 1.2e-5 * 10);
  EXPECT_NEAR(peak, 1.47657, 1e-3);
  ASSERT_EQ(onsets.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(onsets[i], kOnsets[i], 0.02);
}

// sub-steps of 0.1 ms, five times the limit of an explicit method while slipping
TEST(StickSlip, FollowsTheTableInImplicitSubSteps) {
  const auto table = read_table("lugre_stick_slip.csv");
  const double h = 1e-4;
  ImplicitMass mass(h);
  std::vector<double> onsets;
  bool slips = false;
  for (int i = 1; i <= 250000; ++i) {
    mass.step(i * h);
    const bool slips_now = mass.now().v > 0.01;
    if (slips_now && !slips) onsets.push_back(i * h);
    slips = slips_now;
  }
  EXPECT_NEAR(mass.now().x, 1.908839199226505, 1e-3);
  ASSERT_EQ(onsets.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(onsets[i], kOnsets[i], 0.02);
}

TEST(SteadySliding, FollowsTheStribeckCurve) {
  const FrictionLaw law = dragged_law();
  const double speed[] = {1e-4, 5e-4, 1e-3, 5e-3, 0.1};
  const double force[] = {1.49506491687, 1.38960039154, 1.18433972059, 1.00200000001, 1.04};
  for (int i = 0; i < 5; ++i) {
    // long enough for any start to be forgotten
    EXPECT_NEAR(evaluate(law, pressed(speed[i]), 10, {}).f_W[0], force[i], 1e-10 * force[i]);
  }
}

}  // namespace stick_slip_test
}  // namespace slew::contact
