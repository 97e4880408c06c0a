// SPDX-License-Identifier: Apache-2.0
// A scene from a URDF file: a starting point for adding loops, cylinders and a circuit.
//
// Taken over: links with their inertia and collision shapes, joints (revolute, continuous, prismatic, fixed, floating,
// planar) with axes, limits, damping, friction and <mimic>, which becomes a gear. Comments of the scene list visual
// shapes, frames of links without mass, and everything that is not taken over, with its line. Gravity is 9.81 m/s2
// along -z, as URDF's world has z up. Source: the XML specification at wiki.ros.org/urdf/XML. Not covered:
// transmissions, sensors, bounds of effort and velocity, xacro.
#pragma once

#include <string>
#include <vector>

#include "urdf/mass_properties.h"
#include "urdf/placement.h"
#include "urdf/robot.h"

namespace slew::urdf {

struct Import {
  std::string text;  // the scene's file
  std::vector<Note> notes;
  std::vector<Note> changes;  // requested repairs
  std::size_t bodies = 0, joints = 0, shapes = 0;
};

// scene_file: place of the new scene; mesh names are relative to its folder; empty: beside the robot. Throws
// scene::LoadError with all problems and their lines: those of the file, and those for which the scene would be
// refused.
[[nodiscard]] Import import_file(const std::string& path, RootMount mount = RootMount::fixed,
                                 const std::string& scene_file = "", const Repairs& repairs = {});

}  // namespace slew::urdf
