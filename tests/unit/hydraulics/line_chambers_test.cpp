// SPDX-License-Identifier: Apache-2.0
// Chambers as transmission lines: the oil stays constant in any state of the line and at every conversion.
#include "hydraulics/line_chambers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "core/state_bytes.h"
#include "core/state_hash.h"
#include "hydraulics/circuit_integrator.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace slew::hydraulics::test {
namespace line_chambers_test {

constexpr double kStep = 1e-3;  // s
constexpr int kLift = 0;

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

class LiftLines : public ::testing::Test {
 protected:
  LiftLines() { integrator.start(kCraneStrokes, kAtRest, kCraneForces); }
  double pressure(int volume) const { return integrator.state()[at(volume)]; }
  // the piston at constant speed, exchanged every step
  void move(double speed, int steps) {
    std::vector<double> x, v(3, 0);
    for (const ActuatorLinearisation& actuator : integrator.actuators()) x.push_back(actuator.x);
    x[kLift] = x_lift;
    v[kLift] = speed;
    for (int n = 0; n < steps; ++n) {
      integrator.align(x, v);
      static_cast<void>(integrator.step(kStep, HeldSpeed(3)));
      x_lift += speed * kStep;
      x[kLift] = x_lift;
    }
    integrator.align(x, std::vector<double>(3, 0));
  }

  const HydraulicsDef def = crane_circuit();
  Circuit circuit{def};
  CircuitIntegrator integrator{circuit, def};
  double x_lift = kCraneStrokes[kLift];
};

TEST_F(LiftLines, AtRestPushAsTheChambersDid) {
  const ActuatorLinearisation before = integrator.actuators()[kLift];
  integrator.set_line(kLift, true, kStep);
  integrator.refresh();
  const ActuatorLinearisation& line = integrator.actuators()[kLift];
  EXPECT_NEAR(line.F, before.F, 1e-12 * before.F);
  EXPECT_NEAR(line.stiffness, before.K, 1e-12 * before.K);
  EXPECT_EQ(line.K, 0);
  EXPECT_EQ(line.F_dot, 0);
  // Z = sum S^2 H / C, hoses not among them: more than K H
  EXPECT_GT(line.D, before.K * kStep);
  integrator.set_line(kLift, false, kStep);
  integrator.refresh();
  EXPECT_NEAR(integrator.actuators()[kLift].F, before.F, 1e-9 * before.F);
}

TEST_F(LiftLines, KeepTheOilOfAPistonThatComesBack) {
  // closed valves: in 20 ms by 0.5 mm and back, then lumped; as a volume it does the same, but for what leaks on the
  // way
  const Actuator& lift = circuit.actuators()[kLift];
  double p_a[2] = {}, p_b[2] = {};
  for (const bool is_line : {false, true}) {
    integrator.start(kCraneStrokes, kAtRest, kCraneForces);
    x_lift = kCraneStrokes[kLift];
    integrator.set_line(kLift, is_line, kStep);
    move(0.025, 20);
    move(-0.025, 20);
    move(0, 200);
    integrator.set_line(kLift, false, kStep);
    p_a[is_line] = pressure(lift.port_a);
    p_b[is_line] = pressure(lift.port_b);
  }
  EXPECT_NEAR(p_a[1], p_a[0], 5e-3 * p_a[0]);
  EXPECT_NEAR(p_b[1], p_b[0], 5e-3 * p_b[0]);
}

TEST_F(LiftLines, CompressTheirOilAsAVolumeDoes) {
  const Actuator& lift = circuit.actuators()[kLift];
  double p_a[2] = {};
  for (const bool is_line : {false, true}) {
    integrator.start(kCraneStrokes, kAtRest, kCraneForces);
    x_lift = kCraneStrokes[kLift];
    integrator.set_line(kLift, is_line, kStep);
    // in by 0.5 mm
    move(-0.025, 20);
    move(0, 200);
    integrator.set_line(kLift, false, kStep);
    p_a[is_line] = pressure(lift.port_a);
  }
  EXPECT_GT(p_a[0], 1e6 + circuit.lowest_pressure());
  EXPECT_NEAR(p_a[1], p_a[0], 5e-3 * p_a[0]);
}

TEST_F(LiftLines, WithRoomWithoutOilGoOnFromTheirSavedState) {
  integrator.set_line(kLift, true, kStep);
  move(2, 60);
  const LineState& line = circuit.lines()[2 * kLift].state;
  ASSERT_GT(line.room, 0) << line.p << " " << line.c_h << " " << line.c_m << " " << line.held;
  std::vector<std::byte> saved;
  StateWriter writer(saved, {1, 1});
  integrator.save(writer);
  writer.finish();
  Circuit other_circuit(def);
  CircuitIntegrator other(other_circuit, def);
  StateReader reader(saved, {1, 1});
  other.load(reader);
  ASSERT_TRUE(reader.finish("lines").is_ok());
  const auto go_on = [this](CircuitIntegrator& one) {
    std::vector<double> x, v(3, 0);
    for (const ActuatorLinearisation& actuator : integrator.actuators()) x.push_back(actuator.x);
    for (int n = 0; n < 30; ++n) {
      x[kLift] = x_lift - 1e-3 * n;
      one.align(x, v);
      static_cast<void>(one.step(kStep, HeldSpeed(3)));
    }
    StateHash hash;
    one.add_to(hash);
    return hash.digest();
  };
  EXPECT_EQ(go_on(other), go_on(integrator));
}

// Between two pressures int kappa dp = ln(V_0/V_1), from (1) of oil.h.
TEST(OilContent, IsTheLogarithmOfTheOilsVolume) {
  for (const double air : {0.0, 0.005, 0.05}) {
    HydraulicsDef def;
    def.entrained_air = air;
    const OilCompressibility oil(def);
    const auto volume = [&def, air](double p) {
      return std::exp(-(p - def.air_reference_pressure) / def.oil_bulk_modulus) +
             air * std::pow(def.air_reference_pressure / p, 1 / def.polytropic_exponent);
    };
    for (const double from : {def.pressure_floor, 2e4, 1e5, 1e6}) {
      for (const double to : {1e5, 1.7e5, 1e6, 4e7}) {
        const double right = std::log(volume(from) / volume(to));
        EXPECT_NEAR(oil.content(to) - oil.content(from), right, 1e-6 * std::fabs(right) + 1e-15)
            << air << " " << from << " " << to;
      }
    }
  }
}

TEST_F(LiftLines, JacobianIsTheDerivativeOfTheRates) {
  integrator.set_line(kLift, true, kStep);
  move(0.02, 5);
  const int n = circuit.state_count();
  std::vector<double> y(integrator.state().begin(), integrator.state().end()), f(at(n)), low(at(n)), high(at(n));
  y[at(circuit.speed(kLift))] = 0.02;
  circuit.rates(y.data(), f.data());
  const double* jacobian = circuit.jacobian(y.data(), f.data());
  const std::vector<double> J(jacobian, jacobian + n * n);
  const Actuator& lift = circuit.actuators()[kLift];
  for (const int j : {lift.port_a, lift.port_b, circuit.speed(kLift), circuit.position(kLift)}) {
    const double h = 1e-5 * circuit.scales()[at(j)], kept = y[at(j)];
    y[at(j)] = kept + h;
    circuit.rates(y.data(), high.data());
    y[at(j)] = kept - h;
    circuit.rates(y.data(), low.data());
    y[at(j)] = kept;
    for (const int i : {lift.port_a, lift.port_b}) {
      const double slope = (high[at(i)] - low[at(i)]) / (2 * h);
      // on the scale of a volume against its line
      const double scale = 1e-4 * std::fabs(J[at(i * n + i)]) * circuit.scales()[at(i)] / circuit.scales()[at(j)];
      EXPECT_NEAR(J[at(i * n + j)], slope, scale) << i << " " << j;
    }
  }
}

}  // namespace line_chambers_test
}  // namespace slew::hydraulics::test
