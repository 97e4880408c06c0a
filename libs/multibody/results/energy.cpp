// SPDX-License-Identifier: Apache-2.0
#include <cstddef>

#include "core/index.h"
#include "multibody/contacts/contact_passes.h"
#include "multibody/forces/coupled_mass.h"
#include "multibody/forces/element_law.h"
#include "multibody/formulations/passes.h"
#include "multibody/results/observe.h"

namespace slew::multibody {

using math::Vec3;

namespace {

Vec3 velocity_at(const LinkMotion& link, Vec3 point) noexcept {
  return link.v + cross(link.w, point - link.p);
}

// centres and velocities of cylinder and piston on their line, which they follow without spin about it
struct CoupledPoints {
  Vec3 p1, p2, v1, v2;  // m, m/s
  Vec3 spin;            // rad/s, across the line
};

CoupledPoints coupled_points(const Model& model, const Workspace& ws, const CoupledMass& mass) noexcept {
  const LineElement& element = model.lines[at(mass.line)];
  const LineMotion& line = ws.lines[at(mass.line)];
  const Vec3 e_dot = (line.w - line.e * line.rate) * (1 / line.length);
  return {line.P1 + line.e * mass.c1, line.P2 + line.e * mass.c2,
          velocity_at(ws.motion[at(element.link1)], line.P1) + e_dot * mass.c1,
          velocity_at(ws.motion[at(element.link2)], line.P2) + e_dot * mass.c2, cross(line.e, e_dot)};
}

}  // namespace

void observe(const Model& model, const State& state, Workspace& ws) noexcept {
  set_time(model, state.time, ws);
  update_motion(model, state.q, state.u, ws);
  update_elements(model, state.q, Elements::all, ws);
  begin_contacts(model, state, ws);
  update_contacts(model, ws);
}

void observe_elements(const Model& model, const State& state, Workspace& ws) noexcept {
  update_elements(model, state.q, Elements::all, ws);
}

Energy energy(const Model& model, const Workspace& ws) noexcept {
  Energy sum;
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    const LinkMotion& m = ws.motion[i];
    const Vec3 h = m.R * link.h_L, w_L = transpose_multiply(m.R, m.w);
    sum.kinetic += 0.5 * link.mass * dot(m.v, m.v) + dot(m.v, cross(m.w, h)) + 0.5 * dot(w_L, link.I_L * w_L);
    sum.potential -= dot(model.gravity, m.p * link.mass + h);
  }
  for (std::size_t k = 0; k < model.parts.size(); ++k) {
    const PartEnergy part = energy_of(model.parts[k], ws.parts[k], ws.motion[at(model.parts[k].link)], model.gravity);
    sum.kinetic += part.kinetic;
    sum.potential += part.potential;
  }
  for (const CoupledMass& mass : model.coupled) {
    const CoupledPoints c = coupled_points(model, ws, mass);
    sum.kinetic +=
        0.5 * (mass.m1 * dot(c.v1, c.v1) + mass.m2 * dot(c.v2, c.v2) + mass.transverse * dot(c.spin, c.spin));
    sum.potential -= dot(model.gravity, c.p1 * mass.m1 + c.p2 * mass.m2);
  }
  for (std::size_t i = 0; i < model.lines.size(); ++i) {
    sum.potential += stored_energy(model.lines[i].law, ws.lines[i].length);
  }
  for (std::size_t i = 0; i < model.angles.size(); ++i) {
    sum.potential += stored_energy(model.angles[i].law, ws.angles[i].angle);
  }
  if (ws.contact != nullptr) {
    for (std::size_t i = 0; i < ws.contact->force_count; ++i) sum.potential += ws.contact->forces[i].energy;
  }
  sum.potential += stored_energy(model.elements, ws.motion);
  return sum;
}

Momentum momentum(const Model& model, const Workspace& ws) noexcept {
  Vec3 linear, angular;
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    const LinkMotion& m = ws.motion[i];
    const Vec3 h = m.R * link.h_L;
    const Vec3 p = m.v * link.mass + cross(m.w, h);
    linear += p;
    angular += cross(m.p, p) + cross(h, m.v) + m.R * (link.I_L * transpose_multiply(m.R, m.w));
  }
  for (std::size_t k = 0; k < model.parts.size(); ++k) {
    const LinkMotion& frame = ws.motion[at(model.parts[k].link)];
    const PartMomentum part = momentum_of(ws.parts[k], frame);
    linear += part.linear;
    angular += part.angular + cross(frame.p, part.linear);
  }
  for (const CoupledMass& mass : model.coupled) {
    const CoupledPoints c = coupled_points(model, ws, mass);
    linear += c.v1 * mass.m1 + c.v2 * mass.m2;
    angular += cross(c.p1, c.v1 * mass.m1) + cross(c.p2, c.v2 * mass.m2) + c.spin * mass.transverse;
  }
  return {linear.array(), angular.array()};
}

}  // namespace slew::multibody
