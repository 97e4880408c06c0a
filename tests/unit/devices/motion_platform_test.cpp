// SPDX-License-Identifier: Apache-2.0
#include "devices/motion_platform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>

#include "core/allocation_guard.h"
#include "core/failure.h"
#include "math/rotation.h"

namespace slew::devices {
namespace motion_platform_test {

constexpr double g = kStandardGravity;

// alternate pairs of joints on two circles, legs crossing from pair to pair
HexapodDef hexapod() {
  HexapodDef def;
  constexpr double kDegree = M_PI / 180;
  for (const double angle : {5.0, 115.0, 125.0, 235.0, 245.0, 355.0}) {
    def.base_joints.push_back({1.2 * std::cos(angle * kDegree), 1.2 * std::sin(angle * kDegree), 0});
  }
  for (const double angle : {55.0, 65.0, 175.0, 185.0, 295.0, 305.0}) {
    def.platform_joints.push_back({0.9 * std::cos(angle * kDegree), 0.9 * std::sin(angle * kDegree), -0.05});
  }
  def.neutral_height = 1.1;
  def.shortest_leg = 1.1;
  def.longest_leg = 1.8;
  return def;
}

MotionPlatformDef platform_def() {
  MotionPlatformDef def;
  def.name = "Platform";
  def.hexapod = hexapod();
  return def;
}

// filters alone: unit scales, no bounds in reach
WashoutDef plain_washout() {
  WashoutDef def;
  def.force_scale = def.rate_scale = {1, 1, 1};
  def.max_acceleration = {100, 100, 100};
  def.max_rate = {100, 100, 100};
  return def;
}

Triple felt(double forward, double left = 0, double up = 0) {
  return {forward, left, g + up};
}

TEST(Washout, AStepOfAccelerationGoesBackToNeutral) {
  for (const double h : {0.001, 0.005, 0.02}) {
    const WashoutDef def = plain_washout();
    const Washout washout = build_washout(def, h);
    WashoutState state;
    const double a = 2, w = def.translation_frequency[0], b = def.return_frequency[0], k = 1 / ((w - b) * (w - b));
    double largest = 0;
    PlatformPose pose;
    for (int n = 1; n * h <= 80; ++n) {
      pose = step(washout, felt(a), {}, state);
      // a/((s + w)^2 (s + b)) in partial fractions
      const double t = n * h;
      const double expected = a * (k * std::exp(-b * t) - k * std::exp(-w * t) - t * std::exp(-w * t) / (w - b));
      ASSERT_NEAR(pose.position[0], expected, 1e-12) << h << " " << t;
      largest = std::max(largest, pose.position[0]);
    }
    EXPECT_GT(largest, 0.15);
    EXPECT_NEAR(pose.position[0], 0, 2e-9);
    EXPECT_EQ(pose.position[1], 0);
    EXPECT_EQ(pose.position[2], 0);
  }
}

TEST(Washout, SecondOrderKeepsAnOffset) {
  WashoutDef def = plain_washout();
  def.return_frequency = {0, 0, 0};
  const Washout washout = build_washout(def, 0.01);
  WashoutState state;
  const double w = def.translation_frequency[2];
  for (int n = 1; n <= 1000; ++n) {
    const double t = 0.01 * n, z = step(washout, felt(0, 0, -3), {}, state).position[2];
    ASSERT_NEAR(z, -3 * (1 - std::exp(-w * t) * (1 + w * t)) / (w * w), 1e-12);
  }
}

TEST(Washout, ASustainedAccelerationIsShownByGravity) {
  WashoutDef def = plain_washout();
  def.force_scale = {0.5, 0.5, 0.5};
  const auto settled = [&](const Triple& f) {
    const Washout washout = build_washout(def, 0.005);
    WashoutState state;
    PlatformPose pose;
    for (int n = 0; n < 20000; ++n) pose = step(washout, f, {}, state);
    return pose;
  };
  const PlatformPose forward = settled(felt(3));
  EXPECT_NEAR(forward.angles[1], -std::asin(0.5 * 3 / g), 1e-9);  // nose up
  EXPECT_EQ(forward.angles[0], 0);
  EXPECT_NEAR(settled(felt(0, 2)).angles[0], std::asin(0.5 * 2 / g), 1e-9);
  // both at once: what the seat feels of gravity has both components
  const PlatformPose both = settled(felt(-2, 3));
  const math::Mat3 R =
      math::rotation_z(both.angles[2]) * math::rotation_y(both.angles[1]) * math::rotation_x(both.angles[0]);
  const math::Vec3 f = math::transpose_multiply(R, math::Vec3(0, 0, g));
  EXPECT_NEAR(f.x(), 0.5 * -2, 1e-8);
  EXPECT_NEAR(f.y(), 0.5 * 3, 1e-8);
  // beyond max_tilt
  def.force_scale = {1, 1, 1};
  EXPECT_NEAR(settled(felt(3)).angles[1], -def.max_tilt, 1e-12);
  EXPECT_LE(std::abs(settled(felt(90, 90)).angles[1]), def.max_tilt + 1e-15);
  EXPECT_LE(std::abs(settled(felt(90, 90)).angles[0]), def.max_tilt + 1e-15);
}

// response of a coordinate to a sine, measured over one period after the transients
template <typename Play>
std::complex<double> measured_response(int samples, double h, Play play) {
  const double w = 2 * M_PI / (samples * h);
  const int settle = static_cast<int>(std::ceil(100 / (samples * h))) * samples;
  std::complex<double> sum = 0;
  for (int n = 0; n < settle + samples; ++n) {
    // the input of step n holds from n h on, the output is that at its end
    const double y = play(std::sin(w * n * h));
    if (n >= settle) sum += y * std::polar(1.0, -w * (n + 1) * h);
  }
  return sum * (2.0 / samples) * std::complex<double>(0, 1);
}

// A zero-order hold delays by h/2 and lowers the amplitude by (w h)^2/24. The images of the samples, k 2 pi/h away, add
// the sum of G(k 2 pi/h) w h/(2 pi k): w h^2/12 for a law that ends as 1/s, and nothing of this order for one that ends
// as 1/s^2, whose images cancel in pairs.
void expect_law(std::complex<double> measured, std::complex<double> law, double images, double w, double h) {
  const double hold = (w * h) * (w * h) / 24 * std::abs(law), rounding = 1e-8 * std::abs(law);
  // 1.05: terms of higher order
  EXPECT_LT(std::abs(measured * std::polar(1.0, w * h / 2) - law), 1.05 * (hold + images) + rounding) << w;
}

TEST(Washout, TheHighPassesHaveTheirFrequencyResponse) {
  WashoutDef def = plain_washout();
  def.translation_damping = {0.7, 1, 1};
  def.rotation_damping = {0.8, 1, 1};
  const double h = 0.002;
  const Washout washout = build_washout(def, h);
  for (const int samples : {15000, 1250, 150}) {  // below, at and above the corner
    const double w = 2 * M_PI / (samples * h), wn = def.translation_frequency[0], wr = def.rotation_frequency[0];
    const std::complex<double> s(0, w);
    WashoutState state;
    const auto x =
        measured_response(samples, h, [&](double u) { return step(washout, felt(u), {}, state).position[0]; });
    const auto law = s / ((s * s + 2 * 0.7 * wn * s + wn * wn) * (s + def.return_frequency[0]));
    expect_law(x, law, 0, w, h);
    // as an acceleration: s^3 over the same, 1 far above the corner
    if (samples == 150) {
      EXPECT_NEAR(std::abs(s * s * x), 1, 0.03);
    }

    state = {};
    const auto roll = measured_response(samples, h, [&](double r) {
      return step(washout, felt(0), {r, 0, 0}, state).angles[0];
    });
    const auto rate_law = s / (s * s + 2 * 0.8 * wr * s + wr * wr);
    expect_law(roll, rate_law, w * h * h / 12, w, h);
  }
}

TEST(Washout, AConstantRateTurnsNothingForEver) {
  const Washout washout = build_washout(plain_washout(), 0.01);
  WashoutState state;
  double largest = 0;
  PlatformPose pose;
  for (int n = 0; n < 4000; ++n) {
    pose = step(washout, felt(0), {0, 0, 0.5}, state);
    largest = std::max(largest, pose.angles[2]);
  }
  EXPECT_NEAR(largest, 0.5 / M_E, 1e-4);  // r t e^-t at t = 1 s
  EXPECT_NEAR(pose.angles[2], 0, 1e-9);
}

TEST(Washout, TheTiltNeverTurnsFasterThanItsRate) {
  const double h = 0.005;
  const WashoutDef def = plain_washout();
  const Washout washout = build_washout(def, h);
  WashoutState state;
  std::mt19937 random(2);
  std::uniform_real_distribution<double> force(-30, 30);
  Triple f = felt(0);
  Triple before{};
  double fastest = 0;
  for (int n = 0; n < 40000; ++n) {
    if (n % 97 == 0) f = felt(force(random), force(random), force(random));
    const PlatformPose pose = step(washout, f, {}, state);
    for (std::size_t i = 0; i < 2; ++i) fastest = std::max(fastest, std::abs(pose.angles[i] - before[i]) / h);
    before = pose.angles;
  }
  EXPECT_LE(fastest, def.tilt_rate * (1 + 1e-12));
  EXPECT_GT(fastest, def.tilt_rate * 0.999);
}

TEST(Hexapod, LegsOfAHeaveAndOfAYawAreInClosedForm) {
  const HexapodDef def = hexapod();
  for (const double z : {-0.2, 0.0, 0.13}) {
    const LegLengths legs = leg_lengths(def, {.position = {0, 0, z}, .angles = {}});
    for (std::size_t i = 0; i < kLegs; ++i) {
      // each leg spans 50 degrees of the circle
      const double flat2 = 1.2 * 1.2 + 0.9 * 0.9 - 2 * 1.2 * 0.9 * std::cos(50 * M_PI / 180);
      EXPECT_NEAR(legs[i], std::sqrt(flat2 + (1.05 + z) * (1.05 + z)), 1e-14);
    }
  }
  const double psi = 0.2;
  const LegLengths legs = leg_lengths(def, {.position = {}, .angles = {0, 0, psi}});
  for (std::size_t i = 0; i < kLegs; ++i) {
    // the platform's joints are ahead of the base's on legs 1, 3, 5 and behind on 2, 4, 6
    const double span = (i % 2 == 0 ? 1 : -1) * 50 * M_PI / 180 + psi;
    const double flat2 = 1.2 * 1.2 + 0.9 * 0.9 - 2 * 1.2 * 0.9 * std::cos(span);
    EXPECT_NEAR(legs[i], std::sqrt(flat2 + 1.05 * 1.05), 1e-14);
  }
}

TEST(Hexapod, ARolledPlatformLowersItsRightSide) {
  // positive roll about x (forward): left (y > 0) goes up, legs there are longer
  const HexapodDef def = hexapod();
  const LegLengths neutral = leg_lengths(def, {}), rolled = leg_lengths(def, {.position = {}, .angles = {0.1, 0, 0}});
  for (std::size_t i = 0; i < kLegs; ++i) {
    if (std::abs(def.platform_joints[i][1]) < 0.2) continue;
    EXPECT_EQ(rolled[i] > neutral[i], def.platform_joints[i][1] > 0) << i;
  }
}

TEST(Hexapod, DrawsAPoseBackUntilItsLegsReach) {
  HexapodDef def = hexapod();
  const PlatformPose near = {.position = {0.05, 0, 0.02}, .angles = {0.02, 0, 0}};
  const ReachablePose kept = reachable(def, {}, near);
  EXPECT_FALSE(kept.was_drawn_back);
  EXPECT_EQ(kept.pose.position, near.position);
  const PlatformPose far = {.position = {0, 0, 2}, .angles = {0, 0, 0.1}};
  const ReachablePose drawn = reachable(def, {}, far);
  EXPECT_TRUE(drawn.was_drawn_back);
  EXPECT_TRUE(is_within_stroke(def, drawn.legs));
  double longest = 0;
  for (const double leg : drawn.legs) longest = std::max(longest, leg);
  EXPECT_NEAR(longest, def.longest_leg, 1e-6);
  EXPECT_NEAR(drawn.pose.angles[2] / drawn.pose.position[2], 0.05, 1e-12);  // on the straight line
}

TEST(SoftLimit, IsStraightThenBendsAndNeverEnds) {
  double before = -1, slope_before = 1;
  for (int i = -4000; i <= 4000; ++i) {
    const double q = i * 1e-3, y = soft_limited(q, 0.5, 0.8);
    EXPECT_LE(std::abs(y), 0.5);
    if (std::abs(q) <= 0.4) {
      EXPECT_EQ(y, q);
    }
    EXPECT_GE(y, before);
    EXPECT_EQ(soft_limited(-q, 0.5, 0.8), -y);
    const double slope = (soft_limited(q + 1e-6, 0.5, 0.8) - y) / 1e-6;
    if (i > -4000) {
      EXPECT_NEAR(slope, slope_before, 0.011);  // no jump: it changes by less than 1/((1 - c) L) a metre
    }
    before = y, slope_before = slope;
  }
  EXPECT_EQ(soft_limited(1e300, 0.5, 0.8), 0.5);
}

struct Played {
  explicit Played(const MotionPlatformDef& def = platform_def(), double step = 0.005)
      : platform(build_platform(def, step)), state(initial_state(platform)) {}
  void play(double seconds, PlatformCommand command, const std::optional<SeatMotion>& motion) {
    for (int n = 0; n < std::lround(seconds / platform.step); ++n) {
      const PlatformPose before = state.pose;
      const AllocationGuard guard;
      step(platform, command, motion, state);
      EXPECT_EQ(guard.allocations(), 0U);
      for (std::size_t i = 0; i < 3; ++i) {
        fastest = std::max(fastest, std::abs(state.pose.position[i] - before.position[i]) / platform.step);
        EXPECT_LE(std::abs(state.pose.angles[i]), platform.def.angle_limit[i]);
      }
      EXPECT_LE(std::abs(state.pose.position[0]), platform.def.position_limit[0]);
      EXPECT_LE(std::abs(state.pose.position[1]), platform.def.position_limit[1]);
      EXPECT_LE(state.pose.position[2], platform.def.position_limit[2]);
      EXPECT_TRUE(is_within_stroke(platform.def.hexapod, state.legs));
    }
  }
  MotionPlatform platform;
  MotionPlatformState state;
  double fastest = 0;  // m/s
};

constexpr auto kRun = PlatformCommand::run;
constexpr auto kPark = PlatformCommand::park;
const SeatMotion kStill;

TEST(MotionPlatform, RisesShowsMotionAndParks) {
  Played played;
  EXPECT_EQ(played.state.phase, PlatformPhase::parked);
  EXPECT_EQ(played.state.pose.position[2], -0.1);
  played.play(1, kPark, kStill);
  EXPECT_EQ(played.state.phase, PlatformPhase::parked);
  played.play(0.1, kPark, std::nullopt);
  played.play(1, kRun, std::nullopt);  // no samples: it stays down
  EXPECT_EQ(played.state.phase, PlatformPhase::parked);
  played.play(2, kRun, kStill);
  EXPECT_EQ(played.state.phase, PlatformPhase::rising);
  EXPECT_NEAR(played.state.pose.position[2], -0.05, 1e-3);
  played.play(2.1, kRun, kStill);
  EXPECT_EQ(played.state.phase, PlatformPhase::ramping_in);
  EXPECT_NEAR(played.state.pose.position[2], 0, 1e-12);
  const SeatMotion forward = {.f_P = felt(2), .w_P = {}};
  played.play(2.1, kRun, forward);
  EXPECT_EQ(played.state.phase, PlatformPhase::active);
  EXPECT_GT(played.state.pose.position[0], 0.01);
  played.play(1, kPark, forward);
  EXPECT_EQ(played.state.phase, PlatformPhase::washing_back);
  played.play(1.1, kPark, forward);
  EXPECT_EQ(played.state.phase, PlatformPhase::lowering);
  EXPECT_EQ(played.state.pose.position[0], 0);
  played.play(4.1, kPark, std::nullopt);
  EXPECT_EQ(played.state.phase, PlatformPhase::parked);
  EXPECT_EQ(played.state.pose.position[2], -0.1);
  EXPECT_LT(played.fastest, 0.3);  // no jump on the whole way
  EXPECT_EQ(played.state.freezes, 0U);
}

TEST(MotionPlatform, TurnsBackOnItsWay) {
  Played played;
  played.play(1.5, kRun, kStill);
  const double height = played.state.pose.position[2];
  played.play(0.005, kPark, kStill);
  EXPECT_EQ(played.state.phase, PlatformPhase::lowering);
  EXPECT_NEAR(played.state.pose.position[2], height, 1e-3);
  played.play(0.5, kPark, kStill);
  EXPECT_LT(played.state.pose.position[2], height);
  played.play(0.5, kRun, kStill);
  EXPECT_EQ(played.state.phase, PlatformPhase::rising);
  EXPECT_LT(played.fastest, 0.05);
}

TEST(MotionPlatform, FreezesOnSilenceThenWashesBackAndStartsAgain) {
  Played played;
  const SeatMotion moving = {.f_P = felt(3, 1, 1), .w_P = {0.1, 0.1, 0.1}};
  played.play(4.1, kRun, kStill);
  played.play(4, kRun, moving);
  ASSERT_EQ(played.state.phase, PlatformPhase::active);
  played.play(0.045, kRun, std::nullopt);  // a short gap: the last sample holds
  EXPECT_EQ(played.state.phase, PlatformPhase::active);
  played.play(0.005, kRun, std::nullopt);
  ASSERT_EQ(played.state.phase, PlatformPhase::frozen);
  const PlatformPose frozen = played.state.pose;
  EXPECT_GT(std::abs(frozen.position[0]), 0.01);
  played.play(0.4, kRun, std::nullopt);
  EXPECT_EQ(played.state.pose.position, frozen.position);
  EXPECT_EQ(played.state.pose.angles, frozen.angles);
  EXPECT_EQ(played.state.freezes, 1U);
  // samples come again: neutral first, then the ramp
  played.play(1.5, kRun, moving);
  EXPECT_EQ(played.state.phase, PlatformPhase::washing_back);
  played.play(0.7, kRun, moving);
  EXPECT_EQ(played.state.phase, PlatformPhase::ramping_in);
  EXPECT_LT(std::abs(played.state.pose.position[0]), 0.01);
  played.play(2.1, kRun, moving);
  EXPECT_EQ(played.state.phase, PlatformPhase::active);
  EXPECT_LT(played.fastest, 0.5);
  // and with no more of them it waits in neutral
  played.play(10, kRun, std::nullopt);
  EXPECT_EQ(played.state.phase, PlatformPhase::washing_back);
  EXPECT_EQ(played.state.pose.position, Triple{});
  EXPECT_EQ(played.state.freezes, 2U);
}

TEST(MotionPlatform, AGapThatHoldsTheSampleChangesNothing) {
  Played whole, with_gap;
  const SeatMotion moving = {.f_P = felt(1), .w_P = {}};
  for (Played* played : {&whole, &with_gap}) played->play(7, kRun, moving);
  whole.play(1, kRun, moving);
  for (int n = 0; n < 50; ++n) {
    with_gap.play(0.015, kRun, std::nullopt);
    with_gap.play(0.005, kRun, moving);
  }
  EXPECT_EQ(whole.state.pose.position, with_gap.state.pose.position);
  EXPECT_EQ(whole.state.pose.angles, with_gap.state.pose.angles);
}

TEST(MotionPlatform, SamplesThatAreNotFiniteCountAsNone) {
  Played played;
  played.play(7, kRun, kStill);
  ASSERT_EQ(played.state.phase, PlatformPhase::active);
  SeatMotion broken = kStill;
  broken.f_P[1] = NAN;
  played.play(0.05, kRun, broken);
  EXPECT_EQ(played.state.phase, PlatformPhase::frozen);
  EXPECT_EQ(played.state.not_finite, 10U);
  for (const double leg : played.state.legs) EXPECT_TRUE(std::isfinite(leg));
}

TEST(MotionPlatform, LimitsHoldForAnyMotion) {
  MotionPlatformDef def = platform_def();
  def.washout.force_scale = {3, 3, 3};
  def.washout.rate_scale = {3, 3, 3};
  def.washout.max_acceleration = {30, 30, 30};
  def.washout.max_rate = {10, 10, 10};
  def.washout.tilt_rate = 1;
  Played played(def);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> force(-40, 40), rate(-10, 10);
  played.play(6.2, kRun, kStill);
  for (int n = 0; n < 600; ++n) {
    const SeatMotion wild = {.f_P = {force(random), force(random), force(random)},
                             .w_P = {rate(random), rate(random), rate(random)}};
    played.play(0.005 * (1 + n % 40), kRun, wild);  // checks the bounds in each step
  }
  EXPECT_GT(played.state.saturated, 1000U);
  EXPECT_GT(played.state.drawn_back, 0U);
}

TEST(MotionPlatform, RefusesWrongDefinitions) {
  const auto with = [](auto change) {
    MotionPlatformDef def = platform_def();
    change(def);
    Problems problems;
    validate(def, problems);
    return problems.empty() ? "" : problems[0].path + ": " + problems[0].what;
  };
  EXPECT_EQ(with([](auto&) {}), "");
  EXPECT_EQ(with([](auto& d) { d.position_limit[1] = 0; }), "Platform.position_limit: 0 is out of range");
  EXPECT_EQ(with([](auto& d) { d.angle_limit[2] = 1.6; }), "Platform.angle_limit: 1.6 is out of range");
  EXPECT_EQ(with([](auto& d) { d.soft_from = 1; }), "Platform.soft_from: 1 is out of range");
  EXPECT_EQ(with([](auto& d) { d.park_height = -1; }), "Platform.park_height: -1 is out of range");
  EXPECT_EQ(with([](auto& d) { d.park_height = 0.6; }), "Platform.park_height: a leg is 1.032 m long when parked");
  EXPECT_EQ(with([](auto& d) { d.rise_time = 0; }), "Platform.rise_time: 0 is out of range");
  EXPECT_EQ(with([](auto& d) { d.ramp_time = 61; }), "Platform.ramp_time: 61 is out of range");
  EXPECT_EQ(with([](auto& d) { d.freeze_after = 0; }), "Platform.freeze_after: 0 is out of range");
  EXPECT_EQ(with([](auto& d) { d.hold_time = NAN; }), "Platform.hold_time: nan is out of range");
  EXPECT_EQ(with([](auto& d) { d.hexapod.base_joints.pop_back(); }), "Platform.base_joints: 5 joints");
  EXPECT_EQ(with([](auto& d) { d.hexapod.platform_joints.push_back({}); }), "Platform.platform_joints: 7 joints");
  EXPECT_EQ(with([](auto& d) { d.hexapod.base_joints[0][0] = NAN; }), "Platform.base_joints: nan is out of range");
  EXPECT_EQ(with([](auto& d) { d.hexapod.longest_leg = 1; }),
            "Platform.longest_leg: 1 m is not above shortest_leg, 1.1 m");
  EXPECT_EQ(with([](auto& d) { d.hexapod.longest_leg = 1.35; }),
            "Platform.neutral_height: leg 1 is 1.401 m long in neutral");
  EXPECT_EQ(with([](auto& d) { d.hexapod.neutral_height = 0; }), "Platform.neutral_height: 0 is out of range");
  const auto washout = [&](auto change, const char* key) {
    const std::string text = with([&](auto& d) { change(d.washout); });
    return text.starts_with("Platform." + std::string(key) + ": ") && text.ends_with("is out of range");
  };
  EXPECT_TRUE(washout([](auto& w) { w.force_scale[0] = -1; }, "force_scale"));
  EXPECT_TRUE(washout([](auto& w) { w.rate_scale[0] = 11; }, "rate_scale"));
  EXPECT_TRUE(washout([](auto& w) { w.max_acceleration[0] = 0; }, "max_acceleration"));
  EXPECT_TRUE(washout([](auto& w) { w.max_rate[0] = 0; }, "max_rate"));
  EXPECT_TRUE(washout([](auto& w) { w.translation_frequency[0] = 0; }, "translation_frequency"));
  EXPECT_TRUE(washout([](auto& w) { w.translation_damping[0] = 0; }, "translation_damping"));
  EXPECT_TRUE(washout([](auto& w) { w.return_frequency[0] = -1; }, "return_frequency"));
  EXPECT_TRUE(washout([](auto& w) { w.tilt_frequency = 0; }, "tilt_frequency"));
  EXPECT_TRUE(washout([](auto& w) { w.tilt_damping = 0; }, "tilt_damping"));
  EXPECT_TRUE(washout([](auto& w) { w.tilt_rate = 0; }, "tilt_rate"));
  EXPECT_TRUE(washout([](auto& w) { w.max_tilt = 2; }, "max_tilt"));
  EXPECT_TRUE(washout([](auto& w) { w.rotation_frequency[0] = 200; }, "rotation_frequency"));
  EXPECT_TRUE(washout([](auto& w) { w.rotation_damping[0] = 0; }, "rotation_damping"));
  EXPECT_THROW(static_cast<void>(build_platform({.name = "P"}, 0.005)), Failure);
}

}  // namespace motion_platform_test
}  // namespace slew::devices
