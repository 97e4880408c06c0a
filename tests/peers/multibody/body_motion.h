// SPDX-License-Identifier: Apache-2.0
// Motion of a mechanism's bodies and the wrenches on them, in Ground axes: results that every program has for the same
// mechanism, in any coordinates.
#pragma once

#include <vector>

#include "math/rotation.h"
#include "multibody/formulations/dynamics.h"

namespace slew::multibody::testing {

struct BodyMotion {
  math::Mat3 R = math::Mat3::identity();  // R_WB
  math::Vec3 p;                           // m, of the body's origin
  math::Vec3 w;                           // rad/s
  math::Vec3 v;                           // m/s
  math::Vec3 alpha;                       // rad/s2
  math::Vec3 a;                           // m/s2
};

struct Wrench {
  math::Vec3 torque;  // N m, about the body's origin
  math::Vec3 force;   // N
};

// by body: [0] is Ground, [i + 1] MechanicsDef::bodies[i]
using Motions = std::vector<BodyMotion>;
using Wrenches = std::vector<Wrench>;

struct PointMotion {
  math::Vec3 p, v, a;
};

inline PointMotion motion_of_point(const BodyMotion& body, math::Vec3 p_B) {
  const math::Vec3 r = body.R * p_B;
  return {body.p + r, body.v + cross(body.w, r), body.a + cross(body.alpha, r) + cross(body.w, cross(body.w, r))};
}

// Ours; accelerations after forward_dynamics() or evaluate().
inline Motions motions_of(const Model& model, const Workspace& ws) {
  Motions motions;
  for (const Body& body : model.bodies) {
    const auto link = static_cast<std::size_t>(body.link);
    const LinkMotion& m = ws.motion[link];
    const BodyMotion of_link = {
        m.R, m.p, m.w, m.v, m.alpha + ws.delta_alpha[link], m.a + ws.delta_a[link] + model.gravity};
    const PointMotion origin = motion_of_point(of_link, body.p_LB);
    motions.push_back({m.R * body.R_LB, origin.p, m.w, origin.v, of_link.alpha, origin.a});
  }
  return motions;
}

}  // namespace slew::multibody::testing
