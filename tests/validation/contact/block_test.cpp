// SPDX-License-Identifier: Apache-2.0
// Case D03: a block on an incline sticks or slips, stops on the flat, rests at the depth of its weight. Backward Euler
// on depth and slide with both laws at the end of the step; tolerances of the case: 1e-3 relative.
#include <gtest/gtest.h>

#include <cmath>

#include "contact/friction_law.h"
#include "contact/normal_law.h"

namespace slew::contact {
namespace block_test {

using math::Vec3;

constexpr double kGravity = 9.81;

class Block {
 public:
  // angle [rad] of the incline
  Block(double mass, double angle, const NormalLawDef& normal, const FrictionLawDef& friction, double speed = 0)
      : mass_(mass), angle_(angle), normal_(contact::build(normal)), friction_(contact::build(friction)), v(speed) {}

  void run(double duration, double h) {
    const int steps = static_cast<int>(std::lround(duration / h));
    for (int i = 0; i < steps; ++i) step(h);
  }

  void step(double h) {
    observe(normal_, d, w, normal_state_);
    // depth: own Newton, the slide has no effect on it
    double w1 = w;
    NormalForce N;
    for (int i = 0; i < 50; ++i) {
      N = evaluate(normal_, 1, d + h * w1, w1, normal_state_);
      const double residual = mass_ * (w1 - w) - h * (mass_ * kGravity * std::cos(angle_) - N.force);
      const double change = -residual / (mass_ + h * (h * N.d_depth + N.d_depth_rate));
      w1 += change;
      if (std::fabs(change) < 1e-16) break;
    }
    d += h * w1;
    w = w1;
    N = evaluate(normal_, 1, d, w, normal_state_);
    // slide
    double v1 = v;
    FrictionForce F;
    for (int i = 0; i < 50; ++i) {
      F = friction_at(v1, N.force, h);
      const double residual = mass_ * (v1 - v) - h * (mass_ * kGravity * std::sin(angle_) - F.f_W[0]);
      const double change = -residual / (mass_ + h * F.d_velocity(0, 0));
      v1 += change;
      if (std::fabs(change) < 1e-16) break;
    }
    F = friction_at(v1, N.force, h);
    x += h * v1;
    v = v1;
    bristles_.z_W = F.z_W;
    normal_force = N.force;
    friction_force = F.f_W[0];
  }

  // at rest along the incline, bristles bent by z [m]
  void hold(double z) {
    v = 0;
    bristles_.z_W = Vec3(z, 0, 0);
  }
  [[nodiscard]] double bristle() const { return bristles_.z_W[0]; }

 private:
  [[nodiscard]] FrictionForce friction_at(double speed, double N, double h) const {
    return evaluate(friction_, {.n_W = {0, 0, 1}, .v_W = {speed, 0, 0}, .normal_force = N}, h, bristles_);
  }
  double mass_, angle_;
  NormalLaw normal_;
  FrictionLaw friction_;
  NormalState normal_state_;
  FrictionState bristles_;

 public:
  double d = 0, w = 0;  // depth and its rate
  double x = 0, v = 0;  // slide down the incline
  double normal_force = 0, friction_force = 0;
};

constexpr double kDegree = M_PI / 180;

NormalLawDef ground() {
  return {.stiffness = 1e7, .restitution = 0.1};
}

FrictionLawDef dry(double mu) {
  FrictionLawDef def;
  def.stiffness = 1e6;
  def.damping = 1e3;
  def.viscosity = 0;
  def.static_coefficient = mu;
  def.dynamic_coefficient = mu;
  return def;
}

TEST(Block, SticksOnAFlatIncline) {
  Block block(1, 15 * kDegree, ground(), dry(0.3));
  block.run(1, 1e-4);
  EXPECT_NEAR(block.friction_force, 2.539014832, 1e-3 * 2.539);
  EXPECT_NEAR(block.normal_force, 9.475732356, 1e-3 * 9.4757);
  EXPECT_NEAR(block.bristle(), kGravity * std::sin(15 * kDegree) / 1e6, 1e-6 * 2.5e-6);
  // no creep at all, in steps that see nothing of the bristles' own motion
  const double x = block.x;
  block.run(3600, 1e-2);
  EXPECT_NEAR(block.x, x, 1e-12);
  EXPECT_LT(std::fabs(block.v), 1e-15);
}

// Table 12 under a bag of 500 kg. Its bristles hold the weight of 15 degrees when bent by 0.32 m; let go unbent, the
// bag is faster than the Stribeck speed long before that and only the dynamic friction (5.7 degrees) counts.
TEST(Block, OfTheThesisFrictionSticksOnItsSoftBristles) {
  const NormalLawDef bag{.stiffness = 5e7, .restitution = 0.1};
  const double weight = 500 * kGravity * std::sin(15 * kDegree);
  Block bent(500, 15 * kDegree, bag, FrictionLawDef{});
  bent.run(0.1, 1e-3);  // onto the ground, 3e-5 m of depth
  bent.hold(weight / 4000);
  const double x = bent.x;
  bent.run(600, 1e-3);
  EXPECT_NEAR(bent.friction_force, weight, 1e-6 * weight);
  EXPECT_NEAR(bent.x, x, 1e-9);

  Block unbent(500, 5 * kDegree, bag, FrictionLawDef{});
  unbent.run(60, 1e-3);
  const double sag = 500 * kGravity * std::sin(5 * kDegree) / 4000;
  EXPECT_NEAR(unbent.bristle(), sag, 1e-6 * sag);
  const double rest = unbent.x;
  unbent.run(600, 1e-3);
  EXPECT_NEAR(unbent.x, rest, 1e-9);
}

TEST(Block, SlipsOnASteepIncline) {
  Block block(1, 30 * kDegree, ground(), dry(0.3));
  block.run(0.5, 1e-4);
  const double v = block.v;
  block.run(0.5, 1e-4);
  EXPECT_NEAR((block.v - v) / 0.5, 2.356287237, 1e-3 * 2.356);
  EXPECT_NEAR(block.x, 1.178143618, 1e-3 * 1.178);
}

TEST(Block, StopsOnTheFlat) {
  Block block(1, 0, ground(), dry(0.3), 2);
  double t = 0;
  while (block.v > 0 && t < 2) {
    block.step(1e-4);
    t += 1e-4;
  }
  EXPECT_NEAR(block.x, 0.6795786612, 1e-3 * 0.68);
  EXPECT_NEAR(t, 0.6795786612, 1e-3 * 0.68);
  block.run(1, 1e-4);
  EXPECT_NEAR(block.x, 0.6795786612, 1e-3 * 0.68);
  EXPECT_LT(std::fabs(block.v), 1e-12);
}

TEST(RestingBlock, GoesAsDeepAsItsWeightRequires) {
  Block linear(2, 0, {.stiffness = 1e6}, dry(0.3));
  linear.run(2, 1e-4);
  EXPECT_NEAR(linear.d, 1.962e-5, 1e-6 * 1.962e-5);
  // Hertz's case is for 2 kg as well
  Block hertz(2, 0, {.stiffness = 1e8, .exponent = 1.5}, dry(0.3));
  hertz.run(2, 1e-4);
  EXPECT_NEAR(hertz.d, 3.376494153e-5, 1e-6 * 3.3765e-5);
}

}  // namespace block_test
}  // namespace slew::contact
