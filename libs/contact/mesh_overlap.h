// SPDX-License-Identifier: Apache-2.0
// Volume that a mesh of closed solids encloses more than once, or inside out: solids that overlap, or lie in each
// other, count twice in (1) of mass_properties.h.
//
// Lines parallel to the three axes, 16384 for each, spread over the box around the mesh (a lattice of the golden ratio,
// so that no bar between two rows of lines is missed). Along a line w counts the solids around a point: +1 where the
// line enters, -1 where it leaves. With l the length of its parts,
//   doubled = area of the box's side / lines * sum over the lines of l |w - min(max(w, 0), 1)|                    (1)
// the largest of the three directions, so that a thin plate is met across its face. Solids that touch at faces, edges
// or vertices, and holes (w = 1 - 1), add nothing. A line that meets an edge exactly does not return to w = 0 and is
// left out. Accuracy: a hundredth of the doubled volume where it is seen on a thousandth of the box's side or more;
// what is seen on less than a ten-thousandth of each side may be missed.
#pragma once

#include "contact/contact_def.h"
#include "math/vector3.h"

namespace slew::contact {

struct DoubledVolume {
  double volume = 0;  // m3, (1)
  math::Vec3 place;   // m: a point in the longest part of a line where w is neither 0 nor 1
};

// Pre-condition: closed surfaces of finite vertices. Allocates.
[[nodiscard]] DoubledVolume find_doubled_volume(const MeshDef& mesh);

}  // namespace slew::contact
