// Meshes from files: .stl, .obj, .dae, .3ds, .glb and .fbx through assimp.
//
// These formats say little or nothing about units and axes, so both are asked for. All objects of a file become one
// mesh; vertices at exactly the same place become one, so that a closed surface is closed by its indices too.
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
  UpAxis up_in_file = UpAxis::z;  // that axis of the file ...
  UpAxis up = UpAxis::z;          // ... becomes this axis of the mesh, by a quarter turn about x
};

// Appends one problem, at `owner`.mesh, and returns an empty mesh when the file cannot be read, has another ending than
// these, or holds no triangles. What the mesh encloses is not judged here: mesh_check.h.
[[nodiscard]] MeshDef read_mesh(const std::string& owner, const MeshFileDef& def, Problems& problems);

}  // namespace slew::contact
