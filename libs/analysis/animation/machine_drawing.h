// SPDX-License-Identifier: Apache-2.0
// A machine as lines: an outline of its bodies, joints, shapes and cylinders.
//
// A body is a star from the joint that carries it to its centre of mass and to the points at which joints and forces
// act, and its contact shapes: edges of boxes and of meshes, rims of round shapes, rims of height fields. A body
// without any line is a small cross at its centre of mass. Planes, ropes and bending are not drawn.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "math/vector3.h"
#include "multibody/model/defs.h"

namespace slew::analysis {

using Polyline = std::vector<Triple>;  // m, in the body's frame

[[nodiscard]] inline math::Vec3 to_vec(const Triple& t) noexcept {
  return {t[0], t[1], t[2]};
}

struct BodyDrawing {
  std::string name;  // "Ground" first, which has no pose
  std::vector<Polyline> lines;
};

// A line between points of two bodies: cylinders and other forces along a line.
struct LinkDrawing {
  std::string name;
  std::size_t body1 = 0, body2 = 0;  // in MachineDrawing::bodies
  Triple point1{}, point2{};         // m, in their frames
};

struct MachineDrawing {
  std::vector<BodyDrawing> bodies;
  std::vector<LinkDrawing> links;
  std::array<Triple, 3> axes{};  // unit vectors: to the right and to the viewer in the side view, up
};

// Up is against gravity, y without gravity; to the right is x, or z where x is upright.
[[nodiscard]] MachineDrawing draw_machine(const multibody::MechanicsDef& mechanics);

}  // namespace slew::analysis
