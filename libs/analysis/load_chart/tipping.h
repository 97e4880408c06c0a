// SPDX-License-Identifier: Apache-2.0
// Tipping of a machine at rest about lines on which it stands.
//
//   M(m) = e . sum_i (c_i - P) x m_i g + m e . (c - P) x g = M_0 + m s,   m_tip = -M_0 / s                       (1)
// P a point of the line, e its direction, c_i and m_i all masses but the payload, those that are fixed to Ground
// included; c the payload's centre of mass. A machine whose M_0 has not the sign of the side on which it stands tips
// without payload; a payload whose s has that sign never tips it about this line. Static: ISO 10567 and EN 13000 take
// their rated loads as shares of this load. Not covered: give of ground and tyres, inertia, wind, slopes (turn
// `mechanics.gravity` for one).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "math/vector3.h"
#include "multibody/model/state.h"
#include "scene/scene.h"

namespace slew::analysis {

struct TippingLine {
  math::Vec3 P, Q;  // m, Ground: two points
  double side = 0;  // sign: that of side_of() where the machine stands; 0: not known
};

// "1.4 0 -1.2, 1.4 0 1.2": two points of Ground [m]; a third one lies on the side where the machine stands. Throws
// Failure (bad_input), for a line along gravity too, and for a third point above or below the line.
[[nodiscard]] TippingLine read_tipping_line(const std::string& text, math::Vec3 gravity);

// Moment of 1 kg at this point about the line [Nm]; its sign is that of the point's side.
[[nodiscard]] double side_of(const TippingLine& line, math::Vec3 point, math::Vec3 gravity) noexcept;

// The sides of the smallest convex polygon around the tyres' places where the scene has three tyres or more, seen along
// gravity; none otherwise. Pre-condition: observe() with this workspace.
[[nodiscard]] std::vector<TippingLine> lines_of_tyres(const multibody::Model& model, const multibody::Workspace& ws);

struct Weight {
  math::Vec3 c;  // m, Ground
  double mass = 0;
  bool is_fixed = false;  // to Ground
};

// All masses but the body's own. Pre-condition: observe() with this workspace, no flexible body.
[[nodiscard]] std::vector<Weight> weights_without(const multibody::Model& model, const multibody::Workspace& ws,
                                                  int body);

// The terms of (1) at one pose.
struct TippingMoments {
  double rest = 0, payload = 0;  // M_0 [Nm], s [Nm/kg]
};
[[nodiscard]] TippingMoments tipping_moments(const TippingLine& line, std::span<const Weight> weights,
                                             math::Vec3 payload, math::Vec3 gravity) noexcept;

// (1) [kg]; infinite: the payload does not tip the machine about this line. 0: it tips without payload.
[[nodiscard]] double tipping_load(const TippingMoments& moments, double side) noexcept;

struct SideChoice {
  std::string text;     // sentence
  bool is_sure = true;  // 1 or 2 below
};

// Where a machine stands beside each line that was given without its side. The first that decides:
//   1. its parts that are fixed to Ground, of which the common centre of mass lies within the lines of support;
//   2. the other lines, if all their points lie on one side: lines of support enclose a convex area;
//   3. the payload, if it is on one side at all poses: the machine stands on the other one;
//   4. the side on which the machine holds without payload at most poses.
// moments: by pose, of this line.
[[nodiscard]] SideChoice choose_side(std::vector<TippingLine>& lines, std::size_t line, std::span<const Weight> weights,
                                     std::span<const TippingMoments> moments, math::Vec3 gravity);

}  // namespace slew::analysis
