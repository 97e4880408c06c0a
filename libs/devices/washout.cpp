// SPDX-License-Identifier: Apache-2.0
#include "devices/washout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "devices/field_rules.h"

namespace slew::devices {
namespace {

constexpr Range kScale = {.min = 0, .max = 10, .min_is_open = false, .max_is_open = false};
constexpr Range kFrequency = {.min = 0, .max = 100, .max_is_open = false};  // rad/s
constexpr Range kDamping = {.min = 0, .max = 10, .max_is_open = false};

constexpr Field kWashoutFields[] = {
    field<&WashoutDef::force_scale>(
        "force_scale", {.range = kScale, .doc = "share of the specific force that is shown: forward, left, up"}),
    field<&WashoutDef::rate_scale>("rate_scale",
                                   {.range = kScale, .doc = "share of the angular velocity: roll, pitch, yaw"}),
    field<&WashoutDef::max_acceleration>(
        "max_acceleration",
        {.dimension = Dimension::acceleration, .range = kPositive, .doc = "bound of the scaled acceleration"}),
    field<&WashoutDef::max_rate>(
        "max_rate", {.dimension = Dimension::angular_velocity, .range = kPositive, .doc = "bound of the scaled rate"}),
    field<&WashoutDef::translation_frequency>("translation_frequency",
                                              {.dimension = Dimension::angular_velocity,
                                               .range = kFrequency,
                                               .doc = "w_n of the translation's high pass; lower moves farther"}),
    field<&WashoutDef::translation_damping>("translation_damping",
                                            {.range = kDamping, .doc = "zeta of the translation's high pass"}),
    field<&WashoutDef::return_frequency>(
        "return_frequency",
        {.dimension = Dimension::angular_velocity,
         .range = {.min = 0, .max = 100, .min_is_open = false, .max_is_open = false},
         .doc = "w_b: return to neutral under sustained acceleration; 0: second order, keeps an offset"}),
    field<&WashoutDef::tilt_frequency>(
        "tilt_frequency",
        {.dimension = Dimension::angular_velocity, .range = kFrequency, .doc = "w_t of the low pass into tilt"}),
    field<&WashoutDef::tilt_damping>("tilt_damping", {.range = kDamping, .doc = "zeta of the low pass into tilt"}),
    field<&WashoutDef::tilt_rate>("tilt_rate", {.dimension = Dimension::angular_velocity,
                                                .range = {.min = 0, .max = 1, .max_is_open = false},
                                                .doc = "largest rate of the tilt; about 3 deg/s is not perceived"}),
    field<&WashoutDef::max_tilt>("max_tilt", {.dimension = Dimension::angle,
                                              .range = {.min = 0, .max = 1, .min_is_open = false, .max_is_open = false},
                                              .doc = "largest tilt angle"}),
    field<&WashoutDef::rotation_frequency>(
        "rotation_frequency",
        {.dimension = Dimension::angular_velocity, .range = kFrequency, .doc = "w_n of the rates' high pass"}),
    field<&WashoutDef::rotation_damping>("rotation_damping",
                                         {.range = kDamping, .doc = "zeta of the rates' high pass"}),
};

// (s^2 + 2 zeta w s + w^2)(s + b); b = 0: the first factor alone
LinearFilter high_pass(double w, double zeta, double b, double step) {
  const double c1 = 2 * zeta * w, c0 = w * w;
  if (b == 0) return build_filter(2, {c0, c1, 0}, step);
  return build_filter(3, {c0 * b, c0 + c1 * b, c1 + b}, step);
}

double held_within(double value, double most) noexcept {
  return std::clamp(value, -most, most);
}

// Follows the wanted angle at no more than the rate.
double followed(double angle, double wanted, double most) noexcept {
  return angle + held_within(wanted - angle, most);
}

}  // namespace

std::span<const Field> washout_fields() noexcept {
  return kWashoutFields;
}

void validate(std::string_view path, const WashoutDef& def, Problems& problems) {
  check_fields(path, &def, kWashoutFields, problems);
}

Washout build_washout(const WashoutDef& def, double step) {
  SLEW_CHECK(step > 0);
  Washout washout;
  washout.def = def;
  washout.step = step;
  for (std::size_t i = 0; i < 3; ++i) {
    washout.translation[i] =
        high_pass(def.translation_frequency[i], def.translation_damping[i], def.return_frequency[i], step);
    washout.rotation[i] = high_pass(def.rotation_frequency[i], def.rotation_damping[i], 0, step);
  }
  const double w = def.tilt_frequency;
  washout.tilt = build_filter(2, {w * w, 2 * def.tilt_damping * w, 0}, step);
  return washout;
}

PlatformPose step(const Washout& washout, const Triple& f_P, const Triple& w_P, WashoutState& state) noexcept {
  const WashoutDef& def = washout.def;
  const Triple relative = {f_P[0], f_P[1], f_P[2] - kStandardGravity};
  PlatformPose pose;
  Triple u{};
  for (std::size_t i = 0; i < 3; ++i) {
    // translation: the third order's position is y', the second order's y
    u[i] = held_within(def.force_scale[i] * relative[i], def.max_acceleration[i]);
    advance(washout.translation[i], u[i], state.translation[i]);
    pose.position[i] = state.translation[i].z[washout.translation[i].order - 2];
    // rotation: the angle is y'
    advance(washout.rotation[i], held_within(def.rate_scale[i] * w_P[i], def.max_rate[i]), state.rotation[i]);
    pose.angles[i] = state.rotation[i].z[1];
  }
  // tilt: nose up (theta negative) for a forward acceleration
  for (std::size_t i = 0; i < 2; ++i) advance(washout.tilt, u[i], state.tilt[i]);
  const double w2 = def.tilt_frequency * def.tilt_frequency, most = std::sin(def.max_tilt);
  const double theta = -std::asin(held_within(w2 * state.tilt[0].z[0] / kStandardGravity, most));
  const double phi = std::asin(held_within(w2 * state.tilt[1].z[0] / (kStandardGravity * std::cos(theta)), most));
  state.tilt_angle[0] = followed(state.tilt_angle[0], phi, def.tilt_rate * washout.step);
  state.tilt_angle[1] = followed(state.tilt_angle[1], theta, def.tilt_rate * washout.step);
  pose.angles[0] += state.tilt_angle[0];
  pose.angles[1] += state.tilt_angle[1];
  return pose;
}

}  // namespace slew::devices
