// SPDX-License-Identifier: Apache-2.0
// Meshes for the eye: the section `graphics`.
//
//   Cab_View: {body: Truck, file: meshes/cab.stl, unit: 1 mm, up: z, color: [0.8, 0.1, 0.1]}
//
// No physics reads them, and no state's hash depends on them. The scene's expanded text holds the file's name alone, so
// that a large mesh burdens no node: a program that draws needs the file. A session's recording gets a copy beside it.
// Not covered: textures, lights, and a mesh that bends with a flexible body.
#pragma once

#include <limits>
#include <span>
#include <string>

#include "contact/mesh_file/mesh_file.h"
#include "core/field.h"
#include "core/problem.h"

namespace slew::scene {

struct LoadContext;
struct Scene;

struct GraphicDef {
  std::string name;
  std::string body;                         // body that carries the mesh, or Ground
  std::string file;                         // in the scene's folder, of the endings of mesh_file.h
  double unit = 1;                          // m per unit of the file, > 0
  contact::UpAxis up = contact::UpAxis::y;  // this axis of the file becomes y of the mesh
  Triple position{};                        // m, the mesh's origin in the body's frame
  Triple orientation{};                     // rad, the mesh's axes in the body: successive rotations z, x', z''
  // red, green, blue, 0 .. 1; infinite: the colours of the file
  Triple color = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
                  std::numeric_limits<double>::infinity()};
};

[[nodiscard]] std::span<const Field> graphic_fields() noexcept;

// The mesh as a binary glTF file, metres, in its own axes (contact/mesh_file/glb_file.h). path: of the file. Appends a
// problem at `name`.file and returns an empty text if it cannot be read.
[[nodiscard]] std::string graphic_as_glb(const GraphicDef& graphic, const std::string& path, Problems& problems);

// Checks that the file of each graphic of a scene with a folder is there, without reading it; appends the faults.
void check_graphics(const LoadContext& load_context, const Scene& scene, Problems& problems);

}  // namespace slew::scene
