// SPDX-License-Identifier: Apache-2.0
// Definition of gears: a linear row between the coordinates of two joints with one coordinate each.
//
//   gear             angle of joint 2        = ratio * angle of joint 1 + offset         gear pair, belt, chain
//   rack_and_pinion  displacement of joint 2 = radius * angle of joint 1 + offset        rack, screw (lead / 2 pi),
//   winch slides           displacement of joint 2 = ratio * displacement of joint 1 + offset  telescopes, guided
//   grippers
// The row's force F acts on both coordinates, F on that of joint 2 and -ratio F on that of joint 1, each between the
// two bodies of its own joint: no power is lost. Not covered: play, compliance and friction of teeth, and the load of
// teeth on the joints' bearings. Card: docs/models/multibody_gears.md.
#pragma once

#include <string>

#include "multibody/model/not_given.h"

namespace slew::multibody {

enum class GearKind : int { gear, rack_and_pinion, slides };

struct GearDef {
  std::string name{};
  GearKind kind = GearKind::gear;
  std::string joint1{};       // revolute; slides: prismatic
  std::string joint2{};       // gear: revolute; else prismatic
  double ratio = 1;           // 1; rack_and_pinion: radius of the pinion [m]. Negative: opposite direction
  double offset = kNotGiven;  // rad or m, coordinate of joint 2 where that of joint 1 is 0; none: from the poses
};

}  // namespace slew::multibody
