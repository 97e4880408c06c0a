// SPDX-License-Identifier: Apache-2.0
// Case D02: the rebound of the normal law is the wanted restitution. A mass thrown at a wall without gravity,
// fourth-order Runge-Kutta with some thousand steps per impact; tolerance of the case 1e-3, what the law is exact to by
// derivation.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "contact/normal_law.h"

namespace slew::contact {
namespace rebound_test {

struct Bounce {
  double rebound;   // speed after over speed before
  double deepest;   // m
  double duration;  // s
};

// mass [kg] against the wall with v0 [m/s]; gravity [m/s2] pulls it into the wall
Bounce bounce(const NormalLaw& law, double mass, double v0, double gravity = 0) {
  const double n = law.exponent;
  const double k_n = law.stiffness * std::pow(law.reference_depth, 1 - n);
  const double scale = std::pow((n + 1) * mass * v0 * v0 / (2 * k_n), 1 / (n + 1)) / v0;
  const double h = scale / 2000;
  NormalState state;
  double d = 0, u = v0, t = 0, deepest = 0;
  observe(law, d, u, state);
  const auto a = [&](double depth, double rate) { return gravity - evaluate(law, 1, depth, rate, state).force / mass; };
  for (int i = 0; i < 10'000'000; ++i) {
    const double k1 = a(d, u);
    const double k2 = a(d + h / 2 * u, u + h / 2 * k1);
    const double k3 = a(d + h / 2 * (u + h / 2 * k1), u + h / 2 * k2);
    const double k4 = a(d + h * (u + h / 2 * k2), u + h * k3);
    d += h * u + h * h / 6 * (k1 + k2 + k3);
    u += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    t += h;
    deepest = std::max(deepest, d);
    if (d <= 0) return {-u / v0, deepest, t};
    observe(law, d, u, state);
  }
  return {0, deepest, t};
}

TEST(Rebound, HasTheWantedRestitution) {
  double worst = 0;
  for (const double e : {0.01, 0.05, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 1.0}) {
    for (const double n : {1.0, 1.5, 2.0}) {
      for (const double k : {1e5, 5e7}) {
        for (const double v0 : {0.05, 3.0}) {
          const NormalLaw law = build({.stiffness = k, .restitution = e, .exponent = n});
          const double error = std::fabs(bounce(law, 2, v0).rebound - e);
          EXPECT_LT(error, 1e-3) << "e " << e << " n " << n << " k " << k << " v0 " << v0;
          worst = std::max(worst, error);
        }
      }
    }
  }
  RecordProperty("worst_error_1e_9", std::to_string(worst * 1e9));
  EXPECT_LT(worst, 1e-6) << "worse than what the derivation and the integrator give";
}

// Laws of the literature differ in the number a of (2) only, and return what case D02 lists. For comparison: a scene
// cannot choose them.
TEST(Rebound, OfTheCommonLawsIsWhatTheCaseLists) {
  struct Listed {
    const char* name;
    double (*a)(double e);
    double rebound[3];  // for e = 0.1, 0.5, 0.9
  };
  const Listed laws[] = {
      {"Hunt-Crossley", [](double e) { return 3 * (1 - e) / 2; }, {0.515833, 0.662962, 0.909016}},
      {"Lankarani-Nikravesh", [](double e) { return 3 * (1 - e * e) / 4; }, {0.665265, 0.725241, 0.913177}},
      {"Flores", [](double e) { return 8 * (1 - e) / (5 * e); }, {0.069444, 0.470445, 0.893921}},
      {"Hu-Guo", [](double e) { return 3 * (1 - e) / (2 * e); }, {0.074074, 0.487741, 0.899900}},
  };
  const double wanted[] = {0.1, 0.5, 0.9};
  for (const Listed& listed : laws) {
    for (int i = 0; i < 3; ++i) {
      NormalLaw law = build({.stiffness = 1e5, .restitution = 0.5, .exponent = 1.5});
      law.damping_number = listed.a(wanted[i]);
      EXPECT_NEAR(bounce(law, 1, 3).rebound, listed.rebound[i], 2e-6) << listed.name << " " << wanted[i];
    }
  }
}

TEST(Rebound, WithWeightIsWithinAPercent) {
  for (const double e : {0.3, 0.5, 0.9}) {
    const NormalLaw law = build({.stiffness = 1e8, .restitution = e});
    EXPECT_NEAR(bounce(law, 1, std::sqrt(2 * 9.81), 9.81).rebound, e, 0.01 * e);
  }
}

// slower than the smallest impact speed: more than e, never more than 1
TEST(Rebound, OfACreepingImpactLiesBetweenRestitutionAndOne) {
  const NormalLaw law = build({.stiffness = 1e6, .restitution = 0.1, .smallest_impact_speed = 0.01});
  double before = 0.1;
  for (const double v0 : {5e-3, 1e-3, 1e-4}) {
    const double rebound = bounce(law, 1, v0).rebound;
    EXPECT_GT(rebound, before);
    EXPECT_LT(rebound, 1);
    // the same relation as ever, with a v0/v_min for a
    const double a = law.damping_number * v0 / 0.01;
    EXPECT_NEAR(a * (1 + rebound), std::log((1 + a) / (1 - a * rebound)), 1e-6 * a * a);
    before = rebound;
  }
}

TEST(ElasticBall, GoesAsDeepAndStaysAsLongAsOnASpring) {
  const NormalLaw law = build({.stiffness = 1e5, .restitution = 1});
  const Bounce ball = bounce(law, 1, std::sqrt(2 * 9.81), 9.81);
  EXPECT_NEAR(ball.deepest, 1.4105584557e-2, 1.4e-2 * 1e-6);
  EXPECT_NEAR(ball.duration, M_PI * std::sqrt(1e-5), 0.02 * 9.93e-3);
  EXPECT_NEAR(ball.rebound, 1, 1e-5);  // the last step ends outside, where gravity has slowed the ball
}

}  // namespace rebound_test
}  // namespace slew::contact
