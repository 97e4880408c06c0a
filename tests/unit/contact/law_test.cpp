// SPDX-License-Identifier: Apache-2.0
// The laws' definitions and the memory of a contact.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "contact/friction_law.h"
#include "contact/normal_law.h"

namespace slew::contact {
namespace law_test {

TEST(DampingNumber, IsTheTabledRoot) {
  EXPECT_NEAR(damping_number(0.1), 9.998159397, 1e-8);
  EXPECT_NEAR(damping_number(0.5), 1.432750533, 1e-9);
  EXPECT_NEAR(damping_number(0.9), 0.166481951, 1e-9);
}

TEST(DampingNumber, SolvesItsEquationForEveryRestitution) {
  for (int i = 1; i <= 999; ++i) {
    const long double e = i / 1000.0L;
    const long double a = damping_number(static_cast<double>(e));
    ASSERT_GT(a, 0);
    ASSERT_LT(a * e, 1);
    // the equation's slope over a is about (1 - e^2) a where a is small and grows without bound towards 1/e
    const long double residual = a * (1 + e) - std::log1p(a) + std::log1p(-a * e);
    const long double slope = (1 + e) - 1 / (1 + a) - e / (1 - a * e);
    EXPECT_LT(std::fabs(residual / slope), 1e-12L * a) << "e = " << static_cast<double>(e);
  }
}

TEST(DampingNumber, HasTheRightLimits) {
  EXPECT_EQ(damping_number(1), 0);
  // near 1: 3 (1-e^2) / (2 (1+e^3)), from the first two terms of the series
  for (const double gap : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const double e = 1 - gap;
    const double first = 3 * (1 - e) * (1 + e) / (2 * (1 + e * e * e));
    EXPECT_NEAR(damping_number(e), first, first * gap * 2 + 1e-14 * first);
  }
  // near 0 the body leaves with the creeping speed v0/a
  EXPECT_NEAR(damping_number(kSmallestRestitution), 100, 1e-10);
}

// a free mass on its way in, in steps of a thousandth of the way
TEST(NormalForce, IsNeverSteeperOnAFreeImpactThanItsBound) {
  for (const double e : {0.01, 0.1, 0.5, 1.0}) {
    for (const double n : {1.0, 1.5, 3.0}) {
      for (const double speed : {1e-3, 0.05, 3.0}) {
        const NormalLaw law = build({.stiffness = 1e8, .restitution = e, .exponent = n, .reference_depth = 1e-3});
        constexpr double kMass = 2;
        NormalState state;
        observe(law, 0, speed, state);
        const NormalForce most = slopes_of_impact(law, 1, 0, speed, state, kMass);
        EXPECT_GT(most.d_depth_rate + most.d_depth, 0);
        double u = speed, d = 0, worst_spring = 0, worst_damping = 0;
        const double h = 1e-4 / std::sqrt(most.d_depth / kMass + std::pow(most.d_depth_rate / kMass, 2));
        while (u > 0) {
          const NormalForce now = evaluate(law, 1, d, u, state);
          worst_spring = std::max(worst_spring, now.d_depth);
          worst_damping = std::max(worst_damping, now.d_depth_rate);
          u -= h * now.force / kMass;
          d += h * u;
        }
        EXPECT_LE(worst_spring, 1.001 * most.d_depth);
        EXPECT_LE(worst_damping, 1.001 * most.d_depth_rate);
        // not much more than that either
        EXPECT_LT(std::max(most.d_depth, 0.0), (e < 0.05 ? 120 : 15) * worst_spring);
      }
    }
  }
}

TEST(NormalState, HoldsTheLargestApproachUntilTheContactOpens) {
  const NormalLaw law = build({.stiffness = 1e6, .smallest_impact_speed = 0.01});
  NormalState state;
  observe(law, -0.1, 0.5, state);
  EXPECT_EQ(state.impact_speed, 0.5);
  observe(law, -0.1, 0.4, state);  // still open: the present speed
  EXPECT_EQ(state.impact_speed, 0.4);
  observe(law, 1e-3, 0.3, state);
  EXPECT_EQ(state.impact_speed, 0.4);
  observe(law, 1e-3, -0.2, state);
  EXPECT_EQ(state.impact_speed, 0.4);
  observe(law, 1e-3, 2, state);  // hit again before it opened
  EXPECT_EQ(state.impact_speed, 2);
  observe(law, 0, -0.2, state);
  EXPECT_EQ(state.impact_speed, 0.01);
}

TEST(NormalState, OfAStartInPenetrationIsTheSmallestSpeed) {
  const NormalLaw law = build({.stiffness = 1e6, .smallest_impact_speed = 0.01});
  NormalState state;
  observe(law, 0.1, 0, state);
  EXPECT_EQ(state.impact_speed, 0.01);
}

TEST(Shares, SumToOneAndComeInWithoutAJump) {
  const std::vector<double> depths = {1e-3, 2e-3, -1e-3, 1e-9};
  std::vector<double> areas(4, 0.5), shares(4);
  share_stiffness(depths, areas, shares);
  EXPECT_NEAR(std::accumulate(shares.begin(), shares.end(), 0.0), 1, 1e-15);
  EXPECT_EQ(shares[2], 0);
  EXPECT_LT(shares[3], 1e-6);
  EXPECT_NEAR(shares[1], 2 * shares[0], 1e-15);
  areas[0] = 1;
  share_stiffness(depths, areas, shares);
  EXPECT_NEAR(shares[1], shares[0], 1e-15);
  share_stiffness(std::vector<double>{-1, 0, -2, 0}, areas, shares);
  for (const double share : shares) EXPECT_EQ(share, 0);
}

template <typename Def>
void expect_refusal(Def def, double Def::*member, double value, const std::string& path) {
  def.*member = value;
  Problems problems;
  check("Ground_Bag", def, problems);
  ASSERT_FALSE(problems.empty()) << path << " = " << value;
  EXPECT_EQ(problems[0].path, "Ground_Bag." + path);
  EXPECT_NE(problems[0].what.find(std::isnan(value) ? "nan" : "out of range"), std::string::npos);
  EXPECT_FALSE(problems[0].expected.empty());
}

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(NormalLawDef, OutOfRangeIsNamed) {
  const NormalLawDef sound{.stiffness = 5e7};
  Problems none;
  check("Ground_Bag", sound, none);
  EXPECT_TRUE(none.empty());
  for (const double value : {0.0, -1.0, kNaN, kInfinity}) {
    expect_refusal(sound, &NormalLawDef::stiffness, value, "spring_constant");
    expect_refusal(sound, &NormalLawDef::restitution, value, "restitution_coefficient");
    expect_refusal(sound, &NormalLawDef::exponent, value, "contact_exponent");
    expect_refusal(sound, &NormalLawDef::reference_depth, value, "reference_depth");
    expect_refusal(sound, &NormalLawDef::smallest_impact_speed, value, "smallest_impact_speed");
  }
  expect_refusal(sound, &NormalLawDef::restitution, 1.01, "restitution_coefficient");
  expect_refusal(sound, &NormalLawDef::exponent, 3.1, "contact_exponent");
}

TEST(FrictionLawDef, OutOfRangeIsNamed) {
  const FrictionLawDef sound;
  Problems problems;
  check("Ground_Bag", sound, problems);
  EXPECT_TRUE(problems.empty());
  for (const double value : {-1.0, kNaN, kInfinity}) {
    expect_refusal(sound, &FrictionLawDef::pressing_force, value, "constant_pressing_force");
    expect_refusal(sound, &FrictionLawDef::stiffness, value, "surface_stiffness");
    expect_refusal(sound, &FrictionLawDef::damping, value, "surface_damping");
    expect_refusal(sound, &FrictionLawDef::stribeck_speed, value, "stribeck_velocity");
    expect_refusal(sound, &FrictionLawDef::viscosity, value, "viscosity_coefficient");
    expect_refusal(sound, &FrictionLawDef::static_coefficient, value, "static_friction_coefficient");
    expect_refusal(sound, &FrictionLawDef::dynamic_coefficient, value, "dynamic_friction_coefficient");
    expect_refusal(sound, &FrictionLawDef::exponent, value, "stribeck_exponent");
  }
  FrictionLawDef swapped;
  swapped.static_coefficient = 0.1;
  swapped.dynamic_coefficient = 0.3;
  check("Ground_Bag", swapped, problems);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].what, "0.1 is below the dynamic coefficient 0.3");
}

}  // namespace law_test
}  // namespace slew::contact
