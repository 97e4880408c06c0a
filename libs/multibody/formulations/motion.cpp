// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstddef>

#include "multibody/formulations/passes.h"
#include "multibody/joints/joint_directions.h"

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

// R Rz(angle)
Mat3 turned_about_z(const Mat3& R, double angle) noexcept {
  const auto [s, c] = math::sin_cos(angle);
  return {R.c[0] * c + R.c[1] * s, R.c[1] * c - R.c[0] * s, R.c[2]};
}

math::Quaternion quaternion_at(std::span<const double> q, std::size_t i) noexcept {
  return {q[i], q[i + 1], q[i + 2], q[i + 3]};
}

void move_revolute(const Link& link, const LinkMotion& parent, double q, double u, LinkMotion& m) noexcept {
  m.R = turned_about_z(parent.R * link.R_PJ, q);
  m.axis = m.R.c[2];
  m.r = parent.R * link.p_PJ;
  const Vec3 spin = m.axis * u;
  const Vec3 v_rel = cross(parent.w, m.r);
  m.p = parent.p + m.r;
  m.w = parent.w + spin;
  m.v = parent.v + v_rel;
  m.alpha = parent.alpha + cross(parent.w, spin);
  m.a = parent.a + cross(parent.alpha, m.r) + cross(parent.w, v_rel);
}

void move_prismatic(const Link& link, const LinkMotion& parent, double q, double u, LinkMotion& m) noexcept {
  m.R = parent.R * link.R_PJ;
  m.axis = m.R.c[2];
  m.r = parent.R * link.p_PJ + m.axis * q;
  const Vec3 slide = m.axis * u;
  const Vec3 v_rel = cross(parent.w, m.r);
  m.p = parent.p + m.r;
  m.w = parent.w;
  m.v = parent.v + v_rel + slide;
  m.alpha = parent.alpha;
  // the last term is Coriolis' acceleration
  m.a = parent.a + cross(parent.alpha, m.r) + cross(parent.w, v_rel) + cross(parent.w, slide) * 2;
}

void move_universal(const Link& link, const LinkMotion& parent, std::span<const double> q, std::span<const double> u,
                    LinkMotion& m) noexcept {
  const Mat3 turned = turned_about_z(parent.R * link.R_PJ, q[0]);
  m.axis1 = turned.c[2];
  m.R = turned_about_z({turned.c[1], turned.c[2], turned.c[0]}, q[1]);
  m.axis = m.R.c[2];
  m.r = parent.R * link.p_PJ;
  const Vec3 v_rel = cross(parent.w, m.r);
  const Vec3 spin1 = m.axis1 * u[0], spin2 = m.axis * u[1];
  const Vec3 w_between = parent.w + spin1;
  m.p = parent.p + m.r;
  m.w = w_between + spin2;
  m.v = parent.v + v_rel;
  m.alpha = parent.alpha + cross(parent.w, spin1) + cross(w_between, spin2);
  m.a = parent.a + cross(parent.alpha, m.r) + cross(parent.w, v_rel);
}

void move_cylindrical(const Link& link, const LinkMotion& parent, std::span<const double> q, std::span<const double> u,
                      LinkMotion& m) noexcept {
  m.R = turned_about_z(parent.R * link.R_PJ, q[0]);
  m.axis = m.R.c[2];
  m.r = parent.R * link.p_PJ + m.axis * q[1];
  const Vec3 spin = m.axis * u[0], slide = m.axis * u[1];
  const Vec3 v_rel = cross(parent.w, m.r);
  m.p = parent.p + m.r;
  m.w = parent.w + spin;
  m.v = parent.v + v_rel + slide;
  m.alpha = parent.alpha + cross(parent.w, spin);
  m.a = parent.a + cross(parent.alpha, m.r) + cross(parent.w, v_rel) + cross(parent.w, slide) * 2;
}

// u is the relative angular velocity in Ground axes: u' = 0 leaves the parent's angular acceleration unchanged
void move_spherical(const Link& link, const LinkMotion& parent, const math::Quaternion& q, Vec3 u,
                    LinkMotion& m) noexcept {
  m.R = math::rotation_of(q);
  m.r = parent.R * link.p_PJ;
  const Vec3 v_rel = cross(parent.w, m.r);
  m.p = parent.p + m.r;
  m.w = parent.w + u;
  m.v = parent.v + v_rel;
  m.alpha = parent.alpha;
  m.a = parent.a + cross(parent.alpha, m.r) + cross(parent.w, v_rel);
}

void move_floating(const LinkMotion& ground, std::span<const double> q, std::span<const double> u,
                   LinkMotion& m) noexcept {
  m.p = vector_at(q, 0);
  m.r = m.p;
  m.R = math::rotation_of(quaternion_at(q, 3));
  m.v = vector_at(u, 0);
  m.w = vector_at(u, 3);
  m.alpha = Vec3();
  m.a = ground.a;
}

// prescribed accelerations of a joint
void add_prescribed(const Link& link, const Workspace& ws, LinkMotion& m) noexcept {
  const auto acceleration = [&](std::size_t k) {
    return link.drive[k] < 0 ? 0.0 : ws.drives[static_cast<std::size_t>(link.drive[k])].acceleration;
  };
  if (speed_count(link.joint) == 1) {
    (link.joint == LinkJoint::revolute ? m.alpha : m.a) += m.axis * acceleration(0);
    return;
  }
  const Pair S = directions(link.joint, m);
  m.alpha += S.turn[0] * acceleration(0) + S.turn[1] * acceleration(1);
  m.a += S.slide[0] * acceleration(0) + S.slide[1] * acceleration(1);
}

// out of line: rigid scenes do not come here
[[gnu::noinline]] void move_to_node(const Model& model, const Link& link, const LinkMotion& parent, Workspace& ws,
                                    LinkMotion& m) noexcept {
  const auto node = static_cast<std::size_t>(link.node);
  const FlexibleNode& place = model.nodes[node];
  move_node(place, parent, ws.parts[static_cast<std::size_t>(place.part)], ws.nodes[node], m);
}

// shape and inertia of the flexible parts whose frame a link is; out of line, since few links have some
[[gnu::noinline]] void see_parts(const Model& model, std::size_t i, std::span<const double> q,
                                 std::span<const double> u, Workspace& ws) noexcept {
  for (int k = model.links[i].first_part; k < model.links[i].part_end; ++k) {
    const FlexiblePart& part = model.parts[static_cast<std::size_t>(k)];
    see_part(part, q.subspan(static_cast<std::size_t>(part.q), part.modes),
             u.subspan(static_cast<std::size_t>(part.u), part.modes), ws.motion[i],
             ws.parts[static_cast<std::size_t>(k)]);
  }
}

void move_link(const Model& model, std::size_t i, std::span<const double> q, std::span<const double> u,
               Workspace& ws) noexcept {
  const Link& link = model.links[i];
  const LinkMotion& parent = ws.motion[static_cast<std::size_t>(link.parent)];
  LinkMotion& m = ws.motion[i];
  const auto qi = static_cast<std::size_t>(link.q), ui = static_cast<std::size_t>(link.u);
  switch (link.joint) {
    case LinkJoint::revolute:
      move_revolute(link, parent, q[qi], u[ui], m);
      break;
    case LinkJoint::prismatic:
      move_prismatic(link, parent, q[qi], u[ui], m);
      break;
    case LinkJoint::spherical:
      move_spherical(link, parent, quaternion_at(q, qi), vector_at(u, ui), m);
      break;
    case LinkJoint::floating:
      move_floating(parent, q.subspan(qi, 7), u.subspan(ui, 6), m);
      break;
    case LinkJoint::universal:
      move_universal(link, parent, q.subspan(qi, 2), u.subspan(ui, 2), m);
      break;
    case LinkJoint::cylindrical:
      move_cylindrical(link, parent, q.subspan(qi, 2), u.subspan(ui, 2), m);
      break;
    case LinkJoint::node:
      move_to_node(model, link, parent, ws, m);
      break;
  }
  if (link.is_driven) add_prescribed(link, ws, m);
}

}  // namespace

void update_motion(const Model& model, std::span<const double> q, std::span<const double> u, Workspace& ws) noexcept {
  ws.loops.is_shown = false;
  ws.motion[0].a = -model.gravity;
  // rigid mechanisms skip the modes
  if (model.parts.empty()) {
    for (std::size_t i = 1; i < model.links.size(); ++i) move_link(model, i, q, u, ws);
    return;
  }
  see_parts(model, 0, q, u, ws);
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    move_link(model, i, q, u, ws);
    if (model.links[i].has_parts()) see_parts(model, i, q, u, ws);
  }
}

void coordinate_rates(const Model& model, const Workspace& ws, std::span<const double> q, std::span<const double> u,
                      std::span<double> qdot) noexcept {
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    auto qi = static_cast<std::size_t>(link.q);
    const auto ui = static_cast<std::size_t>(link.u);
    if (link.joint == LinkJoint::node) continue;
    if (link.joint != LinkJoint::spherical && link.joint != LinkJoint::floating) {
      qdot[qi] = u[ui];
      if (speed_count(link.joint) == 2) qdot[qi + 1] = u[ui + 1];
      continue;
    }
    if (link.joint == LinkJoint::floating) {
      for (std::size_t k = 0; k < 3; ++k) qdot[qi + k] = u[ui + k];
      qi += 3;
    }
    const math::Quaternion rate = math::derivative(quaternion_at(q, qi), ws.motion[i].w);
    qdot[qi] = rate.w;
    qdot[qi + 1] = rate.x;
    qdot[qi + 2] = rate.y;
    qdot[qi + 3] = rate.z;
  }
  for_each_mode(model, [&](std::size_t q_k, std::size_t u_k) { qdot[q_k] = u[u_k]; });
}

namespace {

void turn(std::span<double> q, std::size_t i, Vec3 delta) noexcept {
  const math::Quaternion half{1, 0.5 * delta[0], 0.5 * delta[1], 0.5 * delta[2]};
  const math::Quaternion turned = math::normalized(half * quaternion_at(q, i));
  q[i] = turned.w;
  q[i + 1] = turned.x;
  q[i + 2] = turned.y;
  q[i + 3] = turned.z;
}

}  // namespace

void displace(const Model& model, const Workspace& ws, std::span<const double> step, std::span<double> q) noexcept {
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    const auto qi = static_cast<std::size_t>(link.q), ui = static_cast<std::size_t>(link.u);
    switch (link.joint) {
      case LinkJoint::spherical:
        turn(q, qi, ws.delta_alpha[i]);
        break;
      case LinkJoint::floating:
        for (std::size_t k = 0; k < 3; ++k) q[qi + k] += step[ui + k];
        turn(q, qi + 3, ws.delta_alpha[i]);
        break;
      case LinkJoint::universal:
      case LinkJoint::cylindrical:
        q[qi + 1] += step[ui + 1];
        [[fallthrough]];
      case LinkJoint::revolute:
      case LinkJoint::prismatic:
        q[qi] += step[ui];
        break;
      case LinkJoint::node:
        break;
    }
  }
  for_each_mode(model, [&](std::size_t q_k, std::size_t u_k) { q[q_k] += step[u_k]; });
}

void move_from(const Model& model, std::span<const double> start, const Displacement& displacement,
               std::span<const double> u, std::span<double> q, Workspace& ws) noexcept {
  ws.loops.is_shown = false;
  ws.motion[0].a = -model.gravity;
  for_each_mode(model, [&](std::size_t q_k, std::size_t u_k) {
    q[q_k] = start[q_k] + displacement.base[u_k] + displacement.scale * u[u_k];
  });
  see_parts(model, 0, q, u, ws);
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    const auto ui = static_cast<std::size_t>(link.u);
    auto qi = static_cast<std::size_t>(link.q);
    if (link.joint != LinkJoint::spherical && link.joint != LinkJoint::floating) {
      for (int k = 0; k < speed_count(link.joint); ++k, ++qi) {
        const std::size_t j = ui + static_cast<std::size_t>(k);
        const int drive = link.drive[static_cast<std::size_t>(k)];
        q[qi] = drive < 0 ? start[qi] + displacement.base[j] + displacement.scale * u[j]
                          : ws.drives[static_cast<std::size_t>(drive)].position;
      }
    } else {
      Vec3 w = vector_at(u, ui) + ws.motion[static_cast<std::size_t>(link.parent)].w;
      if (link.joint == LinkJoint::floating) {
        for (std::size_t k = 0; k < 3; ++k, ++qi)
          q[qi] = start[qi] + displacement.base[ui + k] + displacement.scale * u[ui + k];
        w = vector_at(u, ui + 3);
      }
      const math::Quaternion turned =
          math::normalized(math::turn_by(displacement.turn[i] + w * displacement.scale) * quaternion_at(start, qi));
      q[qi] = turned.w;
      q[qi + 1] = turned.x;
      q[qi + 2] = turned.y;
      q[qi + 3] = turned.z;
    }
    move_link(model, i, q, u, ws);
    if (link.has_parts()) see_parts(model, i, q, u, ws);
  }
}

}  // namespace slew::multibody
