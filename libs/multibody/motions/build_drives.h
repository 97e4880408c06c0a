// SPDX-License-Identifier: Apache-2.0
// Prescribed motion as parts of build_model(). Internal to the library.
#pragma once

#include <array>
#include <vector>

#include "multibody/model/model.h"

namespace slew::multibody {

// Number of the joint coordinate that a motion drives, as in variables; -1: the joint has none.
[[nodiscard]] int driven_coordinate(const MotionDef& motion, JointType joint) noexcept;

// One for each motion of the scene, without its law and its place in the model.
[[nodiscard]] std::vector<Drive> declared_drives(const MechanicsDef& mechanics);

// Builds the laws of a joint with these coordinates in the scene's poses. False: the joint has none.
bool begin_drives(const MechanicsDef& mechanics, int joint, const std::array<double, 2>& start, Model& model);

// A joint that is cut gets a row for each of its laws.
void add_drive_rows(const Model& model, int joint, Constraint& constraint);

}  // namespace slew::multibody
