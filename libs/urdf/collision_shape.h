// The collision geometry of a link as a shape of the scene.
//
// Boxes, spheres, cylinders and capsules are taken over as they are. A mesh becomes a convex mesh when it is closed and
// has no dents, on Ground also a triangle mesh; the scene names its file, in the file's own axes and with URDF's scale
// as its unit. Whatever else a mesh is, the scene cannot hold it: the reason is told instead.
#pragma once

#include <filesystem>
#include <string>

#include "contact/contact_def.h"
#include "multibody/model/defs.h"
#include "urdf/placement.h"
#include "urdf/robot.h"

namespace slew::urdf {

// Where files are: package://NAME/path is looked for as `path` in the robot's folder and in those above it.
struct Folders {
  std::filesystem::path robot;  // of the URDF file
  std::filesystem::path scene;  // that the scene will stand in; its meshes must be inside
};

struct CollisionShape {
  multibody::ShapeDef def{};  // without name and body; of a mesh with the file's name relative to the scene
  contact::MeshDef mesh{};    // the triangles of that file [m]
  std::string refusal{};      // why there is no shape; empty: there is
};

// in_body: of the link's frame in its body. is_static: the body is Ground.
[[nodiscard]] CollisionShape collision_shape(const Geometry& geometry, const Pose& in_body, bool is_static,
                                             const Folders& folders);

}  // namespace slew::urdf
