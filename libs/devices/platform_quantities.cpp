// SPDX-License-Identifier: Apache-2.0
#include "devices/platform_quantities.h"

#include <algorithm>

namespace slew::devices {
namespace {

using State = MotionPlatformState;

template <std::size_t I>
double leg(const State& state) noexcept {
  return state.legs[I];
}
template <std::size_t I>
double position(const State& state) noexcept {
  return state.pose.position[I];
}
template <std::size_t I>
double angle(const State& state) noexcept {
  return state.pose.angles[I];
}
template <std::size_t I>
double force(const State& state) noexcept {
  return state.motion.f_P[I];
}
template <std::size_t I>
double rate(const State& state) noexcept {
  return state.motion.w_P[I];
}
template <std::uint64_t State::*Count>
double count(const State& state) noexcept {
  return static_cast<double>(state.*Count);
}

constexpr PlatformQuantity kPlatformQuantities[] = {
    {"leg_1", "m", "length of leg 1, of the platform's list of joints", leg<0>},
    {"leg_2", "m", "", leg<1>},
    {"leg_3", "m", "", leg<2>},
    {"leg_4", "m", "", leg<3>},
    {"leg_5", "m", "", leg<4>},
    {"leg_6", "m", "", leg<5>},
    {"surge", "m", "forward, from neutral", position<0>},
    {"sway", "m", "left, from neutral", position<1>},
    {"heave", "m", "up, from neutral", position<2>},
    {"roll", "rad", "about forward", angle<0>},
    {"pitch", "rad", "about left: nose down is positive", angle<1>},
    {"yaw", "rad", "about up", angle<2>},
    {"phase", "1", "0 parked, 1 rising, 2 ramping in, 3 active, 4 frozen, 5 washing back, 6 lowering",
     [](const State& state) noexcept { return static_cast<double>(state.phase); }},
    {"specific_force.x", "m/s2", "of the seat, forward; the last sample", force<0>},
    {"specific_force.y", "m/s2", "left", force<1>},
    {"specific_force.z", "m/s2", "up; 9.8 at rest", force<2>},
    {"angular_velocity.x", "rad/s", "of the seat, about forward; the last sample", rate<0>},
    {"angular_velocity.y", "rad/s", "about left", rate<1>},
    {"angular_velocity.z", "rad/s", "about up", rate<2>},
    {"time", "s", "of that sample in the session", [](const State& state) noexcept { return state.motion.time; }},
    {"silence", "s", "since the last sample", [](const State& state) noexcept { return state.silence; }},
    {"saturated", "1", "steps in which a coordinate was drawn back softly", count<&State::saturated>},
    {"drawn_back", "1", "steps in which a leg was at an end of its stroke", count<&State::drawn_back>},
    {"not_finite", "1", "samples that were not finite", count<&State::not_finite>},
    {"freezes", "1", "times that samples failed to come", count<&State::freezes>},
};

}  // namespace

std::span<const PlatformQuantity> platform_quantities() noexcept {
  return kPlatformQuantities;
}

const PlatformQuantity* find_platform_quantity(std::string_view name) noexcept {
  const auto* const found = std::find_if(std::begin(kPlatformQuantities), std::end(kPlatformQuantities),
                                         [&](const PlatformQuantity& quantity) { return quantity.name == name; });
  return found == std::end(kPlatformQuantities) ? nullptr : found;
}

}  // namespace slew::devices
