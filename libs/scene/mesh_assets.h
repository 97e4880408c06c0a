// SPDX-License-Identifier: Apache-2.0
// Mesh files of shapes, read once when the scene is loaded.
//
// The triangles become part of the scene (`vertices`, `triangles`), and so of its expanded text: nodes on other
// machines and replays need no file.
#pragma once

#include "contact/contact_def.h"
#include "core/problem.h"
#include "multibody/model/defs.h"
#include "scene/expand.h"

namespace slew::scene {

// Reads the file of every shape that names one, in metres and with its upward axis along y. The shape then has vertices
// and triangles instead of the file. Appends a problem for every unreadable file, and for a missing unit or axis.
void read_meshes(const LoadContext& load_context, multibody::MechanicsDef& mechanics, Problems& problems);

// Sets the shape's triangles and removes its file.
void put_mesh(const contact::MeshDef& mesh, multibody::ShapeDef& shape);

}  // namespace slew::scene
