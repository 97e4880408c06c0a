// Prescribed motion as parts of build_model(). Internal to the library.
#pragma once

#include <array>
#include <vector>

#include "multibody/model/model.h"

namespace slew::multibody {

// Which coordinate of a joint a motion drives: its number, as variables name them; -1: the joint has no such one.
[[nodiscard]] int driven_coordinate(const MotionDef& motion, JointType joint) noexcept;

// One for each motion of the scene, without its law and its place in the model.
[[nodiscard]] std::vector<Drive> declared_drives(const MechanicsDef& mechanics);

// Makes the laws of a joint, which stands at these coordinates in the scene's poses. False: the joint has none.
bool begin_drives(const MechanicsDef& mechanics, int joint, const std::array<double, 2>& start, Model& model);

// A joint that is cut gets a row for each of its laws.
void add_drive_rows(const Model& model, int joint, Constraint& constraint);

}  // namespace slew::multibody
