// SPDX-License-Identifier: Apache-2.0
// Mass, centre of mass and inertia of a body from a closed mesh: `inertia: from_mesh`.
//
//   Bag: {inertia: from_mesh, mesh: bag.stl, mesh_unit: 1 mm, mesh_up: z, density: 1600 kg/m3}
//
// The solid inside of the mesh has one density: the given one, or the given mass over the mesh's volume. With the
// mesh's axes at mesh_position p_BM in the body's frame, turned by mesh_orientation R_BM, and the mesh's own centre c_M
// and inertia I_M about it (contact/mass_properties.h):
//   c_B = p_BM + R_BM c_M        I_B = R_BM I_M R_BM^T                                             (1)
// With shell_thickness the solid is a sheet of that thickness on the mesh's surface, closed or open.
// Sizes and masses that no machine has are refused, unlikely ones give warnings: a file in millimetres read in metres
// is 1e9 times as heavy. The scene keeps the numbers, not the mesh: the session's text and a recording contain them,
// and nodes need no file. Not covered: more than one density; a mesh that intersects itself is not detected
// (docs/models/contact_meshes.md).
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "contact/mesh_file/mesh_file.h"
#include "core/field.h"
#include "multibody/model/defs.h"
#include "scene/expand.h"
#include "scene/field_reader.h"
#include "scene/scene.h"
#include "scene/yaml_tree.h"

namespace slew::scene {

inline constexpr std::string_view kFromMesh = "from_mesh";

// Replacement of inertia, products, inertia_about and center_of_mass.
struct MeshInertiaDef {
  std::string mesh{};                            // file in the scene's folder, of the endings of mesh_file.h
  double mesh_unit = 1;                          // m per unit of the file, > 0
  contact::UpAxis mesh_up = contact::UpAxis::y;  // this axis of the file ...
  contact::UpAxis body_up = contact::UpAxis::y;  // ... becomes this axis, by a quarter turn about x
  Triple mesh_position{};                        // m, the mesh's origin, body frame
  Triple mesh_orientation{};                     // rad, successive rotations z, x', z''
  double density = multibody::kUnlimited;        // kg/m3, > 0; infinite: from the mass
  double mass = multibody::kUnlimited;           // kg, > 0; infinite: from the density
  double shell_thickness = 0;                    // m; > 0: a sheet on the mesh's surface, which may be open
};

[[nodiscard]] std::span<const Field> mesh_inertia_fields() noexcept;

// True if an element of the section `bodies` has inertia: from_mesh.
[[nodiscard]] bool takes_from_mesh(const Node& body);

// Reads such an element into the body, and the mesh's results into scene.solid_inertias. Problems go to the report,
// also an unreadable, open, non-finite or inverted mesh. Reads the mesh's file: allocates, not real-time safe.
void read_mesh_body(const Node::Entry& element, std::span<const Field> body_fields, const LoadContext& load_context,
                    multibody::BodyDef& body, Scene& scene, const ReadContext& context);

}  // namespace slew::scene
