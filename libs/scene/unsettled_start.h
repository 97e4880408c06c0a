// SPDX-License-Identifier: Apache-2.0
// Starts that are no rest: machines that fall while hydraulics.start: equilibrium holds their actuators, and shapes
// that start deep in each other.
//
// The static forces of the actuators keep every line's length at rest. If what carries an actuator is not held itself
// (a chassis on springs without load), it accelerates, the forces are those of the falling machine, and they are wrong
// as soon as the springs carry. With the actuators' forces and dry friction as it holds, the acceleration of every body
// that carries both ends of an actuator is computed at rest; above kNoticed it is a warning.
//
// No warning: bodies beyond the actuators (a load that swings), machines without actuators, and machines that stand on
// contact, which take up their load within milliseconds.
#pragma once

#include <string>

#include "core/problem.h"
#include "scene/scene.h"

namespace slew::scene {

// Warnings for flexible bodies of a mechanism with loops that start undeformed, or bent beyond their theory. Builds the
// mechanism. Pre-condition: a validated scene whose files are there.
void find_start_shapes(const Scene& scene, Problems& warnings);

// Builds the mechanism. Pre-condition: a validated scene whose files are there.
void find_unsettled_start(const Scene& scene, Problems& warnings);

// "Ground_Bag: the shapes start 0.02 m deep in each other, ...", one after the other; empty: none. Builds the
// mechanism. Pre-condition: a validated scene.
[[nodiscard]] std::string deep_starts(const Scene& scene);

}  // namespace slew::scene
