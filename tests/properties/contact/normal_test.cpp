// SPDX-License-Identifier: Apache-2.0
// The normal law pushes, dissipates, and has exact slopes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "contact/normal_law.h"

namespace slew::contact {
namespace normal_test {

struct Draw {
  NormalLaw law;
  double share, depth, depth_rate;
  NormalState state;
};

class NormalForceProperty : public ::testing::Test {
 protected:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Draw draw() {
    Draw d{};
    d.law = build({.stiffness = std::exp(uniform(std::log(1e3), std::log(1e9))),
                   .restitution = uniform(kSmallestRestitution, 1),
                   .exponent = uniform(0, 1) < 0.3 ? 1.0 : uniform(1, 3),
                   .reference_depth = uniform(1e-3, 1)});
    d.share = uniform(0, 1);
    d.depth = uniform(-1e-3, 1e-2);
    d.state.impact_speed = std::exp(uniform(std::log(1e-2), std::log(10.0)));
    d.depth_rate = uniform(-3, 3) * d.state.impact_speed;
    return d;
  }
  std::mt19937 random_{7};
};

constexpr int kDraws = 20000;

TEST_F(NormalForceProperty, NeverPullsAndIsBounded) {
  for (int i = 0; i < kDraws; ++i) {
    const Draw d = draw();
    const NormalForce force = evaluate(d.law, d.share, d.depth, d.depth_rate, d.state);
    const double elastic = evaluate(d.law, d.share, d.depth, 0, d.state).force;
    ASSERT_GE(force.force, 0);
    ASSERT_LE(force.force, elastic * (1 + d.law.damping_number) * (1 + 1e-14));
    ASSERT_GE(force.d_depth, 0);
    ASSERT_GE(force.d_depth_rate, 0);
  }
}

// power that neither the spring takes nor gives is lost
TEST_F(NormalForceProperty, NeverCreatesEnergy) {
  for (int i = 0; i < kDraws; ++i) {
    const Draw d = draw();
    const double force = evaluate(d.law, d.share, d.depth, d.depth_rate, d.state).force;
    const double elastic = evaluate(d.law, d.share, d.depth, 0, d.state).force;
    ASSERT_GE((force - elastic) * d.depth_rate, 0);
  }
}

TEST_F(NormalForceProperty, HasTheSlopesOfFiniteDifferences) {
  int compared = 0;
  for (int i = 0; i < kDraws; ++i) {
    const Draw d = draw();
    if (d.depth < 1e-4) continue;
    const auto at = [&](double depth, double rate) { return evaluate(d.law, d.share, depth, rate, d.state); };
    // not across the kinks: force zero, and the rate that was the largest so far
    const double step_v = 1e-5 * d.state.impact_speed, step_d = 1e-5 * d.depth;
    if (std::fabs(d.depth_rate - d.state.impact_speed) < 2 * step_v) continue;
    if ((at(d.depth, d.depth_rate - step_v).force > 0) != (at(d.depth, d.depth_rate + step_v).force > 0)) continue;
    const NormalForce here = at(d.depth, d.depth_rate);
    const double by_depth =
        (at(d.depth + step_d, d.depth_rate).force - at(d.depth - step_d, d.depth_rate).force) / (2 * step_d);
    const double by_rate =
        (at(d.depth, d.depth_rate + step_v).force - at(d.depth, d.depth_rate - step_v).force) / (2 * step_v);
    const double scale = at(d.depth, d.state.impact_speed).force;
    ASSERT_NEAR(here.d_depth * d.depth, by_depth * d.depth, 1e-8 * scale);
    ASSERT_NEAR(here.d_depth_rate * d.state.impact_speed, by_rate * d.state.impact_speed, 1e-8 * scale);
    ++compared;
  }
  EXPECT_GT(compared, kDraws / 2);
}

TEST_F(NormalForceProperty, HoldsTheEnergyThatItsSpringTakes) {
  for (int i = 0; i < 100; ++i) {
    const Draw d = draw();
    if (d.depth <= 0) continue;
    // Simpson over depth^(1/2), in which the force of every exponent is smooth
    const int parts = 2000;
    const double root = std::sqrt(d.depth);
    double work = 0;
    for (int k = 0; k <= parts; ++k) {
      const double x = root * k / parts;
      const double weight = k == 0 || k == parts ? 1 : k % 2 == 1 ? 4 : 2;
      work += weight * evaluate(d.law, d.share, x * x, 0, d.state).force * 2 * x;
    }
    work *= root / parts / 3;
    EXPECT_NEAR(stored_energy(d.law, d.share, d.depth), work, 1e-8 * work + 1e-300);
  }
}

// a mass that is pulled away during the impact leaves with no more energy than it came with
TEST(NormalForcePulledAway, GivesBackLessThanItTook) {
  for (const double e : {0.05, 0.3, 0.8, 1.0}) {
    const NormalLaw law = build({.stiffness = 1e6, .restitution = e});
    NormalState state;
    double d = -1e-9, u = 1;
    observe(law, d, u, state);
    const double pull = -2e3;  // N on 1 kg, far more than the spring needs to be crossed
    const double h = 1e-7;
    double work_of_pull = 0;
    while (d < 0 || d + u * h > 0) {
      const double force = evaluate(law, 1, d, u, state).force;
      const double a = pull - force;
      const double step = u * h + a * h * h / 2;
      work_of_pull += pull * step;
      d += step;
      u += a * h;
    }
    EXPECT_LT(u, 0);
    EXPECT_LE(u * u / 2, 0.5 + work_of_pull + 1e-3);
  }
}

}  // namespace normal_test
}  // namespace slew::contact
