// SPDX-License-Identifier: Apache-2.0
// Bristle friction stays in its cone, dissipates, is the same in every frame and has exact slopes, at any sub-step.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "contact/friction_law.h"
#include "math/rotation.h"

namespace slew::contact {
namespace friction_test {

using math::Mat3;
using math::Vec3;

struct Draw {
  FrictionLaw law;
  SlidingContact contact;
  FrictionState state;
  double h;
  [[nodiscard]] double level() const { return contact.normal_force + contact.share * law.def.pressing_force; }
};

class FrictionProperty : public ::testing::Test {
 protected:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  double decades(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }
  Vec3 vector() { return {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}; }
  Vec3 tangent(Vec3 n, double length) {
    Vec3 t = vector();
    t = t - n * dot(n, t);
    return t * (length / norm(t));
  }
  Draw draw() {
    Draw d{};
    FrictionLawDef def;
    def.pressing_force = uniform(0, 1) < 0.5 ? 0 : uniform(0, 100);
    def.stiffness = decades(1e3, 1e8);
    def.damping = decades(1, 1e5);
    def.stribeck_speed = decades(1e-3, 1);
    def.viscosity = uniform(0, 10);
    def.dynamic_coefficient = uniform(0.01, 1);
    def.static_coefficient = def.dynamic_coefficient * uniform(1, 3);
    def.exponent = uniform(0, 1) < 0.3 ? 2 : uniform(1, 4);
    d.law = build(def);
    d.contact.n_W = vector();
    d.contact.n_W = d.contact.n_W * (1 / norm(d.contact.n_W));
    d.contact.normal_force = decades(1, 1e6);
    d.contact.share = uniform(0.01, 1);
    d.contact.v_W = tangent(d.contact.n_W, decades(1e-8, 100));
    const double z_max = def.static_coefficient * d.level() / (d.contact.share * def.stiffness);
    d.state.z_W = tangent(d.contact.n_W, z_max * uniform(0, 1));
    d.h = uniform(0, 1) < 0.1 ? 0 : decades(1e-7, 1e3);
    return d;
  }
  std::mt19937 random_{11};
};

constexpr int kDraws = 20000;

TEST_F(FrictionProperty, NeverLeavesTheConeByMoreThanTheViscousForce) {
  for (int i = 0; i < kDraws; ++i) {
    Draw d = draw();
    if (i % 3 == 0) d.state.z_W = d.state.z_W * 1e3;  // the normal force fell to a thousandth
    const FrictionForce force = evaluate(d.law, d.contact, d.h, d.state);
    const Vec3 bristles = force.f_W - d.contact.v_W * (d.contact.share * d.law.def.viscosity);
    const double cone = d.law.def.static_coefficient * d.level();
    const double viscous = d.contact.share * d.law.def.viscosity * norm(d.contact.v_W);
    ASSERT_LE(norm(bristles), cone * (1 + 1e-12) + 1e-14 * viscous);
    ASSERT_LE(norm(force.z_W), cone / (d.contact.share * d.law.def.stiffness) * (1 + 1e-12));
  }
}

// power of the force is never less than the rate of the bristles' energy, at one instant ...
TEST_F(FrictionProperty, NeverCreatesEnergyAtAnInstant) {
  for (int i = 0; i < kDraws; ++i) {
    Draw d = draw();
    const FrictionForce force = evaluate(d.law, d.contact, 0, d.state);
    const double power = dot(force.f_W, d.contact.v_W);
    const Vec3 rate = bristle_rate(d.law, d.contact, d.state.z_W);
    const double stored = d.contact.share * d.law.def.stiffness * dot(d.state.z_W, rate);
    ASSERT_GE(power - stored, -1e-12 * (std::fabs(power) + std::fabs(stored)));
  }
}

// ... and over a sub-step of any length, with the force of its end
TEST_F(FrictionProperty, NeverCreatesEnergyOverASubStep) {
  for (int i = 0; i < kDraws; ++i) {
    Draw d = draw();
    const FrictionForce force = evaluate(d.law, d.contact, d.h, d.state);
    const double work = dot(force.f_W, d.contact.v_W) * d.h;
    const double before = stored_energy(d.law, d.contact.share, d.state);
    const double after = stored_energy(d.law, d.contact.share, {force.z_W});
    ASSERT_GE(work - (after - before), -1e-12 * (std::fabs(work) + before + after)) << i;
  }
}

TEST_F(FrictionProperty, LooksTheSameFromEveryFrame) {
  for (int i = 0; i < kDraws / 10; ++i) {
    const Draw d = draw();
    const Mat3 R = math::rotation_zxz({uniform(-3, 3), uniform(-3, 3), uniform(-3, 3)});
    Draw turned = d;
    turned.contact.n_W = R * d.contact.n_W;
    turned.contact.v_W = R * d.contact.v_W;
    turned.state.z_W = R * d.state.z_W;
    const FrictionForce here = evaluate(d.law, d.contact, d.h, d.state);
    const FrictionForce there = evaluate(turned.law, turned.contact, d.h, turned.state);
    ASSERT_LT(norm(there.f_W - R * here.f_W), 1e-11 * norm(here.f_W));
    ASSERT_LT(norm(there.z_W - R * here.z_W), 1e-11 * norm(here.z_W));
    // the force lies in the plane
    ASSERT_LT(std::fabs(dot(here.f_W, d.contact.n_W)), 1e-12 * norm(here.f_W));
  }
}

TEST_F(FrictionProperty, HasTheSlopesOfFiniteDifferences) {
  int compared = 0;
  for (int i = 0; i < kDraws; ++i) {
    const Draw d = draw();
    const FrictionLawDef& def = d.law.def;
    const double s = norm(d.contact.v_W);
    const double cone = def.static_coefficient * d.level() + d.contact.share * def.viscosity * s;
    const auto at = [&](Vec3 dv, double dN) {
      SlidingContact c = d.contact;
      c.v_W = c.v_W + dv;
      c.normal_force += dN;
      return evaluate(d.law, c, d.h, d.state).f_W;
    };
    // not across the limit of the bristle damping
    const double ratio = s / def.stribeck_speed;
    const double g = d.level() * (def.dynamic_coefficient + (def.static_coefficient - def.dynamic_coefficient) *
                                                                std::exp(-std::pow(ratio, def.exponent)));
    if (std::fabs(d.contact.share * def.damping * s / g - 1) < 1e-3) continue;
    if (norm(d.state.z_W) * d.contact.share * def.stiffness > 0.999 * def.static_coefficient * d.level()) continue;
    const FrictionForce here = evaluate(d.law, d.contact, d.h, d.state);
    const Vec3 direction = tangent(d.contact.n_W, 1);
    const double step = 1e-5 * s, step_N = 1e-5 * d.contact.normal_force;
    const Vec3 by_v = (at(direction * step, 0) - at(direction * -step, 0)) * (0.5 / step);
    const Vec3 by_N = (at({}, step_N) - at({}, -step_N)) * (0.5 / step_N);
    // a step of 1e-5 leaves 1e-10 times the third derivative, and 1e-11 of rounding
    ASSERT_LT(norm(here.d_velocity * direction - by_v) * s, 1e-7 * cone) << i;
    ASSERT_LT(norm(here.d_normal - by_N) * d.contact.normal_force, 1e-7 * cone) << i;
    ASSERT_LT(norm(here.d_velocity * d.contact.n_W) * s, 1e-12 * cone + 1e-12 * norm(here.d_velocity * direction) * s);
    ++compared;
  }
  EXPECT_GT(compared, kDraws / 2);
}

// where the normal force has fallen and the bristles are cut, too
TEST_F(FrictionProperty, HasTheSlopeOverNormalForceWhereItIsCut) {
  int compared = 0;
  for (int i = 0; i < kDraws / 10; ++i) {
    Draw d = draw();
    d.state.z_W = d.state.z_W * 1e3;
    const double z_max = d.law.def.static_coefficient * d.level() / (d.contact.share * d.law.def.stiffness);
    if (norm(d.state.z_W) < 1.1 * z_max) continue;
    const auto at = [&](double dN) {
      SlidingContact c = d.contact;
      c.normal_force += dN;
      return evaluate(d.law, c, d.h, d.state).f_W;
    };
    const double step_N = 1e-5 * d.contact.normal_force;
    const Vec3 by_N = (at(step_N) - at(-step_N)) * (0.5 / step_N);
    const Vec3 here = evaluate(d.law, d.contact, d.h, d.state).d_normal;
    ASSERT_LT(norm(here - by_N), 1e-6 * (d.law.def.static_coefficient + norm(here))) << i;
    ++compared;
  }
  EXPECT_GT(compared, kDraws / 20);
}

// (4) against many small explicit steps of (2)
TEST_F(FrictionProperty, BendsByItsEquation) {
  for (int i = 0; i < 200; ++i) {
    Draw d = draw();
    const double s = norm(d.contact.v_W);
    const Vec3 steady_rate = bristle_rate(d.law, d.contact, {}) - bristle_rate(d.law, d.contact, d.state.z_W);
    const double kappa = norm(steady_rate) / norm(d.state.z_W);
    d.h = uniform(0.1, 3) / kappa;
    if (!(s > 0) || !std::isfinite(d.h)) continue;
    const int parts = 2000;
    Vec3 z = d.state.z_W;
    for (int k = 0; k < parts; ++k) {
      const double step = d.h / parts;
      const auto rate = [&](Vec3 at) { return bristle_rate(d.law, d.contact, at); };
      const Vec3 k1 = rate(z), k2 = rate(z + k1 * (step / 2)), k3 = rate(z + k2 * (step / 2)), k4 = rate(z + k3 * step);
      z += (k1 + k2 * 2 + k3 * 2 + k4) * (step / 6);
    }
    const Vec3 exact = evaluate(d.law, d.contact, d.h, d.state).z_W;
    ASSERT_LT(norm(exact - z), 1e-10 * (norm(d.state.z_W) + norm(z)));
  }
}

TEST_F(FrictionProperty, IsFiniteWhereQuotientsMeetTheirLimits) {
  for (const double N : {0.0, 1e-300, 1e-12, 1e-8, 1.0, 1e12}) {
    for (const double speed : {0.0, 1e-310, 1e-150, 1e-12, 1.0, 1e6}) {
      for (const double h : {0.0, 1e-9, 1e-3, 1e6}) {
        const SlidingContact contact{{0, 0, 1}, {speed, 0, 0}, N, 1};
        const FrictionForce force = evaluate(build(FrictionLawDef{}), contact, h, {Vec3(0, 1e-3, 0)});
        for (int k = 0; k < 3; ++k) {
          ASSERT_TRUE(std::isfinite(force.f_W[k]) && std::isfinite(force.z_W[k]) && std::isfinite(force.d_normal[k]))
              << N << " " << speed << " " << h;
          ASSERT_TRUE(std::isfinite(norm(force.d_velocity.c[k]))) << N << " " << speed << " " << h;
        }
      }
    }
  }
}

TEST_F(FrictionProperty, BristlesAreCarriedWithTheirNormal) {
  for (int i = 0; i < 1000; ++i) {
    const Draw d = draw();
    Vec3 to = vector();
    to = to * (1 / norm(to));
    FrictionState turned = d.state;
    turn_bristle(d.contact.n_W, to, uniform(-1, 1), turned);
    const double length = norm(d.state.z_W);
    ASSERT_NEAR(norm(turned.z_W), length, 1e-9 * length);
    ASSERT_NEAR(dot(turned.z_W, to), 0, 1e-9 * length);
  }
  FrictionState quarter{Vec3(1, 0, 0)};
  turn_bristle({0, 0, 1}, {0, 0, 1}, M_PI / 2, quarter);
  EXPECT_LT(norm(quarter.z_W - Vec3(0, 1, 0)), 1e-15);
  FrictionState tilted{Vec3(1, 0, 0)};
  turn_bristle({0, 0, 1}, {1, 0, 0}, 0, tilted);
  EXPECT_LT(norm(tilted.z_W - Vec3(0, 0, -1)), 1e-15);
  turn_bristle({0, 0, 1}, {0, 0, -1}, 0, tilted);
  EXPECT_EQ(norm(tilted.z_W), 0);
}

}  // namespace friction_test
}  // namespace slew::contact
