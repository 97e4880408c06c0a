// SPDX-License-Identifier: Apache-2.0
// Mass, centre and inertia of the solid that a closed mesh encloses, at one density.
//
// Signed tetrahedra from an inner point o to every triangle (a, b, c), positions from o:
//   6 V = sum a.(b x c)                                                                      (1)
//   24 V r = sum det (a + b + c)                                                             (2)
//   120 C = sum det ((a+b+c)(a+b+c)^T + a a^T + b b^T + c c^T),   C = integral of x x^T      (3)
//   I = density (tr(C_c) 1 - C_c),   C_c = C - V r r^T                                       (4)
// exact for a polyhedron. o is the middle of the bounding box, so that a mesh far from its origin loses no digits.
// Source: Mirtich 1996 (the integrals), Tonon 2004 (tetrahedra). A hole is a surface turned inside out
// within another. Not covered: more than one density.
#pragma once

#include "contact/contact_def.h"
#include "math/vector3.h"

namespace slew::contact {

struct MassProperties {
  double volume = 0;   // m3
  double mass = 0;     // kg
  math::Vec3 centre;   // m, mesh's axes
  math::Mat3 inertia;  // kg m2 about the centre, mesh's axes; off-diagonal elements are -integral x y dm
};

// density: kg/m3, > 0. Pre-condition: find_solid_fault(mesh) found nothing (mesh_check.h).
[[nodiscard]] MassProperties mass_properties(const MeshDef& mesh, double density);

// The same for a sheet of this thickness [m] on the mesh's surface, open or closed: with A the area of a triangle,
//   V = t sum A,   V r = t sum A (a+b+c)/3,   C = t sum A/12 ((a+b+c)(a+b+c)^T + a a^T + b b^T + c c^T)   (5)
// Exact for a thin sheet: the error by its thickness is of the order t^2 over the size squared. The orientation of
// triangles has no effect; a duplicate counts twice. Pre-condition: finite vertices, an area.
[[nodiscard]] MassProperties shell_properties(const MeshDef& mesh, double thickness, double density);

}  // namespace slew::contact
