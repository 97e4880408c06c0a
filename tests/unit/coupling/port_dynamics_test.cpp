// SPDX-License-Identifier: Apache-2.0
#include "coupling/port_dynamics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/allocation_guard.h"
#include "coupling/line_force.h"

namespace slew::coupling {
namespace port_dynamics_test {

// f = z on every row
class PassThrough final : public RowLaws {
 public:
  RowForce evaluate(std::size_t, double z, double, double) const noexcept override { return {z, 1, 0, 0}; }
};

class OneCylinder final : public RowLaws {
 public:
  explicit OneCylinder(const LineForceDef& def) : law_(def) {}
  RowForce evaluate(std::size_t, double z, double x, double v) const noexcept override {
    const LineForce line = law_.evaluate(z, x, v);
    return {line.force, line.d_pressure, line.d_position, line.d_speed, line.stop};
  }
  bool is_at_stop(std::size_t, double x) const noexcept override { return law_.touches_stop(x); }

 private:
  LineForceLaw law_;
};

// mass 1/W on an oil spring K without leakage: x(t) = x0 cos(omega t) about x_ref = 0
double oscillator_error(double h, int micro_steps) {
  const double W = 1.0 / 42e3;
  const double K = 1.6e8;
  const double omega = std::sqrt(K * W);
  PortDynamics ports(1);
  ports.x()[0] = 1e-3;
  ports.v()[0] = 0;
  ports.z()[0] = -K * 1e-3;
  ports.a_free()[0] = 0;
  ports.W()[0] = W;
  ports.partner()[0] = {0, K, 0, 0, 0, 0};
  PassThrough laws;
  const int steps = static_cast<int>(std::lround(0.2 / h));
  for (int i = 0; i < steps; ++i) ports.solve(h, micro_steps, laws);
  return std::fabs(ports.x()[0] - 1e-3 * std::cos(omega * 0.2)) / 1e-3;
}

TEST(PortDynamics, OilSpringIsSolvedToSecondOrder) {
  const double coarse = oscillator_error(1e-3, 1);
  const double fine = oscillator_error(1e-3, 4);
  EXPECT_LT(fine, 2e-3);
  EXPECT_NEAR(std::log2(coarse / fine) / 2, 2.0, 0.3);
}

// two masses on one volume, K [1 1; 1 1]: they swing together with 2 K W, and against each other without any force
TEST(PortDynamics, CoupledRowsShareTheirSpring) {
  constexpr double kMobility = 1.0 / 42e3, kSpring = 0.8e8, kTime = 0.05, kSwing = 1e-3, kDrift = 0.01;
  const double omega = std::sqrt(2 * kSpring * kMobility);
  const auto error = [&](int steps) {
    PortDynamics ports(3);
    for (const std::size_t i : {0u, 1u, 2u}) {
      ports.W()[4 * i] = kMobility;
      if (i == 2) continue;  // a row apart
      ports.x()[i] = kSwing;
      ports.v()[i] = i == 0 ? kDrift : -kDrift;
      ports.z()[i] = -2 * kSpring * kSwing;
      ports.partner()[i] = {.K = kSpring, .v_ref = 0.3};  // what v_ref takes from the force, F_dot gives
      ports.partner()[i].F_dot = -2 * kSpring * 0.3;
    }
    const std::span<double> K = ports.couple();
    K[1] = K[3] = kSpring;
    PassThrough laws;
    for (int i = 0; i < steps; ++i) EXPECT_TRUE(ports.solve(kTime / steps, 1, laws).has_converged);
    EXPECT_EQ(ports.x()[2], 0);
    const double swing = kSwing * std::cos(omega * kTime);
    return std::max(std::fabs(ports.x()[0] - swing - kDrift * kTime), std::fabs(ports.x()[1] - swing + kDrift * kTime));
  };
  const double coarse = error(200), fine = error(400);
  EXPECT_LT(fine, 1e-3 * kSwing);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.1);
  PortDynamics ports(2);
  (void)ports.couple();
  ports.set_rows(2);  // no longer coupled
  ports.v()[1] = 1;
  ports.partner()[0] = ports.partner()[1] = {.K = kSpring};
  ports.W()[0] = kMobility;
  PassThrough laws;
  (void)ports.solve(1e-3, 4, laws);
  EXPECT_EQ(ports.v()[0], 0);
}

TEST(PortDynamics, PartnerForceFollowsItsLeakage) {
  // held piston: F' = F_dot - lambda (F - F_n) goes to F_n + F_dot / lambda
  PortDynamics ports(1);
  ports.z()[0] = 1000;
  ports.W()[0] = 0;
  ports.partner()[0] = {500, 1e8, 50, 0, 1000, 0};
  PassThrough laws;
  for (int i = 0; i < 1000; ++i) ports.solve(1e-3, 2, laws);
  EXPECT_NEAR(ports.z()[0], 1000 + 500 / 50.0, 1e-6);
}

TEST(PortDynamics, StickingCylinderStaysWhereItIs) {
  // 28 kN of friction against 5 kN of drive, slope 2.8e8 N s/m on 6.6 t: 4e4 1/s
  LineForceDef def;
  def.friction_curve = {{0, 0}, {1e-4, 1}, {0.025, 0.9}};
  def.efficiency = 0.9;
  def.stroke_max = 1;
  OneCylinder laws(def);
  PortDynamics ports(1);
  ports.x()[0] = 0.5;
  ports.z()[0] = 280e3;
  ports.a_free()[0] = (-280e3 + 5e3) / 6600.0;
  ports.W()[0] = 1 / 6600.0;
  double largest = 0;
  for (int i = 0; i < 1000; ++i) {
    EXPECT_TRUE(ports.solve(1e-3, 4, laws).has_converged);
    largest = std::max(largest, std::fabs(ports.v()[0]));
  }
  // creep speed of the regularised law: 1e-4 m/s * 5 kN / 28 kN
  EXPECT_NEAR(ports.v()[0], 1e-4 * 5 / 28, 1e-7);
  EXPECT_LT(largest, 2e-5);
}

TEST(PortDynamics, EndStopBringsAMovingMassToRest) {
  LineForceDef def;
  def.stroke_max = 1.0;
  def.stop_stiffness = 5e7;
  def.stop_damping = 5e5;
  OneCylinder laws(def);
  PortDynamics ports(1);
  ports.x()[0] = 0.999;
  ports.v()[0] = 0.5;
  ports.W()[0] = 1 / 5000.0;
  ports.a_free()[0] = 2.0;  // pushed against the stop with 10 kN
  double deepest = 0;
  for (int i = 0; i < 2000; ++i) {
    EXPECT_TRUE(ports.solve(1e-3, 4, laws).has_converged);
    deepest = std::max(deepest, ports.x()[0] - 1.0);
  }
  EXPECT_NEAR(ports.x()[0] - 1.0, 10e3 / 5e7, 1e-6);
  EXPECT_LT(deepest, 0.5 * std::sqrt(5000 / 5e7));  // less than without the damper
}

// a mass between its end stop and an oil spring: neither gives what it did not hold, however stiff, and a stop that
// only damps does not throw back
TEST(PortDynamics, EndStopReturnsNoMoreThanItsSpringHeld) {
  for (const double stop : {0.0, 1e3, 1e7, 1e9, 1e12}) {
    for (const double per_step : {0.0, 1e-2, 1.0, 1e2, 1e4, 1e6}) {
      SCOPED_TRACE("k = " + std::to_string(stop) + ", c h/m = " + std::to_string(per_step));
      constexpr double kMass = 2000, kOil = 4e6, kPlace = 0.05;
      LineForceDef def;
      def.stroke_min = -1;
      def.stroke_max = 0.002;
      def.stop_stiffness = stop;
      def.stop_damping = per_step * kMass / 1e-3;
      OneCylinder laws(def);
      PortDynamics ports(1);
      ports.v()[0] = 1.5;
      ports.W()[0] = 1 / kMass;
      ports.z()[0] = -kOil * kPlace;
      ports.partner()[0] = {0, kOil, 0, 0, 0, 0};
      const auto energy = [&] {
        const double depth = std::max(0.0, ports.x()[0] - def.stroke_max), oil = ports.x()[0] + kPlace;
        return 0.5 * kMass * ports.v()[0] * ports.v()[0] + 0.5 * stop * depth * depth + 0.5 * kOil * oil * oil;
      };
      const double start = energy();
      double least = start;
      for (int i = 0; i < 300; ++i) {
        ASSERT_TRUE(ports.solve(1e-3, 4, laws).has_converged) << i;
        ASSERT_LT(energy(), least + 1e-3 * start) << i;
        least = std::min(least, energy());
      }
    }
  }
}

// What a stop did in a part of the sub-step is in mean and slope: under them the mass goes where the rows' problem
// went.
TEST(PortDynamics, MeanAndSlopeOfABlowGoTheSameWay) {
  for (const double x : {-0.0021, -0.0017, -0.0003, 0.0011, 0.0019}) {
    LineForceDef def;
    def.stroke_max = 0.002;
    def.stroke_min = -1;
    def.stop_stiffness = 1e10;
    def.stop_damping = 1e6;
    OneCylinder laws(def);
    constexpr double kMass = 2000, h = 1e-3;
    PortDynamics ports(1);
    ports.x()[0] = x;
    ports.v()[0] = 4;
    ports.W()[0] = 1 / kMass;
    const PortStep solved = ports.solve(h, 4, laws);
    EXPECT_EQ(solved.meets_stop, x > -0.002);
    const double mean = ports.f_mean()[0] / kMass, slope = ports.f_slope()[0] / kMass;
    EXPECT_NEAR(4 + h * mean, ports.v()[0], 1e-9);
    EXPECT_NEAR(x + 4 * h + 0.5 * h * h * mean - h * h * h / 12 * slope, ports.x()[0], 2e-6);
  }
}

// a force that is linear in time, by a partner without stiffness: z' = F_dot
// a stop that pushes while v is below its speed, and not above: no speed has a force between the two; beside it a
// damper
class JumpAndDamper final : public RowLaws {
 public:
  RowForce evaluate(std::size_t row, double, double, double v) const noexcept override {
    if (row == 0) return {v < kSpeed ? 2.7e5 : 0.0, 0, 0, 0};
    return {-kDamping * v, 0, 0, -kDamping};
  }
  static constexpr double kSpeed = 0.13, kDamping = 1e4;
};

TEST(PortDynamics, TakesAForceBetweenTheSidesOfAJump) {
  // the first row is pulled down and held at its jump
  PortDynamics ports(2);
  const double W[4] = {0.02, 0.004, 0.004, 0.03}, pull = 90;
  ports.v()[0] = JumpAndDamper::kSpeed;
  ports.v()[1] = 0.2;
  ports.a_free()[0] = -pull;
  ports.a_free()[1] = 10;
  std::copy(W, W + 4, ports.W().begin());
  JumpAndDamper laws;
  const PortStep step = ports.solve(1e-3, 4, laws);
  EXPECT_TRUE(step.has_converged) << step.residual;
  EXPECT_NEAR(ports.v()[0], JumpAndDamper::kSpeed, 1e-8);
  // W f = pull keeps it there
  EXPECT_NEAR(W[0] * ports.f_mean()[0] + W[1] * ports.f_mean()[1], pull, 1e-4 * pull);
}

TEST(PortDynamics, SettlesTwoJumpsThatMoveEachOther) {
  class Jumps final : public RowLaws {
   public:
    RowForce evaluate(std::size_t row, double, double, double v) const noexcept override {
      return row == 0 ? RowForce{v < 0.13 ? 2.7e5 : 0.0, 0, 0, 0} : RowForce{v < -0.2 ? 1e4 : 0.0, 0, 0, 0};
    }
  };
  PortDynamics ports(2);
  const double W[4] = {0.02, 0.004, 0.004, 0.03}, pull[2] = {90, 40};
  std::copy(W, W + 4, ports.W().begin());
  ports.v()[0] = 0.13;
  ports.v()[1] = -0.2;
  for (std::size_t i = 0; i < 2; ++i) ports.a_free()[i] = -pull[i];
  Jumps laws;
  const PortStep step = ports.solve(1e-3, 4, laws);
  EXPECT_TRUE(step.has_converged) << step.residual;
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(W[2 * i] * ports.f_mean()[0] + W[2 * i + 1] * ports.f_mean()[1], pull[i], 1e-4 * pull[i]) << i;
  }
}

TEST(PortDynamics, GivesMeanAndSlopeOfALinearForce) {
  PortDynamics ports(1);
  ports.W()[0] = 3e-5;
  ports.partner()[0] = {.F_dot = -7e5};
  const double h = 1e-3, gamma = 1 - std::sqrt(0.5);
  for (const int micro_steps : {1, 4, 64}) {
    ports.z()[0] = 4000;
    PassThrough laws;
    ports.solve(h, micro_steps, laws);
    EXPECT_NEAR(ports.f_mean()[0], 4000 - 7e5 * h / 2, 1e-9 * 4000);
    // second moment of the stages at gamma and 1, against 1/3
    const double excess = 12 * ((1 - gamma) * gamma * gamma + gamma - 1.0 / 3) / (micro_steps * micro_steps);
    EXPECT_NEAR(ports.f_slope()[0], -7e5 * (1 + excess), 1e-9 * 7e5) << micro_steps;
  }
}

// a damper that holds against a force that grows: 1 kg, 1e9 N s/m
TEST(PortDynamics, GivesTheSlopeOfAFrictionThatHolds) {
  class Damper final : public RowLaws {
   public:
    RowForce evaluate(std::size_t, double, double, double v) const noexcept override { return {-1e9 * v, 0, 0, -1e9}; }
  };
  PortDynamics ports(1);
  ports.W()[0] = 1;
  ports.a_free()[0] = 5;
  ports.a_free_rate()[0] = 3e4;
  ports.v()[0] = 5e-9;
  Damper laws;
  ports.solve(1e-3, 4, laws);
  EXPECT_NEAR(ports.f_mean()[0], -5 - 0.5 * 30, 1e-3);
  EXPECT_NEAR(ports.f_slope()[0], -3e4, 1e-4 * 3e4);
}

TEST(PortDynamics, MeanAndSlopeReproduceTheMotion) {
  PassThrough laws;
  PortDynamics ports(2);
  const double W[4] = {3e-5, -2.5e-5, -2.5e-5, 3e-5};
  std::copy(W, W + 4, ports.W().begin());
  ports.a_free()[0] = 1;
  ports.a_free()[1] = -2;
  ports.partner()[0] = {1e5, 1.6e8, 10, 0, 0, 0};
  ports.partner()[1] = {0, 1.2e8, 0, 2e4, 0, 0.01};
  const double x0[2] = {1e-3, 0}, v0[2] = {0.02, -0.01};
  // of the position that mean and slope give, from that of the solver's own fine steps
  const auto position_error = [&](double h) {
    std::copy(x0, x0 + 2, ports.x().begin());
    std::copy(v0, v0 + 2, ports.v().begin());
    ports.z()[0] = ports.z()[1] = 0;
    ports.solve(h, 64, laws);
    double error = 0;
    for (std::size_t i = 0; i < 2; ++i) {
      const auto row = [&](std::span<const double> f) { return W[2 * i] * f[0] + W[2 * i + 1] * f[1]; };
      EXPECT_NEAR(ports.v()[i], v0[i] + h * (ports.a_free()[i] + row(ports.f_mean())), 1e-14);
      const double x = x0[i] + h * v0[i] + h * h / 2 * (ports.a_free()[i] + row(ports.f_mean())) -
                       h * h * h / 12 * row(ports.f_slope());
      error = std::max(error, std::fabs(x - ports.x()[i]));
    }
    return error;
  };
  // the slope's share of the position at 1 ms is some 1e-8 m
  EXPECT_LT(position_error(1e-3), 2e-9);
  EXPECT_GT(std::log2(position_error(2e-3) / position_error(1e-3)), 2.5);
}

TEST(PortDynamics, ReportsThatANumberWasLost) {
  PortDynamics ports(1);
  ports.W()[0] = 1;
  ports.a_free()[0] = std::numeric_limits<double>::quiet_NaN();
  PassThrough laws;
  const PortStep step = ports.solve(1e-3, 1, laws);
  EXPECT_FALSE(step.has_converged);
  EXPECT_TRUE(std::isnan(step.residual));
}

TEST(PortDynamics, StatesTheResidualThatItStoppedAt) {
  // a jump so high that the halvings from its throw of 3e16 m/s down to it are more than the iterations
  class Wall final : public RowLaws {
   public:
    RowForce evaluate(std::size_t, double, double, double v) const noexcept override {
      return {v < 0 ? 1e20 : 0.0, 0, 0, 0};
    }
  };
  PortDynamics ports(1);
  ports.W()[0] = 1;
  ports.a_free()[0] = -1;
  Wall laws;
  const PortStep step = ports.solve(1e-3, 1, laws);
  EXPECT_FALSE(step.has_converged);
  EXPECT_GT(step.residual, 1e-4);
}

TEST(PortDynamics, DoesNotAllocate) {
  PassThrough laws;
  PortDynamics ports(3);
  ports.solve(1e-3, 4, laws);
  const AllocationGuard guard;
  for (int i = 0; i < 1000; ++i) ports.solve(1e-3, 4, laws);
  EXPECT_EQ(guard.allocations(), 0u);
}

}  // namespace port_dynamics_test
}  // namespace slew::coupling
