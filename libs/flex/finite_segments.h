// SPDX-License-Identifier: Apache-2.0
// A straight beam as rigid lumps with massless elastic connectors between them: the finite segment method.
//
// n connectors of equal length l = L/n lie end to end from one end of the beam to the other; lump i, 0 to n, sits at
// their ends, s = i l, and has the mass of the beam between the middles of the connectors beside it, so that those at
// the ends of the beam are half as long. Along a lump's stretch, with rho A, rho Iyy, rho Izz by length,
//   m = int rho A ds,  m c = int rho A s ds,  J_x = int (rho Iyy + rho Izz) ds,
//   J_y = int [rho Iyy + rho A (s - c)^2] ds,  J_z = int [rho Izz + rho A (s - c)^2] ds                        (1)
// A connector has the compliance of the beam between its ends, near end held, s from there,
//   C_uu = int ds/EA,  C_tt = int ds/GJ,  and in each plane of bending
//   C_vv = int [(l-s)^2/EI + 1/kGA] ds,  C_vr = int (l-s)/EI ds,  C_rr = int ds/EI                             (2)
// whose inverse is its stiffness: thesis eq. 29, with the signs of the errata, where the beam is the same between its
// ends, and exact where it is not. So loads on lumps deflect the lumps as they deflect the beam.
// Source: the flexible-body tutorial thesis (2017), eq. 28 to 33, after Sopanen 2004. Not covered: beams that are not
// straight or branch, principal axes that turn along the beam, imported matrices.
// Card: docs/models/flex_finite_segments.md.
#pragma once

#include <cstddef>
#include <vector>

#include "flex/reduction.h"

namespace slew::flex {

struct SegmentLump {
  math::Vec3 station;  // m, body frame
  double mass = 0;     // kg
  math::Vec3 centre;   // m, body frame
  math::Mat3 inertia;  // kg m2 about the centre, body axes
};

// Non-zero entries of the stiffness [N/m, N, N m/rad] for displacement and rotation of the far end relative to the near
// end, in the connector's axes.
struct ConnectorStiffness {
  double k11 = 0, k22 = 0, k33 = 0, k44 = 0, k55 = 0, k66 = 0;
  double k26 = 0, k35 = 0;
};

struct SegmentConnector {
  std::size_t near = 0, far = 0;  // lumps; near is towards the root
  math::Mat3 axes;                // columns x from near to far, y, z; body frame
  double length = 0;              // m
  ConnectorStiffness K;
};

struct FiniteSegments {
  std::vector<SegmentLump> lumps;
  std::vector<SegmentConnector> connectors;  // each after the one that carries its near lump
  std::size_t root = 0;                      // lump of the node that the body frame is clamped to, else of the first
                                             // node
  std::vector<std::size_t> lump_of;          // lump by node
};

// Pre-condition: segments >= 1. Throws InputError for models that are not covered.
[[nodiscard]] FiniteSegments finite_segments(const Reduction& reduction, int segments);

}  // namespace slew::flex
