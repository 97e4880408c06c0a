// SPDX-License-Identifier: Apache-2.0
#include "devices/hexapod.h"

#include <fmt/format.h>

#include <cmath>

#include "core/check.h"
#include "devices/field_rules.h"
#include "math/rotation.h"

namespace slew::devices {
namespace {

constexpr int kHalvings = 24;  // of the way from home: 6e-8 of it

constexpr Field kHexapodFields[] = {
    field<&HexapodDef::base_joints>("base_joints", {.dimension = Dimension::length,
                                                    .presence = Presence::required,
                                                    .doc = "six joints on the base: forward, left, up"}),
    field<&HexapodDef::platform_joints>(
        "platform_joints", {.dimension = Dimension::length,
                            .presence = Presence::required,
                            .doc = "six joints on the platform about its origin, in the order of the legs"}),
    field<&HexapodDef::neutral_height>("neutral_height", {.dimension = Dimension::length,
                                                          .range = kPositive,
                                                          .presence = Presence::required,
                                                          .doc = "height of the platform's origin in neutral"}),
    field<&HexapodDef::shortest_leg>("shortest_leg", {.dimension = Dimension::length,
                                                      .range = kPositive,
                                                      .presence = Presence::required,
                                                      .doc = "length of a leg that is driven in"}),
    field<&HexapodDef::longest_leg>("longest_leg", {.dimension = Dimension::length,
                                                    .range = kPositive,
                                                    .presence = Presence::required,
                                                    .doc = "length of a leg that is driven out"}),
};

PlatformPose between(const PlatformPose& from, const PlatformPose& to, double share) noexcept {
  PlatformPose pose;
  for (std::size_t i = 0; i < 3; ++i) {
    pose.position[i] = from.position[i] + share * (to.position[i] - from.position[i]);
    pose.angles[i] = from.angles[i] + share * (to.angles[i] - from.angles[i]);
  }
  return pose;
}

}  // namespace

std::span<const Field> hexapod_fields() noexcept {
  return kHexapodFields;
}

void validate(std::string_view path, const HexapodDef& def, Problems& problems) {
  const std::size_t before = problems.size();
  check_fields(path, &def, kHexapodFields, problems);
  const auto refuse = [&](const char* key, std::string what, std::string expected) {
    problems.push_back({fmt::format("{}.{}", path, key), std::move(what), std::move(expected), ""});
  };
  if (def.base_joints.size() != kLegs) refuse("base_joints", fmt::format("{} joints", def.base_joints.size()), "six");
  if (def.platform_joints.size() != kLegs) {
    refuse("platform_joints", fmt::format("{} joints", def.platform_joints.size()), "six");
  }
  if (!(def.shortest_leg < def.longest_leg)) {
    refuse("longest_leg", fmt::format("{:g} m is not above shortest_leg, {:g} m", def.longest_leg, def.shortest_leg),
           "");
  }
  if (problems.size() != before) return;
  const LegLengths neutral = leg_lengths(def, {});
  for (std::size_t i = 0; i < kLegs; ++i) {
    if (neutral[i] > def.shortest_leg && neutral[i] < def.longest_leg) continue;
    refuse("neutral_height", fmt::format("leg {} is {:.4g} m long in neutral", i + 1, neutral[i]),
           fmt::format("between {:g} and {:g} m", def.shortest_leg, def.longest_leg));
  }
}

LegLengths leg_lengths(const HexapodDef& def, const PlatformPose& pose) noexcept {
  SLEW_ASSERT(def.base_joints.size() == kLegs && def.platform_joints.size() == kLegs);
  const math::Mat3 R =
      math::rotation_z(pose.angles[2]) * math::rotation_y(pose.angles[1]) * math::rotation_x(pose.angles[0]);
  const math::Vec3 origin = math::Vec3(0, 0, def.neutral_height) + math::Vec3(pose.position);
  LegLengths legs{};
  for (std::size_t i = 0; i < kLegs; ++i) {
    legs[i] = math::norm(origin + R * math::Vec3(def.platform_joints[i]) - math::Vec3(def.base_joints[i]));
  }
  return legs;
}

bool is_within_stroke(const HexapodDef& def, const LegLengths& legs) noexcept {
  for (const double leg : legs) {
    if (!(leg >= def.shortest_leg && leg <= def.longest_leg)) return false;
  }
  return true;
}

ReachablePose reachable(const HexapodDef& def, const PlatformPose& home, const PlatformPose& pose) noexcept {
  ReachablePose result{pose, leg_lengths(def, pose), false};
  if (is_within_stroke(def, result.legs)) return result;
  result = {home, leg_lengths(def, home), true};
  double inside = 0, outside = 1;
  for (int i = 0; i < kHalvings; ++i) {
    const double share = (inside + outside) / 2;
    const PlatformPose tried = between(home, pose, share);
    const LegLengths legs = leg_lengths(def, tried);
    if (is_within_stroke(def, legs)) {
      inside = share;
      result.pose = tried, result.legs = legs;
    } else {
      outside = share;
    }
  }
  return result;
}

}  // namespace slew::devices
