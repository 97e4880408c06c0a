// SPDX-License-Identifier: Apache-2.0
// Case E02: stability and energy error of explicit schemes, and E01's exact solution that they are judged by.
#include "tests/validation/cosimulation/explicit_schemes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/validation/multibody/csv_table.h"

namespace slew::cosimulation {
namespace explicit_schemes_test {

using multibody::testing::read_table;
using enum Coupling;
using enum Order;

constexpr double kTime = 10;  // s

TEST(LinearOscillator, IsWhereTheExactSolutionIs) {
  const TwoMasses masses;
  const State end = exact_map(masses, kTime) * kStart;
  const State published(-4.46079749, 87.5960608, -0.964932839, -99.8736233);
  EXPECT_LT((end - published).cwiseAbs().maxCoeff(), 1e-7 * published.norm());
  EXPECT_NEAR(energy(masses, end), 1e4, 1e-6);
  const Map map = exact_map(masses, 0.01);
  State state = kStart;
  const auto table = read_table("cosim_oscillator_c0.csv");
  ASSERT_EQ(table.size(), 1001U);
  for (const std::vector<double>& row : table) {
    const State reference(row[1], row[2], row[3], row[4]);
    EXPECT_LT((state - reference).norm(), 1e-9 * kStart.norm()) << row[0] << " s";
    state = (map * state).eval();
  }
}

TEST(ExplicitSchemes, GrowByTheRadiiOfTheTable) {
  const auto table = read_table("cosim_rho_undamped.csv");
  ASSERT_EQ(table.size(), 7U);
  for (const std::vector<double>& row : table) {
    std::size_t column = 1;
    for (const Coupling coupling : {force_displacement, displacement_displacement}) {
      for (const Order order : {jacobi, first_2_then_1, first_1_then_2}) {
        EXPECT_NEAR(spectral_radius(step_map({}, coupling, order, row[0])), row[column], 2e-10 * (1 + 1e3 * row[0]))
            << "H " << row[0] << " column " << column;
        ++column;
      }
    }
  }
}

TEST(ExplicitSchemes, HoldingAForceCreatesTheEnergyOfTheTable) {
  struct Reference {
    Order order;
    double H, energy;  // over that of the start
  };
  for (const Reference& reference :
       {Reference{jacobi, 1e-3, 1.4513784}, Reference{jacobi, 1e-4, 1.0330262},
        Reference{first_2_then_1, 1e-3, 1.3857431}, Reference{first_2_then_1, 1e-4, 1.0306030}}) {
    const Map map = step_map({}, force_displacement, reference.order, reference.H);
    const State end = after(map, static_cast<int>(std::lround(kTime / reference.H)));
    // the table's last digit is 1e-7
    EXPECT_NEAR(energy({}, end) / 1e4, reference.energy, 1e-7) << reference.H;
  }
  const State end = after(step_map({}, force_displacement, jacobi, 1e-3), 10000);
  EXPECT_LT((end - State(-4.23826652, 87.88614335, -1.10363885, -137.56219425)).cwiseAbs().maxCoeff(), 1e-7);
}

// at any step, an undamped system grows by its spectral radius
TEST(ExplicitSchemes, GrowthFollowsTheRadius) {
  for (const double H : {1e-3, 5e-3, 2e-2}) {
    const Map map = step_map({}, force_displacement, jacobi, H);
    const double radius = spectral_radius(map);
    EXPECT_GT(radius, 1);
    // periods of the fastest growing pair average out
    const int steps = static_cast<int>(60 / H);
    const double early = std::sqrt(energy({}, after(map, steps))), late = std::sqrt(energy({}, after(map, 2 * steps)));
    EXPECT_NEAR(std::log(late / early) / steps, std::log(radius), 0.05 * std::log(radius)) << H;
  }
}

struct Limit {
  Coupling coupling;
  Order order;
  double H;  // s
};

TwoMasses damped() {
  return {.c1 = 1, .cc = 1, .c2 = 1};
}

TwoMasses symmetric() {
  return {.k1 = 100, .kc = 100, .k2 = 100, .c1 = 1, .c2 = 1};
}

void expect_limit(const TwoMasses& of, const Limit& limit) {
  EXPECT_LT(spectral_radius(step_map(of, limit.coupling, limit.order, 0.97 * limit.H)), 1) << limit.H;
  EXPECT_GT(spectral_radius(step_map(of, limit.coupling, limit.order, 1.03 * limit.H)), 1) << limit.H;
  EXPECT_NEAR(spectral_radius(step_map(of, limit.coupling, limit.order, limit.H)), 1, 1e-6) << limit.H;
}

TEST(ExplicitSchemes, DecayBelowTheirLimitsAndGrowAbove) {
  for (const Limit& limit :
       {Limit{force_displacement, jacobi, 0.03722484}, Limit{force_displacement, first_2_then_1, 0.04548033},
        Limit{force_displacement, first_1_then_2, 0.04548033}, Limit{displacement_displacement, jacobi, 0.27262415}}) {
    expect_limit(damped(), limit);
  }
  for (double H = 0.01; H <= 1; H += 0.01) {
    EXPECT_LT(spectral_radius(step_map(damped(), displacement_displacement, first_2_then_1, H)), 1) << H;
  }
}

TEST(ExplicitSchemes, TheSymmetricCaseHasLimitsOfItsOwn) {
  for (const Limit& limit :
       {Limit{force_displacement, jacobi, 0.01339823}, Limit{force_displacement, first_2_then_1, 0.04000097},
        Limit{displacement_displacement, jacobi, 0.02020486}}) {
    expect_limit(symmetric(), limit);
  }
}

}  // namespace explicit_schemes_test
}  // namespace slew::cosimulation
