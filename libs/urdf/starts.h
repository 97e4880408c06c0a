// Where the joints of a robot start.
#pragma once

#include "urdf/robot.h"

namespace slew::urdf {

// Fills start and turns of every joint, and takes the turns off its limits. A joint starts at 0 where its limits and
// those of the joints that follow it (<mimic>) allow that, else in the middle of what they allow, a quarter of it off
// where that is half a turn: half a turn is one way round as much as the other. A joint follows to where its leader
// starts; with a multiplier of 0 it is fixed. Of chains of followers each then names the joint that moves by itself.
// Limits that no position of the leader meets are not taken over, with a note.
void find_starts(Robot& robot);

}  // namespace slew::urdf
