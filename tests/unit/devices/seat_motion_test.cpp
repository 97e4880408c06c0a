// SPDX-License-Identifier: Apache-2.0
// Specific force and angular velocity of a seat against closed forms.
#include "devices/seat_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/allocation_guard.h"

namespace slew::devices {
namespace seat_motion_test {

constexpr double kG = 9.81;

// y is up in Ground; the seat looks along -x of its body
SeatDef seat_def(const Triple& point = {}) {
  return {.point = point, .forward = {-2, 0, 0}, .up = {0, 3, 0}};
}
Seat seat_at(const Triple& point = {}) {
  return build_seat(seat_def(point), {0, -kG, 0});
}

void expect_near(const Triple& value, const Triple& expected, double tolerance) {
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(value[i], expected[i], tolerance) << "component " << i;
}

TEST(SeatMotion, AtRestGravityIsFeltUpward) {
  SeatState state;
  EXPECT_FALSE(seat_motion(seat_at(), {.time = 1}, state).has_value());
  const auto motion = seat_motion(seat_at(), {.time = 1.001}, state);
  ASSERT_TRUE(motion.has_value());
  expect_near(motion->f_P, {0, 0, kG}, 1e-12);
  expect_near(motion->w_P, {0, 0, 0}, 0);
  EXPECT_EQ(motion->time, 1.001);
}

TEST(SeatMotion, InFreeFallNothingIsFelt) {
  SeatState state;
  static_cast<void>(seat_motion(seat_at(), {.time = 0, .v_WB = {1, 2, 3}}, state));
  const auto motion = seat_motion(seat_at(), {.time = 0.01, .v_WB = {1, 2 - 0.01 * kG, 3}}, state);
  ASSERT_TRUE(motion.has_value());
  expect_near(motion->f_P, {0, 0, 0}, 1e-12);
}

TEST(SeatMotion, AxesAreForwardLeftUp) {
  SeatState state;
  static_cast<void>(seat_motion(seat_at(), {.time = 0}, state));
  const auto motion = seat_motion(seat_at(), {.time = 0.1, .v_WB = {-0.1, 0.2, 0.3}, .w_WB = {-4, 5, 6}}, state);
  ASSERT_TRUE(motion.has_value());
  // forward is -x; left is up x forward = y x -x = z
  expect_near(motion->f_P, {1, 3, kG + 2}, 1e-12);
  expect_near(motion->w_P, {4, 6, 5}, 1e-12);
}

TEST(SeatMotion, ATiltedSeatFeelsGravityAsTheWashoutTilts) {
  // nose down by theta about left, which is z here: the signs of washout.h
  const double theta = 0.3;
  const math::Quaternion q = math::turn_by({0, 0, theta});
  SeatState state;
  static_cast<void>(seat_motion(seat_at(), {.time = 0, .q_WB = q}, state));
  const auto motion = seat_motion(seat_at(), {.time = 0.1, .q_WB = q}, state);
  ASSERT_TRUE(motion.has_value());
  expect_near(motion->f_P, {-kG * std::sin(theta), 0, kG * std::cos(theta)}, 1e-12);
}

TEST(SeatMotion, ASteadyTurnIsFeltTowardsItsAxis) {
  // w about up, seat at distance r in front of the axis: chord of the velocity over dt, at its middle
  const double w = 0.7, r = 2.5, dt = 0.05;
  const Seat seat = seat_at({-r, 1, 0});
  SeatState state;
  for (int i = 0; i < 40; ++i) {
    const double angle = w * dt * i;
    const auto motion =
        seat_motion(seat, {.time = dt * i, .q_WB = math::turn_by({0, angle, 0}), .w_WB = {0, w, 0}}, state);
    if (i == 0) continue;
    ASSERT_TRUE(motion.has_value());
    const double half = w * dt / 2, size = w * w * r * std::sin(half) / half;
    // inward is backward; the middle of the interval lags by half the turn
    expect_near(motion->f_P, {-size * std::cos(half), size * std::sin(half), kG}, 1e-11);
    expect_near(motion->w_P, {0, 0, w}, 1e-12);
  }
}

TEST(SeatMotion, NoChangeOfVelocityIsLostBetweenSamples) {
  SeatState state;
  static_cast<void>(seat_motion(seat_at(), {.time = 0}, state));
  double before = 0, felt = 0;
  for (const double time : {0.001, 0.004, 0.1, 0.101, 0.35}) {
    const auto motion = seat_motion(seat_at(), {.time = time, .v_WB = {-std::sin(20 * time), 0, 0}}, state);
    ASSERT_TRUE(motion.has_value());
    felt += motion->f_P[0] * (time - before);
    before = time;
  }
  EXPECT_NEAR(felt, std::sin(20 * 0.35), 1e-12);
}

TEST(SeatMotion, ASampleOfNoLaterTimeBeginsAgain) {
  SeatState state;
  static_cast<void>(seat_motion(seat_at(), {.time = 5, .v_WB = {9, 0, 0}}, state));
  EXPECT_FALSE(seat_motion(seat_at(), {.time = 5, .v_WB = {9, 0, 0}}, state).has_value());
  EXPECT_FALSE(seat_motion(seat_at(), {.time = 0.1}, state).has_value());
  const auto motion = seat_motion(seat_at(), {.time = 0.2}, state);
  ASSERT_TRUE(motion.has_value());
  expect_near(motion->f_P, {0, 0, kG}, 1e-12);
}

TEST(SeatMotion, DoesNotAllocate) {
  const Seat seat = seat_at({1, 2, 3});
  SeatState state;
  const AllocationGuard guard;
  for (int i = 0; i < 100; ++i) static_cast<void>(seat_motion(seat, {.time = 0.001 * i}, state));
  EXPECT_EQ(guard.allocations(), 0u);
}

TEST(SeatMotion, DirectionsAreSquareAndNotZero) {
  const auto problem = [](const SeatDef& def) {
    Problems problems;
    validate("Seat", def, problems);
    return problems.empty() ? std::string("none") : problems[0].path + ": " + problems[0].what;
  };
  EXPECT_EQ(problem(seat_def()), "none");
  EXPECT_EQ(problem({.forward = {1, 0, 0}}), "Seat.forward: forward or up has no direction");
  EXPECT_EQ(problem({.up = {1, 0, 0}}), "Seat.forward: forward or up has no direction");
  EXPECT_EQ(problem({.forward = {1, 0, 0}, .up = {1, 1, 0}}), "Seat.up: the angle between forward and up is 45 deg");
  EXPECT_EQ(problem({.point = {0, NAN, 0}, .forward = {1, 0, 0}, .up = {0, 1, 0}}), "Seat.point: nan is out of range");
}

}  // namespace seat_motion_test
}  // namespace slew::devices
