// SPDX-License-Identifier: Apache-2.0
// Start poses for given joint coordinates, with closed loops.
//
// The given poses of the bodies are the beginning: at first the joints must fit within kRoughTolerance. The joints
// named here then go to their coordinates in small steps, and so do slides that are geared to them; the tree beyond
// them moves along, its other joints as they are. At each step, Newton's method (assembly.h) closes all loops and gears
// while the named coordinates are held as prescribed motions are, so that a loop stays on the branch on which the poses
// begin. The bodies that follow are those that the joints' rows move in the metric of the masses. A gear without offset
// keeps the offset that fits the given poses, whichever joint is named; coordinates of all its joints that disagree
// with it are a problem. A gear of ratio 0 holds its joint where it is put. An angle beyond half a turn gives the joint
// its whole turns (JointAxisDef::start_turns), and those joints that gears turn with it.
//
// Not covered: flexible and segmented bodies, joints without coordinates (spherical, fixed).
#pragma once

#include <span>
#include <string>

#include "core/problem.h"
#include "multibody/model/defs.h"

namespace slew::multibody {

struct StartCoordinate {
  std::string joint;
  int number = 0;    // coordinate of the joint, as in joint_axes.h
  double value = 0;  // rad or m
};

// Changes position and orientation of the bodies in `mechanics`, and the whole turns of its joints; a body whose pose
// relative to its `relative_to` stays keeps its numbers. Appends to problems where the poses are no beginning, or where
// loops cannot close; paths begin with "start.". Pre-condition: all names exist, every number is one of its joint.
// Builds models: takes milliseconds.
void put_joints(MechanicsDef& mechanics, std::span<const StartCoordinate> coordinates, Problems& problems);

}  // namespace slew::multibody
