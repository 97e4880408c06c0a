// SPDX-License-Identifier: Apache-2.0
// Tipping of a machine at rest about lines on which it stands.
//
//   M(m) = e . sum_i (c_i - P) x m_i g + m e . (c - P) x g = M_0 + m s,   m_tip = -M_0 / s                       (1)
// P a point of the line, e its direction, c_i and m_i all masses but the payload, those that are fixed to Ground
// included; c the payload's centre of mass. M_0 has the sign of the side on which the machine stands; a payload whose s
// has the same sign never tips it about this line. Static: ISO 10567 and EN 13000 take their rated loads as shares of
// this load. Not covered: give of ground and tyres, inertia, wind, slopes (turn `mechanics.gravity` for one).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "math/vector3.h"
#include "multibody/model/state.h"
#include "scene/scene.h"

namespace slew::analysis {

struct TippingLine {
  math::Vec3 P, Q;        // m, Ground: two points
  math::Vec3 inside;      // m, a point on the side where the machine stands; unused if !has_side
  bool has_side = false;  // false: the side on which the machine is without the payload
};

// "1.4 0 -1.2, 1.4 0 1.2": two points of Ground [m]. Throws Failure (bad_input).
[[nodiscard]] TippingLine read_tipping_line(const std::string& text);

// The sides of the smallest convex polygon around the tyres' places where the scene has three tyres or more, seen along
// gravity; none otherwise. Pre-condition: observe() with this workspace.
[[nodiscard]] std::vector<TippingLine> lines_of_tyres(const multibody::Model& model, const multibody::Workspace& ws);

struct Weight {
  math::Vec3 c;  // m, Ground
  double mass = 0;
};

// All masses but the body's own. Pre-condition: observe() with this workspace, no flexible body.
[[nodiscard]] std::vector<Weight> weights_without(const multibody::Model& model, const multibody::Workspace& ws,
                                                  int body);

// (1) [kg]; infinite: the payload does not tip the machine about this line. 0: it tips without payload.
[[nodiscard]] double tipping_load(const TippingLine& line, std::span<const Weight> weights, math::Vec3 payload,
                                  math::Vec3 gravity) noexcept;

}  // namespace slew::analysis
