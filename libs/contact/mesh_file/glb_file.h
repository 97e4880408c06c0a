// SPDX-License-Identifier: Apache-2.0
// Mesh files for the eye, as binary glTF 2.0 (.glb; Khronos, glTF 2.0 specification, section 4.4).
//
// The result has one node and one mesh with a primitive for each material: positions, normals and triangles in metres,
// in the axes of MeshFileDef::up (glTF itself takes y for up; the reader of the result places it). Where a file states
// no normals (.stl states those of the triangles alone) edges of more than 35 deg stay sharp. A material keeps its
// colour; textures, lights, cameras and animations are left out. Surfaces may be open.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "contact/mesh_file/mesh_file.h"
#include "core/input_file.h"
#include "core/problem.h"

namespace slew::contact {

inline constexpr std::size_t kMaxGlbBytes = 256u << 20;  // of one mesh

using Rgb = std::array<double, 3>;  // red, green, blue, 0 .. 1, sRGB

// Check of a mesh file that is not opened: its ending, its kind, its size. No value: it may be read.
[[nodiscard]] std::optional<InputFault> find_mesh_fault(const std::filesystem::path& path);

// color: of all triangles; none: the file's own colours, grey where it has none. Appends one problem, at `owner`.file,
// and returns an empty text if the file cannot be read, has another ending, holds no triangles or a point that is not
// finite, or is larger than kMaxGlbBytes. Allocates; not real-time safe.
[[nodiscard]] std::string read_as_glb(const std::string& owner, const MeshFileDef& def, const std::optional<Rgb>& color,
                                      Problems& problems);

}  // namespace slew::contact
