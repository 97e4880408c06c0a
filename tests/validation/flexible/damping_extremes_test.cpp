// SPDX-License-Identifier: Apache-2.0
// Bodies without damping, and with next to none, for a minute: what is left of the energy is what the integrator's own
// theory leaves of it. A mode of omega in steps of h, z = omega h, keeps |R(i z)|^2 of its energy a step:
//   rk4 1 - z^6/72 + z^8/576;  trapezoidal 1;  sdirk2 |1 + (1 - 2 g) i z|^2/(1 + g^2 z^2)^2, g = 1 - 1/sqrt 2      (1)
// and generalised_alpha what its recurrence leaves (Chung and Hulbert 1993).
#include <complex>

#include "tests/support/nightly.h"
#include "tests/validation/flexible/strip.h"

namespace slew::multibody {
namespace damping_extremes_test {

using namespace testing;

double left_by_rk4(double z) {
  return 1 - std::pow(z, 6) / 72 + std::pow(z, 8) / 576;
}

double left_by_sdirk2(double z) {
  const double g = 1 - 1 / std::sqrt(2.0);
  const std::complex<double> R =
      std::complex<double>(1, (1 - 2 * g) * z) / std::pow(std::complex<double>(1, -g * z), 2);
  return std::norm(R);
}

// energy that is left of a swing after so many steps, omega = 1, h = z
double left_by_generalised_alpha(double z, double rho, long steps) {
  const double m = (2 * rho - 1) / (rho + 1), f = rho / (rho + 1), gamma = 0.5 - m + f,
               beta = 0.25 * (0.5 + gamma) * (0.5 + gamma);
  double x = 1, v = 0, A = -1;
  for (long i = 0; i < steps; ++i) {
    // (1 - m) A_1 + m A_0 = -(1 - f) x_1 - f x_0 with x_1 linear in A_1
    const double ahead = x + z * v + z * z * (0.5 - beta) * A;
    const double next = (-m * A - (1 - f) * ahead - f * x) / (1 - m + (1 - f) * z * z * beta);
    x = ahead + z * z * beta * next;
    v += z * ((1 - gamma) * A + gamma * next);
    A = next;
  }
  return x * x + v * v;
}

struct Boom {
  MechanicsDef def;
  double omega = 0;
};

// the jib boom held at its root, without gravity, its first mode at 0.1: 5 cm at the tip
Boom jib_boom(double damping, Integrator rule, double step) {
  flex::ReductionDef reduction = flex::testing::with_modes(10);
  const auto modes = slew::testing::modes_of(flex::testing::jib_boom(), reduction, {1, 2});
  Boom boom;
  boom.def = clamped_strip(modes, 0.1);
  boom.def.bodies[0].name = boom.def.joints[0].body2 = boom.def.flexible_bodies[0].body = "Boom";
  boom.def.flexible_bodies[0].relative_damping = {damping};
  boom.def.integrator = rule;
  boom.def.max_substep = step;
  boom.omega = std::sqrt(modes->stiffness[0]);
  return boom;
}

TEST(Undamped, AModeKeepsWhatItsIntegratorLeavesForAMinute) {
  for (const double step : {2.5e-4, 1e-3}) {
    for (const Integrator rule :
         {Integrator::rk4, Integrator::trapezoidal, Integrator::sdirk2, Integrator::generalised_alpha}) {
      const Boom boom = jib_boom(0, rule, step);
      Formulated run(boom.def);
      const double begin = run.total_energy(), z = boom.omega * step, time = slew::testing::rounds(10.0, 60.0);
      const long steps = std::lround(time / step);
      Outcome outcome;
      outcome.is_flagged = !run.try_run(time, step);
      const auto n = static_cast<double>(steps);
      const double expected = rule == Integrator::rk4           ? std::pow(left_by_rk4(z), n)
                              : rule == Integrator::sdirk2      ? std::pow(left_by_sdirk2(z), n)
                              : rule == Integrator::trapezoidal ? 1.0
                                                                : left_by_generalised_alpha(z, 0.8, steps);
      outcome.error = std::fabs(run.total_energy() / begin - expected);
      char left[64];
      std::snprintf(left, sizeof left, "%s, leaves %.6f", in_milliseconds(step).c_str(), expected);
      expect_outcome("damping 0, 60 s of the boom: energy, of the start's", name_of(rule) + ", " + left, outcome, 1e-6,
                     Ending::right);
    }
  }
}

// The boom swings on a hinge under gravity, coupled to its modes with stiffening.
TEST(Undamped, ASwingingBoomKeepsItsEnergyForAMinute) {
  struct Case {
    Integrator rule;
    double step, bound;
  };
  for (const Case& c : {Case{Integrator::rk4, 2.5e-4, 1e-6}, {Integrator::trapezoidal, 1e-3, 1e-3}}) {
    MechanicsDef def = jib_boom(0, c.rule, c.step).def;
    flex::ReductionDef reduction = flex::testing::with_modes(10);
    reduction.stiffening = flex::GeometricStiffening::straight_beam;
    def.flexible_bodies[0].modes = slew::testing::modes_of(flex::testing::jib_boom(), reduction, {1, 2});
    def.flexible_bodies[0].start = {0.05, 0.05};
    def.gravity = {0, -9.81, 0};
    def.joints[0].type = JointType::revolute;
    Formulated run(def);
    const double begin = run.total_energy();
    double largest = 0;
    Outcome outcome;
    for (int i = 0; i < static_cast<int>(slew::testing::rounds(10.0, 60.0) * 10); ++i) {
      outcome.is_flagged = !run.try_run(0.1, c.step) || outcome.is_flagged;
      largest = std::max(largest, energy(run.model, run.ws).kinetic);
      const double error = std::fabs(run.total_energy() - begin);
      if (!(error <= outcome.error)) outcome.error = error;
    }
    outcome.error /= largest;
    expect_outcome("damping 0, 60 s of the boom on a hinge: energy, of the largest kinetic",
                   name_of(c.rule) + ", " + in_milliseconds(c.step), outcome, c.bound, Ending::right);
  }
}

// 2 pi zeta a period, and on top of it what rk4 takes, 2 pi z^5/144: at 1 ms a 500th of zeta = 1e-6, at
// 0.25 ms a 500000th
TEST(HardlyDamped, DecaysByTwoPiZetaAPeriod) {
  for (const double zeta : {1e-6, 1e-3}) {
    for (const auto& [rule, step] :
         {std::pair(Integrator::rk4, 2.5e-4), {Integrator::rk4, 1e-3}, {Integrator::trapezoidal, 1e-3}}) {
      const Boom boom = jib_boom(zeta, rule, step);
      Formulated run(boom.def);
      const double z = boom.omega * step;
      const long steps = std::lround(slew::testing::rounds(20.0, 60.0) / step);
      const double begin = run.total_energy();
      Outcome outcome;
      outcome.is_flagged = !run.try_run(static_cast<double>(steps) * step, step);
      const double periods = static_cast<double>(steps) * z / (2 * M_PI);
      const double decrement = 0.5 * std::log(begin / run.total_energy()) / periods;
      const double own = rule == Integrator::rk4 ? 2 * M_PI * std::pow(z, 5) / 144 : 0;
      outcome.error = std::fabs((decrement - own) / (2 * M_PI * zeta) - 1);
      char which[96];
      std::snprintf(which, sizeof which, "damping %.0e: decrement of 2 pi zeta, relative", zeta);
      char how[96];
      std::snprintf(how, sizeof how, "%s, %s, its own %.0e of it", name_of(rule).c_str(), in_milliseconds(step).c_str(),
                    own / (2 * M_PI * zeta));
      // z^2/12 of the trapezoid's period; the energy of one instant, zeta of it over 2 pi zeta periods
      expect_outcome(which, how, outcome, 2e-3, Ending::right);
    }
  }
}

}  // namespace damping_extremes_test
}  // namespace slew::multibody
