// SPDX-License-Identifier: Apache-2.0
// Start positions of a robot's joints.
#pragma once

#include "urdf/robot.h"

namespace slew::urdf {

// Fills start and turns of every joint, and takes the turns off its limits. A joint starts at 0 where its limits and
// those of the joints that follow it (<mimic>) allow that, else in the middle of the allowed range, a quarter of it off
// if that is half a turn, since half a turn has no unique sign. A follower starts at its leader's start; with a
// multiplier of 0 it is fixed. In chains, every follower then names the independent joint. Limits that no position of
// the leader meets are not taken over, with a note.
void find_starts(Robot& robot);

}  // namespace slew::urdf
