// SPDX-License-Identifier: Apache-2.0
// A mesh file as assimp's scene, with the axes and the unit that the file states: for the readers of this folder.
#pragma once

#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <string>

#include "contact/mesh_file/mesh_file.h"

namespace slew::contact {

struct ImportedMesh {
  const aiScene* scene = nullptr;  // owned by the importer; null: `what` and `expected` state the fault
  aiMatrix4x4 undoing;             // in front of the root: undoes assimp's conversion of axes and unit
  std::string what, expected;
};

// steps: aiPostProcessSteps beside the triangulation. Opens this file alone, none that it refers to.
[[nodiscard]] ImportedMesh import_mesh(const MeshFileDef& def, unsigned steps, Assimp::Importer& importer);

// A point of the file in metres, with its upward axis along MeshFileDef::up.
[[nodiscard]] Triple turned(const Triple& p, const MeshFileDef& def);

}  // namespace slew::contact
