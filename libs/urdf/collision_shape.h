// SPDX-License-Identifier: Apache-2.0
// The collision geometry of a link as a shape of the scene.
//
// Boxes, spheres, cylinders and capsules are taken over as they are. A mesh becomes a convex mesh when it is closed and
// has no dents, on Ground also a triangle mesh; the scene names its file, in the file's own axes and with URDF's scale
// as its unit. Other meshes give no shape but a refusal with the reason.
#pragma once

#include <filesystem>
#include <string>

#include "contact/contact_def.h"
#include "multibody/model/defs.h"
#include "urdf/placement.h"
#include "urdf/robot.h"

namespace slew::urdf {

// Folders of files: package://NAME/path is searched as `path` in the robot's folder and in those above it.
struct Folders {
  std::filesystem::path robot;  // folder of the URDF file
  std::filesystem::path scene;  // folder of the new scene; its meshes must be inside
};

struct CollisionShape {
  multibody::ShapeDef def{};  // without name and body; for a mesh with the file's name relative to the scene
  contact::MeshDef mesh{};    // the triangles of that file [m]
  std::string refusal{};      // reason for no shape; empty: there is one
};

// in_body: pose of the link's frame in its body. is_static: the body is Ground.
[[nodiscard]] CollisionShape collision_shape(const Geometry& geometry, const Pose& in_body, bool is_static,
                                             const Folders& folders);

}  // namespace slew::urdf
