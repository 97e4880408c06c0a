// SPDX-License-Identifier: Apache-2.0
#include "multibody/flexible/node_dummies.h"

#include <algorithm>

#include "core/check.h"
#include "core/index.h"
#include "multibody/flexible/node_span.h"
#include "multibody/formulations/spatial_block.h"
#include "multibody/joints/joint_directions.h"
#include "multibody/model/state.h"

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

int part_of(const Model& model, int node_link) noexcept {
  return model.nodes[at(model.links[at(node_link)].node)].part;
}

// velocity of the point at s from a node's origin along mode k
Vec3 along_mode(const NodeMotion& node, std::size_t k, Vec3 s) noexcept {
  return node.Phi[k] + cross(node.Psi[k], s);
}

const NodeMotion& node_of(const Model& model, const Workspace& ws, int link) noexcept {
  return ws.nodes[at(model.links[at(link)].node)];
}

// both points: of B and of A
struct Ends {
  Vec3 P_B, P_A, F_B, F_A;
  Mat3 A_BB, A_AB, A_AA;
};

Ends ends_of(const Model& model, const Workspace& ws, const NodeDummy& dummy) noexcept {
  const CoupledMass& mass = model.coupled[at(dummy.mass)];
  const CoupledMotion& m = ws.coupled[at(dummy.mass)];
  const LineMotion& line = ws.lines[at(mass.line)];
  const PointMasses A = point_masses(mass, m);
  if (dummy.is_point1_outer) return {line.P1, line.P2, m.F1, m.F2, A.A11, A.A12, A.A22};
  return {line.P2, line.P1, m.F2, m.F1, A.A22, A.A12, A.A11};
}

// mass A and bias force F at s from the link's origin
void add_point(const Mat3& A, Vec3 s, Vec3 F, ArticulatedInertia& I) noexcept {
  const Mat3 A_s = times_skew(A, s);
  I.J -= skew(s) * A_s;
  I.K -= A_s;
  I.M += A;
  I.n += cross(s, F);
  I.f += F;
}

// (2)
void see_inner(const Model& model, const Workspace& ws, const NodeDummy& dummy, Vec3 P_A, NodeDummyMotion& m) noexcept {
  m.arm = P_A - ws.motion[at(dummy.frame)].p;
  const Vec3 s = P_A - ws.motion[at(dummy.inner)].p;
  const bool rides = dummy.inner != dummy.frame;
  for (std::size_t k = 0; k < m.y.size(); ++k) {
    m.y[k] = rides ? along_mode(node_of(model, ws, dummy.inner), k, s) : Vec3();
  }
}

// (3)
void see_outer(const Model& model, const Workspace& ws, const NodeDummy& dummy, const Ends& ends, int link,
               NodeDummyMotion& m) noexcept {
  const Vec3 s = ends.P_B - ws.motion[at(link)].p;
  m.p_lin = ends.A_AB;
  m.p_ang = skew(s) * ends.A_AB;
  m.h = Vec3();
  const Vec3 s_B = ends.P_B - ws.motion[at(dummy.outer)].p;
  for (std::size_t k = 0; k < m.r.size(); ++k) {
    m.r[k] = ends.A_AB * along_mode(node_of(model, ws, dummy.outer), k, s_B);
  }
}

// (4) without Z
void eliminate_outer_modes(const Model& model, const Workspace& ws, const NodeDummy& dummy,
                           NodeDummyMotion& m) noexcept {
  if (dummy.outer_part < 0) return;
  const PartMotion& part = ws.parts[at(dummy.outer_part)];
  pass_modes(part, m.r, m.X);
  for (std::size_t k = 0; k < m.X.size(); ++k) {
    m.p_ang -= outer(part.X_ang[k], m.X[k]);
    m.p_lin -= outer(part.X_lin[k], m.X[k]);
    m.h += m.X[k] * ws.residual[at(model.parts[at(dummy.outer_part)].u) + k];
  }
}

// S^T (n, f), by coordinate
Vec3 along_joint(LinkJoint joint, const LinkMotion& m, Vec3 n, Vec3 f) noexcept {
  if (joint == LinkJoint::revolute) return {dot(m.axis, n), 0, 0};
  if (joint == LinkJoint::prismatic) return {dot(m.axis, f), 0, 0};
  if (joint == LinkJoint::spherical) return n;
  const Pair S = directions(joint, m);
  return {dot(S.turn[0], n) + dot(S.slide[0], f), dot(S.turn[1], n) + dot(S.slide[1], f), 0};
}

// entries by u of a joint, the rest zero
Vec3 of_joint(const Link& link, std::span<const double> x) noexcept {
  const int count = speed_count(link.joint);
  if (count == 0) return {};
  if (count == 3) return load(x, link.u);
  return count == 2 ? load_pair(x, link.u) : Vec3(x[at(link.u)], 0, 0);
}

// (5) without Z; then p about the origin of the link that carries the joint
void eliminate_joint(const Link& link, const LinkMotion& motion, const JointFactor& factor,
                     std::span<const double> residual, NodeDummyMotion& m) noexcept {
  for (int z = 0; z < 3; ++z) m.R.c[z] = along_joint(link.joint, motion, m.p_ang.c[z], m.p_lin.c[z]);
  const bool is_single = speed_count(link.joint) == 1;
  m.DR = is_single ? m.R * factor.d_inv : factor.D_inv * m.R;
  if (is_single) {
    for (int z = 0; z < 3; ++z) {
      m.p_ang.c[z] -= factor.U_ang.c[0] * m.DR.c[z][0];
      m.p_lin.c[z] -= factor.U_lin.c[0] * m.DR.c[z][0];
    }
  } else {
    m.p_ang -= factor.U_ang * m.DR;
    m.p_lin -= factor.U_lin * m.DR;
  }
  m.h += transpose_multiply(m.DR, of_joint(link, residual));
  m.p_ang += skew(motion.r) * m.p_lin;
}

// p from the origin of P to that of F, and along its modes
void carry_to_frame(const Model& model, const Workspace& ws, const NodeDummy& dummy, NodeDummyMotion& m) noexcept {
  const bool rides = dummy.carrier != dummy.frame;
  for (std::size_t k = 0; k < m.g.size(); ++k) {
    const NodeMotion* node = rides ? &node_of(model, ws, dummy.carrier) : nullptr;
    m.g[k] = rides ? transpose_multiply(m.p_ang, node->Psi[k]) + transpose_multiply(m.p_lin, node->Phi[k]) : Vec3();
  }
  if (rides) m.p_ang += skew(ws.motion[at(dummy.carrier)].r) * m.p_lin;
}

// half of Z of (6) with another dummy j across the same joint
void add_between(const NodeDummyMotion& j, bool is_same_part, NodeDummyMotion& m) noexcept {
  Mat3 half = transpose(j.R) * m.DR * -0.5;
  if (is_same_part) {
    for (std::size_t k = 0; k < m.X.size(); ++k) half -= outer(j.X[k] * 0.5, m.X[k]);
  }
  m.p_lin += half;
  m.p_ang += skew(j.arm) * half;
  for (std::size_t k = 0; k < m.g.size(); ++k) m.g[k] += transpose_multiply(half, j.y[k]);
}

// (6)
void add_to_frame(const NodeDummy& dummy, const NodeDummyMotion& m, Workspace& ws) noexcept {
  ArticulatedInertia& I = ws.inertia[at(dummy.frame)];
  const Mat3 turn = times_skew(m.p_ang, m.arm);
  I.J -= turn + transpose(turn);
  I.K += transpose(m.p_ang) - times_skew(m.p_lin, m.arm);
  I.M += m.p_lin + transpose(m.p_lin);
  I.n += cross(m.arm, m.h);
  I.f += m.h;
  if (dummy.inner_part < 0) return;
  PartMotion& part = ws.parts[at(dummy.inner_part)];
  const std::size_t n = m.y.size();
  for (std::size_t k = 0; k < n; ++k) {
    part.B_lin[k] += m.p_lin * m.y[k] + m.g[k];
    part.B_ang[k] += m.p_ang * m.y[k] + cross(m.arm, m.g[k]);
    part.bias[k] += dot(m.y[k], m.h);
    for (std::size_t l = 0; l <= k; ++l) part.E[k * n + l] += dot(m.y[k], m.g[l]) + dot(m.g[k], m.y[l]);
  }
}

}  // namespace

void add_node_dummies(Model& model, std::size_t first) {
  std::vector<int> parent;
  std::vector<char> is_node;
  for (const Link& link : model.links) {
    parent.push_back(link.parent);
    is_node.push_back(link.node >= 0 ? 1 : 0);
  }
  for (std::size_t i = first; i < model.coupled.size(); ++i) {
    const LineElement& line = model.lines[at(model.coupled[i].line)];
    const std::optional<NodeSpan> span = node_span(line.link1, line.link2, parent, is_node);
    SLEW_CHECK(span.has_value());
    NodeDummy dummy{.mass = static_cast<int>(i),
                    .child = span->inner > 0 ? span->child : 0,
                    .outer = span->outer,
                    .inner = span->inner,
                    .carrier = span->carrier,
                    .frame = span->frame};
    dummy.is_point1_outer = span->outer == line.link1;
    if (span->child > 0 && span->outer != span->child) dummy.outer_part = part_of(model, span->outer);
    if (span->carrier != span->frame) dummy.inner_part = part_of(model, span->carrier);
    if (span->inner != span->frame) dummy.inner_part = part_of(model, span->inner);
    model.node_dummies.push_back(dummy);
  }
  std::vector<NodeDummy>& list = model.node_dummies;
  std::stable_sort(list.begin(), list.end(), [](const NodeDummy& a, const NodeDummy& b) { return a.child < b.child; });
  for (std::size_t i = 0; i < list.size(); ++i) {
    model.coupled[at(list[i].mass)].child = list[i].child;
    if (list[i].child == 0) continue;
    Link& link = model.links[at(list[i].child)];
    if (!link.has_node_dummies()) link.first_node_dummy = static_cast<int>(i);
    link.node_dummy_end = static_cast<int>(i) + 1;
  }
  // (6) couples dummies across one joint along the modes of all
  for (const Link& link : model.links) {
    int part = -1;
    for (int i = link.first_node_dummy; i < link.node_dummy_end; ++i) part = std::max(part, list[at(i)].inner_part);
    for (int i = link.first_node_dummy; i < link.node_dummy_end; ++i) list[at(i)].inner_part = part;
  }
}

void begin_node_dummies(const Model& model, Workspace& ws) noexcept {
  for (std::size_t i = 0; i < model.node_dummies.size(); ++i) {
    const NodeDummy& dummy = model.node_dummies[i];
    NodeDummyMotion& m = ws.node_dummies[i];
    const Ends ends = ends_of(model, ws, dummy);
    const auto add = [&](int link, const Mat3& A, Vec3 P, Vec3 F) {
      if (link > 0) add_point(A, P - ws.motion[at(link)].p, F, ws.inertia[at(link)]);
    };
    add(dummy.outer, ends.A_BB, ends.P_B, ends.F_B);
    add(dummy.inner, ends.A_AA, ends.P_A, ends.F_A);
    see_inner(model, ws, dummy, ends.P_A, m);
    if (dummy.carrier != dummy.outer) continue;
    see_outer(model, ws, dummy, ends, dummy.outer, m);
    carry_to_frame(model, ws, dummy, m);
    add_to_frame(dummy, m, ws);
  }
}

void couple_node_dummies(const Model& model, std::size_t index, Workspace& ws) noexcept {
  const Link& link = model.links[index];
  const std::size_t first = at(link.first_node_dummy), end = at(link.node_dummy_end);
  for (std::size_t i = first; i < end; ++i) {
    const NodeDummy& dummy = model.node_dummies[i];
    NodeDummyMotion& m = ws.node_dummies[i];
    see_outer(model, ws, dummy, ends_of(model, ws, dummy), dummy.child, m);
    eliminate_outer_modes(model, ws, dummy, m);
    // a node has no coordinates
    if (link.joint != LinkJoint::node) eliminate_joint(link, ws.motion[index], ws.factor[index], ws.residual, m);
    carry_to_frame(model, ws, dummy, m);
  }
  for (std::size_t i = first; i < end; ++i) {
    const NodeDummy& dummy = model.node_dummies[i];
    for (std::size_t j = first; j < end; ++j) {
      const int part = dummy.outer_part;
      add_between(ws.node_dummies[j], part >= 0 && part == model.node_dummies[j].outer_part, ws.node_dummies[i]);
    }
    add_to_frame(dummy, ws.node_dummies[i], ws);
  }
}

namespace {

// z' with the motion of the frame and of the modes computed so far
Vec3 point_of(const Model& model, const NodeDummy& dummy, const NodeDummyMotion& m, std::span<const double> udot,
              const Workspace& ws) noexcept {
  Vec3 z = ws.delta_a[at(dummy.frame)] + cross(ws.delta_alpha[at(dummy.frame)], m.arm);
  if (dummy.inner_part < 0) return z;
  const std::size_t u = at(model.parts[at(dummy.inner_part)].u);
  for (std::size_t k = 0; k < m.y.size(); ++k) z += m.y[k] * udot[u + k];
  return z;
}

}  // namespace

void pull_joint(const Model& model, std::size_t index, std::span<double> udot, Workspace& ws) noexcept {
  const Link& link = model.links[index];
  Vec3 rate;
  for (int i = link.first_node_dummy; i < link.node_dummy_end; ++i) {
    const NodeDummyMotion& m = ws.node_dummies[at(i)];
    rate -= m.DR * point_of(model, model.node_dummies[at(i)], m, udot, ws);
  }
  for (int k = 0; k < speed_count(link.joint); ++k) udot[at(link.u + k)] += rate[k];
  const LinkMotion& motion = ws.motion[index];
  if (link.joint == LinkJoint::revolute) ws.delta_alpha[index] += motion.axis * rate[0];
  if (link.joint == LinkJoint::prismatic) ws.delta_a[index] += motion.axis * rate[0];
  if (link.joint == LinkJoint::spherical) ws.delta_alpha[index] += rate;
  if (speed_count(link.joint) != 2) return;
  const Pair S = directions(link.joint, motion);
  ws.delta_alpha[index] += S.turn[0] * rate[0] + S.turn[1] * rate[1];
  ws.delta_a[index] += S.slide[0] * rate[0] + S.slide[1] * rate[1];
}

void pull_modes(const Model& model, std::size_t index, std::span<double> udot, Workspace& ws) noexcept {
  const Link& link = model.links[index];
  for (int i = link.first_node_dummy; i < link.node_dummy_end; ++i) {
    const NodeDummy& dummy = model.node_dummies[at(i)];
    if (dummy.outer_part < 0) continue;
    NodeDummyMotion& m = ws.node_dummies[at(i)];
    const Vec3 z = point_of(model, dummy, m, udot, ws);
    for (std::size_t k = 0; k < m.X.size(); ++k) m.pull[k] = dot(m.X[k], z);
    return_modes(ws.parts[at(dummy.outer_part)], m.pull);
    const std::size_t u = at(model.parts[at(dummy.outer_part)].u);
    for (std::size_t k = 0; k < m.pull.size(); ++k) udot[u + k] -= m.pull[k];
  }
}

void back_substitute(const Model& model, std::size_t index, const Workspace& ws, std::span<double> residual,
                     std::span<const double> rate, std::span<Vec3> n, std::span<Vec3> f) noexcept {
  const Link& link = model.links[index];
  const Vec3 joint = of_joint(link, rate);
  for (int i = link.first_node_dummy; i < link.node_dummy_end; ++i) {
    const NodeDummy& dummy = model.node_dummies[at(i)];
    const NodeDummyMotion& m = ws.node_dummies[at(i)];
    Vec3 h = transpose_multiply(m.R, joint);
    if (dummy.outer_part >= 0) {
      const std::size_t u = at(model.parts[at(dummy.outer_part)].u);
      for (std::size_t k = 0; k < m.X.size(); ++k) h += m.X[k] * residual[u + k];
    }
    if (dummy.frame > 0) {
      n[at(dummy.frame)] += cross(m.arm, h);
      f[at(dummy.frame)] += h;
    }
    if (dummy.inner_part < 0) continue;
    const std::size_t u = at(model.parts[at(dummy.inner_part)].u);
    for (std::size_t k = 0; k < m.y.size(); ++k) residual[u + k] -= dot(m.y[k], h);
  }
}

}  // namespace slew::multibody
