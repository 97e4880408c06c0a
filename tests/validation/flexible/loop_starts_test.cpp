// SPDX-License-Identifier: Apache-2.0
// Starts of flexible bodies in moving loops against the kinematics of the rigid mechanisms: slider-crank and four-bar.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/validation/flexible/strip.h"
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace loop_starts_test {

using namespace testing;
using math::Vec3;

enum class Bends { by_modes, by_segments };

constexpr double kTight = 1e-9;  // relative to the largest speed

// A beam of square section along x as the body of that name: with two modes a plane, or in segments.
void bend(MechanicsDef& def, Bends how, const std::string& body, double length, double side = 0.02) {
  const flex::BeamDef beam =
      flex::testing::straight(flex::testing::square(side), flex::testing::steel(), {length, 0, 0}, 13);
  const auto found =
      std::find_if(def.bodies.begin(), def.bodies.end(), [&](const BodyDef& b) { return b.name == body; });
  if (how == Bends::by_modes) {
    found->type = BodyType::flexible;
    def.flexible_bodies.push_back(
        {.body = body, .modes = slew::testing::modes_of(beam, flex::testing::with_modes(6), {1, 2, 3, 4})});
  } else {
    found->type = BodyType::segmented;
    def.segmented_bodies.push_back({.body = body, .chain = slew::testing::segments_of(beam, 8)});
  }
}

// bodies that a segmented one is made of, root first; the body itself where it has modes
std::vector<std::string> pieces(const Mechanism& mechanism, const std::string& body) {
  std::vector<std::string> names;
  for (const Body& piece : mechanism.model.bodies) {
    if (piece.name == body || piece.name.rfind(body + ".", 0) == 0) names.push_back(piece.name);
  }
  return names;
}

// every piece moves as the rigid body that turns with w about z, and that has the velocity v at p
void expect_rigid_motion(const Mechanism& mechanism, const std::string& body, Vec3 p, Vec3 v, double w,
                         double tolerance) {
  const std::vector<std::string> names = pieces(mechanism, body);
  EXPECT_GE(names.size(), 2U);
  for (const std::string& name : names) {
    const BodyPose pose = mechanism.pose(name);
    const Vec3 exact = v + cross(Vec3(0, 0, w), Vec3(pose.position) - p);
    EXPECT_LE(norm(Vec3(pose.velocity) - exact), tolerance) << name;
    EXPECT_LE(norm(Vec3(pose.angular_velocity) - Vec3(0, 0, w)), tolerance * 10) << name;
  }
  for_each_mode(mechanism.model, [&](std::size_t, std::size_t u) { EXPECT_NEAR(mechanism.state.u[u], 0, tolerance); });
}

Vec3 along(double angle, double length) {
  return {length * std::cos(angle), length * std::sin(angle), 0};
}

struct SliderCrank {
  double r, L, phi, phi_dot;
  [[nodiscard]] double psi() const { return -std::asin(r / L * std::sin(phi)); }
  [[nodiscard]] double psi_dot() const { return -r * std::cos(phi) * phi_dot / (L * std::cos(psi())); }
  [[nodiscard]] double slider() const { return r * std::cos(phi) + L * std::cos(psi()); }
  [[nodiscard]] double slider_dot() const { return -r * std::sin(phi) * phi_dot - L * std::sin(psi()) * psi_dot(); }
  [[nodiscard]] Vec3 pin() const { return along(phi, r); }
  [[nodiscard]] Vec3 pin_dot() const { return cross(Vec3(0, 0, phi_dot), pin()); }
};

MechanicsDef slider_crank(const SliderCrank& at, Bends how) {
  MechanicsDef def;
  def.gravity = {};
  const Triple slot = {0, M_PI / 2, 0};
  def.bodies = {{.name = "Crank",
                 .orientation = {at.phi, 0, 0},
                 .mass = 2,
                 .center_of_mass = {at.r / 2, 0, 0},
                 .inertia = {0.01, 0.02, 0.02}},
                {.name = "Conrod", .position = at.pin().array(), .orientation = {at.psi(), 0, 0}},
                {.name = "Slider", .position = {at.slider(), 0, 0}, .mass = 0.5, .inertia = {1e-3, 1e-3, 1e-3}}};
  def.joints = {
      {.name = "Pivot", .body2 = "Crank", .initial_velocity = at.phi_dot},
      {.name = "Crank_Pin", .body1 = "Crank", .point1 = {at.r, 0, 0}, .body2 = "Conrod"},
      {.name = "Wrist", .body1 = "Conrod", .point1 = {at.L, 0, 0}, .body2 = "Slider"},
      {.name = "Slot", .type = JointType::prismatic, .orientation1 = slot, .body2 = "Slider", .orientation2 = slot}};
  bend(def, how, "Conrod", at.L);
  def.integrator = Integrator::trapezoidal;
  def.max_substep = 2e-5;
  return def;
}

class LoopStarts : public ::testing::TestWithParam<Bends> {};

TEST_P(LoopStarts, ASliderCrankMovesAsInItsKinematics) {
  for (const double phi : {0.4, 1.0, 2.2, -1.3}) {
    for (const double L : {0.3, 0.45}) {
      const SliderCrank at{.r = 0.1, .L = L, .phi = phi, .phi_dot = 150};
      const Mechanism crank(slider_crank(at, GetParam()));
      SCOPED_TRACE("phi " + std::to_string(phi) + ", L " + std::to_string(L));
      const double size = kTight * at.r * at.phi_dot;
      EXPECT_NEAR(crank.value("Pivot.velocity"), at.phi_dot, kTight * at.phi_dot);
      EXPECT_NEAR(crank.pose("Slider").velocity[0], at.slider_dot(), size);
      EXPECT_LE(norm(Vec3(crank.pose("Crank").angular_velocity) - Vec3(0, 0, at.phi_dot)), kTight * at.phi_dot);
      expect_rigid_motion(crank, "Conrod", at.pin(), at.pin_dot(), at.psi_dot(), size);
    }
  }
}

// Rates of modes that the scene gives stay; the crank as well, and the loop closes by what is left: the frame and the
// slider. From a straight conrod the far end's rate across it and the frame's turn are one motion, psi' L = w L + w_y':
// the slider moves as with a rigid conrod.
TEST(LoopStart, WithRatesOfModesClosesByTheOtherSpeeds) {
  const SliderCrank at{.r = 0.1, .L = 0.4, .phi = 1.0, .phi_dot = 20};
  MechanicsDef def = slider_crank(at, Bends::by_modes);
  // bending out of the plane is held by the joints
  std::vector<double> rates;
  double across = 0;  // m/s, of the far end
  for (const Vec3& shift : def.flexible_bodies[0].modes->nodes.back().shift) {
    rates.push_back(std::fabs(shift[1]) > std::fabs(shift[2]) ? 0.05 : 0);
    across += rates.back() * shift[1];
  }
  ASSERT_GT(std::fabs(across), 1e-3);
  def.flexible_bodies[0].start_rates = rates;
  Formulated crank(def);
  EXPECT_NEAR(crank.value("Pivot.velocity"), at.phi_dot, kTight * at.phi_dot);
  std::size_t mode = 0;
  for_each_mode(crank.model, [&](std::size_t, std::size_t u) { EXPECT_NEAR(crank.state.u[u], rates[mode++], 1e-12); });
  EXPECT_EQ(mode, rates.size());
  EXPECT_NEAR(crank.pose("Slider").velocity[0], at.slider_dot(), kTight * at.r * at.phi_dot);
  EXPECT_NEAR(crank.pose("Conrod").angular_velocity[2], at.psi_dot() - across / at.L, kTight * at.phi_dot);
  const double before = crank.pose("Slider").position[0], speed = crank.pose("Slider").velocity[0];
  crank.run(2e-5, 2e-6);
  EXPECT_NEAR((crank.pose("Slider").position[0] - before) / 2e-5, speed, 0.02 * std::fabs(speed));
  EXPECT_LE(opening(crank).rate, 1e-8);
}

// A fast crank, 3 rad of its turn: the stiff conrod bends, but the slider is where the crank's angle puts it.
TEST_P(LoopStarts, AFastSliderCrankStaysWhole) {
  const SliderCrank at{.r = 0.1, .L = 0.4, .phi = 0.8, .phi_dot = 100};
  Formulated crank(slider_crank(at, GetParam()));
  for (int i = 0; i < 10; ++i) {
    crank.run(3e-3, 2e-5);
    SliderCrank now = at;
    now.phi = crank.value("Pivot.position");
    EXPECT_NEAR(crank.pose("Slider").position[0], now.slider(), 1e-4) << "after " << 3 * (i + 1) << " ms";
  }
}

// Four-bar: crank a, coupler b, follower c, ground d along x.
struct FourBar {
  double a, b, c, d, theta;
  [[nodiscard]] Vec3 crank_pin() const { return along(theta, a); }
  // the open branch
  [[nodiscard]] Vec3 coupler_pin() const {
    const Vec3 D = Vec3(d, 0, 0) - crank_pin();
    const double e = norm(D), x = (e * e + b * b - c * c) / (2 * e), y = std::sqrt(b * b - x * x);
    const Vec3 n = D * (1 / e);
    return crank_pin() + n * x + Vec3(-n[1], n[0], 0) * y;
  }
  // rates of coupler and follower: w_a x a + w_b x b = w_c x c
  [[nodiscard]] std::pair<double, double> rates(double w) const {
    const Vec3 A = crank_pin(), B = coupler_pin() - A, C = coupler_pin() - Vec3(d, 0, 0);
    const double det = B[0] * C[1] - B[1] * C[0];
    return {w * (A[1] * C[0] - A[0] * C[1]) / det, w * (A[1] * B[0] - A[0] * B[1]) / det};
  }
};

double angle_of(Vec3 v) {
  return std::atan2(v[1], v[0]);
}

// The crank turns with w; coupler and follower bend.
MechanicsDef four_bar(const FourBar& bar, double w, Bends coupler, Bends follower) {
  const Vec3 A = bar.crank_pin(), B = bar.coupler_pin();
  MechanicsDef def;
  def.gravity = {};
  def.bodies = {
      {.name = "Crank", .orientation = {bar.theta, 0, 0}, .mass = 1, .inertia = {0.1, 0.1, 0.1}},
      {.name = "Coupler", .position = A.array(), .orientation = {angle_of(B - A), 0, 0}},
      {.name = "Follower", .position = {bar.d, 0, 0}, .orientation = {angle_of(B - Vec3(bar.d, 0, 0)), 0, 0}}};
  def.joints = {{.name = "Pivot", .body2 = "Crank", .initial_velocity = w},
                {.name = "Foot", .point1 = {bar.d, 0, 0}, .body2 = "Follower"},
                {.name = "Crank_Pin", .body1 = "Crank", .point1 = {bar.a, 0, 0}, .body2 = "Coupler"},
                {.name = "Coupler_Pin",
                 .body1 = "Coupler",
                 .point1 = {bar.b, 0, 0},
                 .body2 = "Follower",
                 .point2 = {bar.c, 0, 0}}};
  bend(def, coupler, "Coupler", bar.b, 0.04);
  bend(def, follower, "Follower", bar.c, 0.04);
  def.integrator = Integrator::trapezoidal;
  def.max_substep = 1e-4;
  return def;
}

void expect_motion_of(const FourBar& bar, double w, const Mechanism& mechanism) {
  const auto [w_b, w_c] = bar.rates(w);
  const double size = kTight * w * bar.a;
  expect_rigid_motion(mechanism, "Coupler", bar.crank_pin(), cross(Vec3(0, 0, w), bar.crank_pin()), w_b, size);
  expect_rigid_motion(mechanism, "Follower", Vec3(bar.d, 0, 0), Vec3(), w_c, size);
}

TEST_P(LoopStarts, AFourBarMovesAsInItsKinematics) {
  for (const double theta : {0.5, 1.4, 2.6}) {
    SCOPED_TRACE("theta " + std::to_string(theta));
    const FourBar bar{.a = 0.3, .b = 0.9, .c = 0.7, .d = 1.0, .theta = theta};
    expect_motion_of(bar, 40, Mechanism(four_bar(bar, 40, GetParam(), GetParam())));
  }
}

// In one loop, without a joint that closes it beside the segments: undeformed, whatever the load.
TEST(LoopStart, OfModesBesideSegmentsUnderGravityIsUndeformed) {
  const FourBar bar{.a = 0.3, .b = 0.9, .c = 0.7, .d = 1.0, .theta = 1.4};
  for (const auto& [coupler, follower] : {std::pair(Bends::by_modes, Bends::by_segments),
                                          {Bends::by_segments, Bends::by_modes},
                                          {Bends::by_segments, Bends::by_segments}}) {
    MechanicsDef def = four_bar(bar, 40, coupler, follower);
    def.gravity = {0, -9.81, 0};
    Problems problems;
    validate(def, problems);
    EXPECT_TRUE(problems.empty()) << problems.front().what;
    Formulated mechanism(def);
    expect_motion_of(bar, 40, mechanism);
    mechanism.run(0.01, 1e-3);
    EXPECT_LE(opening(mechanism).position, 1e-8);
  }
}

INSTANTIATE_TEST_SUITE_P(Of, LoopStarts, ::testing::Values(Bends::by_modes, Bends::by_segments),
                         [](const auto& tested) {
                           return tested.param == Bends::by_modes ? "BodiesWithModes" : "SegmentedBodies";
                         });

// No loop, but the joint is at the far end of the beam: the lumps turn about it.
TEST(TipJoint, SegmentsThatAJointHoldsAtTheirTipTurnAboutIt) {
  MechanicsDef def;
  def.bodies = {{.name = "Beam", .position = {-1, 0, 0}}};
  def.joints = {{.name = "Hinge", .body2 = "Beam", .point2 = {1, 0, 0}, .initial_velocity = 7}};
  bend(def, Bends::by_segments, "Beam", 1, 0.05);
  def.integrator = Integrator::trapezoidal;
  expect_rigid_motion(Mechanism(def), "Beam", Vec3(), Vec3(), 7, 7 * kTight);
}

}  // namespace loop_starts_test
}  // namespace slew::multibody
