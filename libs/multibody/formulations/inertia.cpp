// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstddef>

#include "core/index.h"
#include "multibody/forces/coupled_mass.h"
#include "multibody/formulations/passes.h"

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

[[gnu::noinline]] void add_parts(const Model& model, Workspace& ws) noexcept {
  // Ground's entry receives the contributions of its nodes and is not used
  ws.inertia[0] = ArticulatedInertia();
  for (std::size_t k = 0; k < model.parts.size(); ++k) {
    const auto link = at(model.parts[k].link);
    add_part(model.parts[k], ws.motion[link], ws.parts[k], ws.inertia[link]);
    if (ws.shares.any()) add_shares(model.parts[k], ws.shares, ws.parts[k]);
  }
}

}  // namespace

// Newton and Euler about the link's origin O (h = m c, all in Ground axes):
//   n = J alpha + h x a + w x J w                                                                  (1)
//   f = m a + alpha x h + w x (w x h)                                                              (2)
void update_inertia(const Model& model, Workspace& ws) noexcept {
  ws.inertia[0].n = ws.inertia[0].f = Vec3();
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    const LinkMotion& m = ws.motion[i];
    ArticulatedInertia& body = ws.inertia[i];
    const Vec3 h = m.R * link.h_L;
    body.J = m.R * link.I_L * transpose(m.R);
    body.K = math::skew(-h);
    body.M = Mat3::diagonal(link.mass, link.mass, link.mass);
    body.n = body.J * m.alpha + cross(h, m.a) + cross(m.w, body.J * m.w);
    body.f = m.a * link.mass + cross(m.alpha, h) + cross(m.w, cross(m.w, h));
  }
  if (!model.parts.empty()) add_parts(model, ws);
}

// Cylinder and piston on the line between P1 and P2 (docs/models/multibody_b2bf_dummy.md). With d = P1 - P2,
// e = d/L, w = d', P = 1 - e e^T:
//   e'  = P w / L,   e'' = P (a1 - a2)/L - |e'|^2 e - 2 (L'/L) e'                                   (1)
//   centres: a_c1 = a1 + c1 e'', a_c2 = a2 + c2 e''                                                (2)
//   forces that the points need: F1 = m1 a_c1 + P G/L, F2 = m2 a_c2 - P G/L,
//                                G = m1 c1 a_c1 + m2 c2 a_c2 + I_t e''                             (3)
PointForces point_forces(const CoupledMass& mass, const LineMotion& line, Vec3 a1, Vec3 a2) noexcept {
  const double inverse_length = 1 / line.length;
  const Vec3 e = line.e, a_rel = a1 - a2;
  const Vec3 e_dot = (line.w - e * line.rate) * inverse_length;
  const Vec3 e_dotdot = (a_rel - e * dot(e, a_rel)) * inverse_length - e * dot(e_dot, e_dot) -
                        e_dot * (2 * line.rate * inverse_length);                                       // (1)
  const Vec3 a_c1 = a1 + e_dotdot * mass.c1, a_c2 = a2 + e_dotdot * mass.c2;                            // (2)
  const Vec3 G = a_c1 * (mass.m1 * mass.c1) + a_c2 * (mass.m2 * mass.c2) + e_dotdot * mass.transverse;  // (3)
  const Vec3 couple = (G - e * dot(e, G)) * inverse_length;
  return {a_c1 * mass.m1 + couple, a_c2 * mass.m2 - couple};
}

// The point forces are linear in a1, a2: across the line with the masses a11, a12, a22, along it with m1, m2.
void update_coupled(const Model& model, Workspace& ws) noexcept {
  for (std::size_t i = 0; i < model.coupled.size(); ++i) {
    const CoupledMass& mass = model.coupled[i];
    const LineElement& element = model.lines[at(mass.line)];
    const LineMotion& line = ws.lines[at(mass.line)];
    CoupledMotion& m = ws.coupled[i];
    m.e = line.e;
    m.s1 = line.P1 - ws.motion[at(mass.child)].p;
    m.s2 = line.P2 - ws.motion[at(mass.child)].p;
    const double b1 = mass.c1 / line.length, b2 = mass.c2 / line.length;
    const double turning = mass.transverse / (line.length * line.length);
    m.a11 = mass.m1 * (1 + b1) * (1 + b1) + mass.m2 * b2 * b2 + turning;
    m.a12 = mass.m2 * b2 * (1 - b2) - mass.m1 * b1 * (1 + b1) - turning;
    m.a22 = mass.m1 * b1 * b1 + mass.m2 * (1 - b2) * (1 - b2) + turning;
    const PointForces forces = point_forces(mass, line, acceleration_at(ws.motion[at(element.link1)], line.P1),
                                            acceleration_at(ws.motion[at(element.link2)], line.P2));
    m.F1 = forces.F1;
    m.F2 = forces.F2;
  }
}

}  // namespace slew::multibody
