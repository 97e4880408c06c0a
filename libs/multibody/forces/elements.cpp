// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstddef>

#include "core/index.h"
#include "multibody/constraints/rows.h"
#include "multibody/contacts/contact_passes.h"
#include "multibody/forces/element_law.h"
#include "multibody/formulations/passes.h"

namespace slew::multibody {

using math::Vec3;

namespace {

// a damper alone needs the axis only
bool needs_angle(const AngleElement& element) noexcept {
  return element.has_row || has_spring(element.law);
}

void update_line(const LineElement& line, const Workspace& ws, LineMotion& m) noexcept {
  const LinkMotion& link1 = ws.motion[at(line.link1)];
  const LinkMotion& link2 = ws.motion[at(line.link2)];
  const Vec3 s1 = link1.R * line.p1, s2 = link2.R * line.p2;
  m.P1 = link1.p + s1;
  m.P2 = link2.p + s2;
  m.w = (link1.v + cross(link1.w, s1)) - (link2.v + cross(link2.w, s2));
  const Vec3 d = m.P1 - m.P2;
  m.length = norm(d);
  m.e = d * (1 / m.length);
  m.rate = dot(m.e, m.w);
}

void update_angle(const Model& model, const AngleElement& element, std::span<const double> q, const Workspace& ws,
                  AngleMotion& m) noexcept {
  const LinkMotion& link1 = ws.motion[at(element.link1)];
  const LinkMotion& link2 = ws.motion[at(element.link2)];
  if (element.is_coaxial) {
    m.angle = element.offset;
    for (int i = element.first_path; i < element.path_end; ++i) {
      const PathEntry& entry = model.paths[at(i)];
      m.angle += entry.turn * q[at(model.links[at(entry.link)].q)];
    }
    m.n = link1.R * element.axis;
  } else {
    // angle of f2's shadow on the plane of f1 and g1; n is its gradient
    const Vec3 f1 = link1.R * element.f1, g1 = link1.R * element.g1, f2 = link2.R * element.f2;
    const double c = dot(f2, f1), s = dot(f2, g1);
    m.angle = std::atan2(s, c);
    m.n = cross(f2, g1 * c - f1 * s) * (1 / (c * c + s * s));
  }
  m.rate = dot(m.n, link2.w - link1.w);
}

void push(Workspace& ws, int link, Vec3 point, Vec3 force) noexcept {
  ArticulatedInertia& body = ws.inertia[at(link)];
  body.f -= force;
  body.n -= cross(point - ws.motion[at(link)].p, force);
}

void push_apart(const LineElement& line, const LineMotion& m, double force, Workspace& ws) noexcept {
  const Vec3 F = m.e * force;
  push(ws, line.link1, m.P1, F);
  push(ws, line.link2, m.P2, -F);
}

double speed_about(Vec3 axis, const LinkMotion& link1, const LinkMotion& link2) noexcept {
  return dot(axis, link2.w - link1.w);
}

void turn(const AngleElement& element, Vec3 torque, Workspace& ws) noexcept {
  ws.inertia[at(element.link2)].n -= torque;
  ws.inertia[at(element.link1)].n += torque;
}

// along a coordinate of a joint that is cut
void push_cut(const Model& model, const Row& row, double force, Workspace& ws) noexcept {
  const Cut& cut = model.cuts[at(model.joints[at(row.element)].cut)];
  const RowGradient G = coordinate_of_cut(model, row, ws).G;
  ArticulatedInertia &body1 = ws.inertia[at(cut.link1)], &body2 = ws.inertia[at(cut.link2)];
  body1.f -= G.v1 * force;
  body1.n -= G.w1 * force;
  body2.f -= G.v2 * force;
  body2.n -= G.w2 * force;
}

}  // namespace

double damper_speed(const AngleElement& element, const Workspace& ws) noexcept {
  const LinkMotion& link1 = ws.motion[at(element.link1)];
  return speed_about(link1.R * element.axis, link1, ws.motion[at(element.link2)]);
}

Vec3 torque_of(const AngleElement& element, const AngleMotion& m, const Workspace& ws) noexcept {
  // the damper acts about the axis itself, so that three of them at right angles damp any rotation alike
  const LinkMotion& link1 = ws.motion[at(element.link1)];
  const Vec3 axis = link1.R * element.axis;
  Vec3 torque = axis * damper_force(element.law, speed_about(axis, link1, ws.motion[at(element.link2)]));
  if (has_spring(element.law)) torque += m.n * force_of(element.law, m.angle, m.rate, 0);
  return torque;
}

void update_elements(const Model& model, std::span<const double> q, Elements which, Workspace& ws) noexcept {
  for (std::size_t i = 0; i < model.lines.size(); ++i) {
    if (which == Elements::all || model.lines[i].is_used) update_line(model.lines[i], ws, ws.lines[i]);
  }
  for (std::size_t i = 0; i < model.angles.size(); ++i) {
    const AngleElement& element = model.angles[i];
    if (which == Elements::all || needs_angle(element)) update_angle(model, element, q, ws, ws.angles[i]);
  }
}

void apply_elements(const Model& model, Workspace& ws) noexcept {
  for (std::size_t i = 0; i < model.lines.size(); ++i) {
    const LineElement& line = model.lines[i];
    if (!line.law.is_active) continue;
    const LineMotion& m = ws.lines[i];
    push_apart(line, m, force_of(line.law, m.length, m.rate, m.rate), ws);
  }
  for (std::size_t i = 0; i < model.angles.size(); ++i) {
    const AngleElement& element = model.angles[i];
    if (!element.law.is_active) continue;
    turn(element, torque_of(element, ws.angles[i], ws), ws);
  }
  for_each_wrench(model.elements, ws.motion, ws.time, [&ws](int link, int, const Wrench& wrench) {
    ws.inertia[at(link)].f -= wrench.f;
    ws.inertia[at(link)].n -= wrench.n;
  });
}

void apply_row_forces(const Model& model, Workspace& ws) noexcept {
  for (std::size_t i = 0; i < model.rows.size(); ++i) {
    if (ws.row_is_active[i] == 0) continue;
    const Row& row = model.rows[i];
    const double force = ws.row_force[i];
    switch (row.kind) {
      case RowKind::length:
        push_apart(model.lines[at(row.element)], ws.lines[at(row.element)], force, ws);
        break;
      case RowKind::angle:
        turn(model.angles[at(row.element)], ws.angles[at(row.element)].n * force, ws);
        break;
      case RowKind::ball: {
        const Joint& joint = model.joints[at(row.element)];
        const Vec3 torque = turn_of_ball(model, row, ws).G.w2 * force;
        ws.inertia[at(model.bodies[at(joint.body2)].link)].n -= torque;
        ws.inertia[at(model.bodies[at(joint.body1)].link)].n += torque;
        break;
      }
      case RowKind::joint:
        if (row.link == 0) {
          push_cut(model, row, force, ws);
        } else {
          ws.tau[at(model.links[at(row.link)].u + row.place)] += force;
        }
        break;
    }
  }
}

void apply_all(const Model& model, std::span<const double> q, Workspace& ws) noexcept {
  update_elements(model, q, Elements::used, ws);
  update_contacts(model, ws);
  update_inertia(model, ws);
  update_coupled(model, ws);
  apply_elements(model, ws);
  apply_contacts(model, ws);
}

}  // namespace slew::multibody
