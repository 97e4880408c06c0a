// SPDX-License-Identifier: Apache-2.0
#include "multibody/constraints/gear_fields.h"

namespace slew::multibody {
namespace {

using enum Dimension;

constexpr Field kJoint1 = field<&GearDef::joint1>(
    "joint1", {.presence = Presence::required, .reference = "joint", .doc = "joint whose coordinate is multiplied"});
constexpr Field kJoint2 = field<&GearDef::joint2>(
    "joint2", {.presence = Presence::required, .reference = "joint", .doc = "joint whose coordinate follows"});
constexpr Field kRatio = field<&GearDef::ratio>(
    "ratio", {.presence = Presence::required,
              .doc = "coordinate of joint 2 over that of joint 1; negative: opposite direction"});
constexpr Field kRadius = field<&GearDef::ratio>(
    "radius",
    {.dimension = length,
     .presence = Presence::required,
     .doc = "displacement of joint 2 per radian of joint 1: radius of the pinion, lead of a screw over 2 pi"});

constexpr Field offset_row(Dimension position) {
  return field<&GearDef::offset>(
      "offset", {.dimension = position,
                 .doc = "coordinate of joint 2 where that of joint 1 is 0; none: fits the start position"});
}

constexpr Field kGear[] = {kJoint1, kJoint2, kRatio, offset_row(angle)};
constexpr Field kRackAndPinion[] = {kJoint1, kJoint2, kRadius, offset_row(length)};
constexpr Field kSlides[] = {kJoint1, kJoint2, kRatio, offset_row(length)};

template <GearKind Kind>
void* append(MechanicsDef& mechanics, std::string_view element) {
  GearDef& def = mechanics.gears.emplace_back();
  def.name = element;
  def.kind = Kind;
  return &def;
}

constexpr ElementType kTypes[] = {
    {"gear", "gear", "angle of a joint as a multiple of another's: gears, belts, chains", kGear,
     append<GearKind::gear>},
    {"rack_and_pinion", "gear", "displacement of a joint from the angle of another: racks, screws, winches",
     kRackAndPinion, append<GearKind::rack_and_pinion>},
    {"slides", "gear", "displacement of a joint as a multiple of another's: telescopes, grippers", kSlides,
     append<GearKind::slides>},
};

}  // namespace

std::span<const ElementType> gear_types() noexcept {
  return kTypes;
}

}  // namespace slew::multibody
