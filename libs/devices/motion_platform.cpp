// SPDX-License-Identifier: Apache-2.0
#include "devices/motion_platform.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/failure.h"
#include "devices/field_rules.h"

namespace slew::devices {
namespace {

constexpr Range kSeconds = {.min = 0, .max = 60, .max_is_open = false};

constexpr Field kMotionPlatformFields[] = {
    field<&MotionPlatformDef::position_limit>(
        "position_limit",
        {.dimension = Dimension::length, .range = kPositive, .doc = "largest surge, sway and heave about neutral"}),
    field<&MotionPlatformDef::angle_limit>(
        "angle_limit",
        {.dimension = Dimension::angle, .range = {.min = 0, .max = 1.5}, .doc = "largest roll, pitch and yaw"}),
    field<&MotionPlatformDef::soft_from>("soft_from",
                                         {.range = {.min = 0, .max = 1, .min_is_open = false},
                                          .doc = "share of a limit up to which the motion is not drawn back"}),
    field<&MotionPlatformDef::park_height>(
        "park_height",
        {.dimension = Dimension::length, .range = kNotNegative, .doc = "distance that the parked platform is lowered"}),
    field<&MotionPlatformDef::rise_time>(
        "rise_time", {.dimension = Dimension::time, .range = kSeconds, .doc = "from parked to neutral, and back"}),
    field<&MotionPlatformDef::ramp_time>(
        "ramp_time", {.dimension = Dimension::time, .range = kSeconds, .doc = "from neutral to full motion, and back"}),
    field<&MotionPlatformDef::freeze_after>(
        "freeze_after", {.dimension = Dimension::time,
                         .range = {.min = 0.001, .max = 10, .min_is_open = false, .max_is_open = false},
                         .doc = "silence after which the pose is held"}),
    field<&MotionPlatformDef::hold_time>("hold_time",
                                         {.dimension = Dimension::time,
                                          .range = {.min = 0, .max = 60, .min_is_open = false, .max_is_open = false},
                                          .doc = "time for which the pose is held before it returns to neutral"}),
};

// 0 to 1 over t in 0 .. 1 without a jump of the speed
double eased(double t) noexcept {
  const double x = std::clamp(t, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

PlatformPose scaled(const PlatformPose& pose, double gain) noexcept {
  PlatformPose result;
  for (std::size_t i = 0; i < 3; ++i) {
    result.position[i] = gain * pose.position[i];
    result.angles[i] = gain * pose.angles[i];
  }
  return result;
}

PlatformPose limited(const MotionPlatformDef& def, const PlatformPose& pose, std::uint64_t& saturated) noexcept {
  PlatformPose result;
  bool is_drawn = false;
  const auto limit = [&](double q, double most) {
    is_drawn = is_drawn || std::abs(q) > def.soft_from * most;
    return soft_limited(q, most, def.soft_from);
  };
  for (std::size_t i = 0; i < 3; ++i) {
    result.position[i] = limit(pose.position[i], def.position_limit[i]);
    result.angles[i] = limit(pose.angles[i], def.angle_limit[i]);
  }
  if (is_drawn) ++saturated;
  return result;
}

PlatformPose lowered(const MotionPlatformDef& def, double share) noexcept {
  PlatformPose pose;
  pose.position[2] = -def.park_height * share;
  return pose;
}

bool is_finite(const SeatMotion& motion) noexcept {
  const auto all = [](const Triple& triple) {
    return std::all_of(triple.begin(), triple.end(), [](double x) { return std::isfinite(x); });
  };
  return all(motion.f_P) && all(motion.w_P);
}

void enter(PlatformPhase phase, MotionPlatformState& state) noexcept {
  state.phase = phase;
  state.phase_time = 0;
}

// Changes of phase before a step.
void choose_phase(const MotionPlatform& platform, PlatformCommand command, MotionPlatformState& state) noexcept {
  const MotionPlatformDef& def = platform.def;
  // to the nearest step: sums of steps are rounded
  const bool is_silent = state.silence > def.freeze_after - platform.step / 2;
  const bool runs = command == PlatformCommand::run;
  switch (state.phase) {
    case PlatformPhase::parked:
      if (runs && !is_silent) enter(PlatformPhase::rising, state);
      break;
    case PlatformPhase::rising:
      if (!runs) {
        // back from where it is: the share of the way is the same in both directions
        state.phase = PlatformPhase::lowering;
        state.phase_time = std::max(0.0, def.rise_time - state.phase_time);
      } else if (state.phase_time >= def.rise_time && !is_silent) {
        enter(PlatformPhase::ramping_in, state);
      }
      break;
    case PlatformPhase::ramping_in:
    case PlatformPhase::active:
      if (is_silent) {
        ++state.freezes;
        state.held_pose = state.pose;
        enter(PlatformPhase::frozen, state);
      } else if (!runs) {
        state.held_pose = state.pose;
        enter(PlatformPhase::washing_back, state);
      } else if (state.phase == PlatformPhase::ramping_in && state.phase_time >= def.ramp_time) {
        enter(PlatformPhase::active, state);
      }
      break;
    case PlatformPhase::frozen:
      if (state.phase_time >= def.hold_time) enter(PlatformPhase::washing_back, state);
      break;
    case PlatformPhase::washing_back:
      if (state.phase_time < def.ramp_time) break;
      state.washout = {};
      if (!runs) {
        enter(PlatformPhase::lowering, state);
      } else if (!is_silent) {
        enter(PlatformPhase::ramping_in, state);
      }
      break;
    case PlatformPhase::lowering:
      if (runs && !is_silent) {
        state.phase = PlatformPhase::rising;
        state.phase_time = std::max(0.0, def.rise_time - state.phase_time);
      } else if (state.phase_time >= def.rise_time) {
        enter(PlatformPhase::parked, state);
      }
      break;
  }
}

}  // namespace

std::span<const Field> motion_platform_fields() noexcept {
  return kMotionPlatformFields;
}

std::string_view text_of(PlatformPhase phase) noexcept {
  switch (phase) {
    case PlatformPhase::parked:
      return "parked";
    case PlatformPhase::rising:
      return "rising";
    case PlatformPhase::ramping_in:
      return "ramping in";
    case PlatformPhase::active:
      return "active";
    case PlatformPhase::frozen:
      return "frozen";
    case PlatformPhase::washing_back:
      return "washing back";
    case PlatformPhase::lowering:
      return "lowering";
  }
  return "";
}

void validate(const MotionPlatformDef& def, Problems& problems) {
  const std::size_t before = problems.size();
  check_fields(def.name, &def, kMotionPlatformFields, problems);
  validate(def.name, def.washout, problems);
  validate(def.name, def.hexapod, problems);
  if (problems.size() != before) return;
  // the whole way to the parked pose, and that pose itself
  const LegLengths parked = leg_lengths(def.hexapod, lowered(def, 1));
  if (!is_within_stroke(def.hexapod, parked)) {
    problems.push_back(
        {def.name + ".park_height",
         fmt::format("a leg is {:.4g} m long when parked", *std::min_element(parked.begin(), parked.end())),
         fmt::format("{:g} m or more", def.hexapod.shortest_leg), ""});
  }
}

MotionPlatform build_platform(const MotionPlatformDef& def, double step) {
  Problems problems;
  validate(def, problems);
  if (!problems.empty()) throw Failure(ExitCode::bad_input, problems[0].path + ": " + problems[0].what);
  return {def, build_washout(def.washout, step), step};
}

MotionPlatformState initial_state(const MotionPlatform& platform) noexcept {
  MotionPlatformState state;
  state.silence = platform.def.freeze_after;
  state.pose = lowered(platform.def, 1);
  state.legs = leg_lengths(platform.def.hexapod, state.pose);
  return state;
}

double soft_limited(double q, double limit, double soft_from) noexcept {
  const double linear = soft_from * limit, rest = limit - linear, beyond = std::abs(q) - linear;
  if (beyond <= 0) return q;
  return std::copysign(std::min(linear + rest * std::tanh(beyond / rest), limit), q);
}

void step(const MotionPlatform& platform, PlatformCommand command, const std::optional<SeatMotion>& motion,
          MotionPlatformState& state) noexcept {
  const MotionPlatformDef& def = platform.def;
  const bool has_sample = motion.has_value() && is_finite(*motion);
  if (motion.has_value() && !has_sample) ++state.not_finite;
  if (has_sample) state.motion = *motion;
  state.silence = has_sample ? 0 : state.silence + platform.step;
  choose_phase(platform, command, state);
  state.phase_time += platform.step;

  PlatformPose wanted;
  switch (state.phase) {
    case PlatformPhase::parked:
      wanted = lowered(def, 1);
      break;
    case PlatformPhase::rising:
      wanted = lowered(def, 1 - eased(state.phase_time / def.rise_time));
      break;
    case PlatformPhase::lowering:
      wanted = lowered(def, eased(state.phase_time / def.rise_time));
      break;
    case PlatformPhase::frozen:
      wanted = state.held_pose;
      break;
    case PlatformPhase::washing_back:
      wanted = scaled(state.held_pose, 1 - eased(state.phase_time / def.ramp_time));
      break;
    case PlatformPhase::ramping_in:
    case PlatformPhase::active: {
      const PlatformPose washed = step(platform.washout, state.motion.f_P, state.motion.w_P, state.washout);
      const double gain = state.phase == PlatformPhase::active ? 1 : eased(state.phase_time / def.ramp_time);
      wanted = limited(def, scaled(washed, gain), state.saturated);
      break;
    }
  }
  const ReachablePose reached = reachable(def.hexapod, {}, wanted);
  if (reached.was_drawn_back) ++state.drawn_back;
  state.pose = reached.pose;
  state.legs = reached.legs;
}

}  // namespace slew::devices
