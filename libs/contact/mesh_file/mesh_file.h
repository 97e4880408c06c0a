// SPDX-License-Identifier: Apache-2.0
// Meshes from files: .stl, .obj, .dae, .3ds, .glb and .fbx through assimp.
//
// These formats state units and axes incompletely, so the caller gives both. All objects of a file become one mesh;
// vertices at exactly the same place become one, so that a closed surface is closed by its indices too.
// A library of its own: only what reads files links assimp. Not real-time safe.
#pragma once

#include <filesystem>
#include <string>

#include "contact/contact_def.h"
#include "core/problem.h"

namespace slew::contact {

enum class UpAxis : int { y, z };

struct MeshFileDef {
  std::filesystem::path path;
  double unit = 1;                // m per unit of the file, > 0: 0.001 for millimetres
  UpAxis up_in_file = UpAxis::z;  // this axis of the file ...
  UpAxis up = UpAxis::z;          // ... becomes this axis of the mesh, by a quarter turn about x
};

// Appends one problem, at `owner`.mesh, and returns an empty mesh if the file cannot be read, has another ending, or
// holds no triangles. mesh_check.h checks the enclosed volume.
[[nodiscard]] MeshDef read_mesh(const std::string& owner, const MeshFileDef& def, Problems& problems);

}  // namespace slew::contact
