// A scene from a URDF file: a starting point, to which loops, cylinders and a circuit are added.
//
// Taken over: links with their inertia and collision shapes, joints (revolute, continuous, prismatic, fixed, floating,
// planar) with axes, limits, damping, friction and <mimic>, which becomes a gear. Told in comments of the scene: visual
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
  std::vector<Note> changes;  // repairs that were asked for
  std::size_t bodies = 0, joints = 0, shapes = 0;
};

// scene_file: where the scene will stand, whose folder it names the robot's meshes in; empty: beside the robot.
// Throws scene::LoadError with all problems, each with its line: of the file, and of a scene that would be refused.
[[nodiscard]] Import import_file(const std::string& path, RootMount mount = RootMount::fixed,
                                 const std::string& scene_file = "", const Repairs& repairs = {});

}  // namespace slew::urdf
