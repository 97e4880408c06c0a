// SPDX-License-Identifier: Apache-2.0
// Line with dynamics against closed forms: water hammer, natural frequencies, static friction, damping of its modes,
// minor losses, content.
#include "hydraulics/components/line.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "hydraulics/components/sources.h"
#include "tests/properties/hydraulics/crane_circuit.h"
#include "tests/support/circuit_rig.h"

namespace slew::hydraulics::test {
namespace line_test {

constexpr double kLength = 20, kDiameter = 0.02, kModulus = 1.4e9, kDensity = 850;
constexpr double kArea = std::numbers::pi / 4 * kDiameter * kDiameter;
const double kSpeedOfSound = std::sqrt(kModulus / kDensity);

// A reservoir at 51 bar, the line, a closed end from which a source takes the oil.
class Hammer : public CircuitRig {
 public:
  Hammer(int modes, double viscosity) {
    def.oil_density = kDensity, def.oil_viscosity = viscosity, def.oil_bulk_modulus = kModulus, def.entrained_air = 0;
    def.start = StartState::table13, def.relative_tolerance = 1e-6;
    add_tank(def, "Reservoir", 51 * kBar), add_tank(def, "Tank");
    add_volume(def, "End", 51 * kBar).rigid_volume = 1e-6;
    LineDef& line = add<LineDef>(def, "Line");
    line.port_1 = "Reservoir", line.port_2 = "End", line.length = kLength, line.diameter = kDiameter;
    line.modes = modes;
    FlowSourceDef& source = add<FlowSourceDef>(def, "Source");
    source.port_1 = "End", source.port_2 = "Tank", source.flow_per_signal = 1;
  }
  LineDef& line() { return dynamic_cast<LineDef&>(*def.components.front()); }
  double end() { return variable("End.pressure"); }
};

// The flow of the speed v stops at once: the pressure at the closed end is higher by rho c v for 2L/c, then lower by it
// for 2L/c (Joukowsky), since the friction of the thin oil is nothing.
TEST(ValidationLine, a_shut_end_has_the_pressure_and_period_of_joukowsky) {
  const double v = 0.5, joukowsky = kDensity * kSpeedOfSound * v, half = 2 * kLength / kSpeedOfSound;
  Hammer hammer(10, 1e-9);
  hammer.def.relative_tolerance = 1e-5;
  // brought to its speed over 2 s, so gently that no wave is left
  for (int k = 1; k <= 1000; ++k) {
    hammer.set_signal("Source", 0.5 * v * kArea * (1 - std::cos(std::numbers::pi * k / 1000)));
    hammer.run(2e-3, 2e-3);
  }
  const double before = hammer.end();
  EXPECT_NEAR(before, 51 * kBar, 2e-3 * joukowsky);
  hammer.set_signal("Source", 0);
  constexpr double kStep = 2e-4;
  std::vector<double> p;
  for (double t = 0; t < 4 * half; t += kStep) hammer.run(kStep, kStep), p.push_back(hammer.end() - before);
  const auto mean = [&](double from, double to) {
    double sum = 0;
    int count = 0;
    for (std::size_t k = 0; k < p.size(); ++k) {
      const double t = kStep * static_cast<double>(k + 1);
      if (t >= from && t <= to) sum += p[k], ++count;
    }
    return sum / count;
  };
  EXPECT_NEAR(mean(0.1 * half, 0.9 * half), joukowsky, 0.03 * joukowsky);
  EXPECT_NEAR(mean(1.1 * half, 1.9 * half), -joukowsky, 0.03 * joukowsky);
  EXPECT_NEAR(mean(2.1 * half, 2.9 * half), joukowsky, 0.03 * joukowsky);
  // its sign changes every 2L/c; means over a fifth of that have lost the ripple of the last mode
  const auto width = static_cast<std::size_t>(0.2 * half / kStep);
  std::vector<double> changes;
  double sum = 0, last = 0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    sum += p[k] - (k >= width ? p[k - width] : 0);
    if (k > width && last * sum < 0) changes.push_back(kStep * static_cast<double>(k));
    last = sum;
  }
  ASSERT_EQ(changes.size(), 3U);
  EXPECT_NEAR(changes[1] - changes[0], half, 0.02 * half);
  EXPECT_NEAR(changes[2] - changes[1], half, 0.02 * half);
}

// A step of the reservoir leaves a closed line with oscillations of period 4L/c whatever the number of modes.
TEST(ValidationLine, of_few_modes_has_the_frequency_of_the_quarter_wave) {
  for (const int modes : {1, 2, 5}) {
    Hammer hammer(modes, 1e-9);
    hammer.set_signal("Source", 1e-6);
    constexpr double kStep = 2e-4;
    const double period = 4 * kLength / kSpeedOfSound;
    std::vector<double> p;
    for (double t = 0; t < 10 * period; t += kStep) hammer.run(kStep, kStep), p.push_back(hammer.end());
    double mean = 0;
    for (const double one : p) mean += one / static_cast<double>(p.size());
    // of a smoothed signal, over a quarter of the period
    const auto width = static_cast<std::size_t>(period / 4 / kStep);
    std::vector<double> changes;
    double sum = 0, last = 0;
    for (std::size_t k = 0; k < p.size(); ++k) {
      sum += p[k] - mean - (k >= width ? p[k - width] - mean : 0);
      if (k > width && last < 0 && sum >= 0) changes.push_back(kStep * static_cast<double>(k));
      last = sum;
    }
    ASSERT_GE(changes.size(), 5U);
    const double measured = (changes.back() - changes.front()) / static_cast<double>(changes.size() - 1);
    // one mode has the first frequency of a line between volumes, and the rest of its content at the end: within 10 %
    EXPECT_NEAR(measured, period, (modes == 1 ? 0.12 : 0.03) * period) << modes;
  }
}

// The ends of a line at 10 bar fall to 2 bar at once: the two waves meet in the middle, whose pressure falls by twice 8
// bar, to -6 bar. The oil would cavitate there, and the step reports it.
TEST(ValidationLine, reports_that_its_own_oil_would_cavitate) {
  for (const double fall : {3.0, 8.0}) {
    HydraulicsDef def;
    def.start = StartState::table13;
    add_volume(def, "A", 10 * kBar).rigid_volume = 1e-3, add_volume(def, "B", 10 * kBar).rigid_volume = 1e-3;
    LineDef& line = add<LineDef>(def, "Line");
    line.port_1 = "A", line.port_2 = "B", line.length = kLength, line.diameter = kDiameter;
    for (const char* end : {"A", "B"}) {
      PressureSourceDef& source = add<PressureSourceDef>(def, std::string("Source_") + end);
      source.port_1 = end, source.set_pressure = (10 - fall) * kBar, source.nominal_flow = 1;
      source.nominal_pressure_drop = 0.1 * kBar;
    }
    Circuit circuit(def);
    CircuitIntegrator integrator(circuit, def);
    integrator.start({}, {}, {});
    int reported = 0;
    for (int k = 0; k < 60; ++k) {
      const StepReport report = integrator.step(5e-4, HeldSpeed(0));
      if (!report.has(StepFlag::cavitating)) continue;
      ++reported;
      EXPECT_EQ(circuit.state_owner(report.offender - circuit.first_component_state()), "Line");
      EXPECT_EQ(circuit.first_cavitating(integrator.state().data()), report.offender);
    }
    // 10 - 2 x 3 bar is above zero, with the ringing of five modes too
    EXPECT_EQ(reported > 0, fall == 8) << reported;
  }
}

// Hagen and Poiseuille, dp = 128 rho nu L Q/(pi D^4); Blasius, dp = 0.3164 Re^(-1/4) L/D rho v^2/2; and the losses of
// both ends.
TEST(ValidationLine, loses_the_pressure_of_its_friction_and_of_its_ends) {
  for (const double v : {0.5, 1.0, 6.0}) {
    const double nu = v < 2 ? 46e-6 : 10e-6, Q = v * kArea, Re = v * kDiameter / nu;
    for (const double losses : {0.0, 3.0}) {
      Hammer hammer(3, nu);
      hammer.line().loss_1 = losses, hammer.line().loss_2 = 0.5 * losses;
      hammer.set_signal("Source", Q);
      hammer.run(6);
      const double laminar = 128 * kDensity * nu * kLength * Q / (std::numbers::pi * std::pow(kDiameter, 4));
      const double turbulent = 0.3164 * std::pow(Re, -0.25) * kLength / kDiameter * 0.5 * kDensity * v * v;
      ASSERT_TRUE(Re < 2000 || Re > 4500);
      const double drop = (Re < 2000 ? laminar : turbulent) + 1.5 * losses * 0.5 * kDensity * v * v;
      EXPECT_NEAR(51 * kBar - hammer.end(), drop, 2e-3 * drop) << v << " " << losses;
      EXPECT_NEAR(hammer.variable("Line.middle_pressure"),
                  51 * kBar - losses * 0.5 * kDensity * v * v - 0.5 * (Re < 2000 ? laminar : turbulent), 5e-3 * drop)
          << v << " " << losses;
    }
  }
}

// Oil pressed into a closed line: its content over its modulus, for any number of modes.
TEST(ValidationLine, stores_its_whole_content) {
  for (const int modes : {1, 2, 7, 20}) {
    Hammer hammer(modes, 1e-4);
    hammer.def.volumes[0].fixed = false, hammer.def.volumes[0].rigid_volume = 1e-6;
    hammer.set_signal("Source", -1e-5);
    hammer.run(2);
    hammer.set_signal("Source", 0);
    hammer.run(2);
    const double content = kLength * kArea + 2e-6, rise = kModulus * 2e-5 / content;
    EXPECT_NEAR(hammer.end() - 51 * kBar, rise, 1e-3 * rise) << modes;
    EXPECT_NEAR(hammer.variable("Reservoir.pressure") - 51 * kBar, rise, 1e-3 * rise) << modes;
  }
}

using Complex = std::complex<double>;

// Modified Bessel function of the first kind, order 0 or 1, by its power series.
Complex bessel_i(int order, Complex x) {
  Complex sum = 0, term = order == 0 ? Complex(1) : 0.5 * x;
  for (int k = 1; k < 200; ++k) {
    sum += term;
    term *= 0.25 * x * x / static_cast<double>(k * (k + order));
  }
  return sum;
}

// Lowest eigenvalue of a line with one closed end, exact for laminar flow: s sqrt(N(s)) L/c = j pi/2 with
// N = 1/(1 - 2 I_1(x)/(x I_0(x))), x = D/2 sqrt(s/nu). By Newton's rule.
Complex quarter_wave(double diameter, double nu) {
  const auto defect = [&](Complex s) {
    const Complex x = 0.5 * diameter * std::sqrt(s / nu);
    const Complex N = 1.0 / (1.0 - 2.0 * bessel_i(1, x) / (x * bessel_i(0, x)));
    return s * std::sqrt(N) * (kLength / kSpeedOfSound) - Complex(0, std::numbers::pi / 2);
  };
  Complex s(-5, 0.5 * std::numbers::pi * kSpeedOfSound / kLength);
  for (int k = 0; k < 60; ++k) {
    const double h = 1e-5 * std::abs(s);
    s -= defect(s) * (2 * h) / (defect(s + h) - defect(s - h));
  }
  return s;
}

// Thick oil: decay and frequency of the first wave. The three terms of its friction are within 5 % of the exact damping
// for these pipes.
TEST(ValidationLine, damps_its_first_wave_as_the_exact_friction_of_laminar_flow) {
  const double nu = 46e-6;
  for (const double diameter : {0.012, 0.008}) {
    Hammer hammer(9, nu);
    hammer.line().diameter = diameter;
    const Complex exact = quarter_wave(diameter, nu);
    hammer.set_signal("Source", 0.02 * kArea * diameter / kDiameter);
    hammer.run(6);
    hammer.set_signal("Source", 0);
    const double period = 2 * std::numbers::pi / exact.imag(), dt = period / 240;
    // means over a third of the period have no third harmonic
    std::vector<double> p;
    double sum = 0;
    for (int k = 0; k < 240 * 4; ++k) {
      hammer.run(dt, dt);
      p.push_back(hammer.end() - 51 * kBar);
    }
    std::vector<double> mean;
    for (std::size_t k = 0; k < p.size(); ++k) {
      sum += p[k] - (k >= 80 ? p[k - 80] : 0);
      if (k >= 160) mean.push_back(sum);
    }
    // m(t + T) = a m(t) + b m(t - T) of one decaying wave, a = 2 e^(r T) cos(w T), b = -e^(2 r T); least squares
    constexpr std::size_t kLag = 40;  // a sixth of the period
    double aa = 0, ab = 0, bb = 0, ac = 0, bc = 0;
    for (std::size_t k = kLag; k + kLag < mean.size(); ++k) {
      const double now = mean[k], before = mean[k - kLag], after = mean[k + kLag];
      aa += now * now, ab += now * before, bb += before * before, ac += now * after, bc += before * after;
    }
    const double det = aa * bb - ab * ab, a = (ac * bb - bc * ab) / det, b = (bc * aa - ac * ab) / det;
    const double T = dt * kLag, decay = 0.5 * std::log(-b) / T;
    const double w = std::acos(0.5 * a / std::sqrt(-b)) / T;
    EXPECT_NEAR(decay, exact.real(), 0.06 * std::fabs(exact.real())) << diameter;
    EXPECT_NEAR(w, exact.imag(), 0.015 * exact.imag()) << diameter;
  }
}

TEST(ValidationLine, between_one_volume_is_refused) {
  HydraulicsDef def;
  add_tank(def, "A");
  LineDef& line = add<LineDef>(def, "Line");
  line.port_1 = line.port_2 = "A", line.length = 1, line.diameter = 0.01;
  Problems errors, warnings;
  validate(def, errors, warnings);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_EQ(errors[0].path, "Line.port_2");
}

}  // namespace line_test
}  // namespace slew::hydraulics::test
