// SPDX-License-Identifier: Apache-2.0
#include "multibody/formulations/body_coordinates.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/index.h"
#include "multibody/formulations/body_passes.h"
#include "multibody/formulations/passes.h"
#include "multibody/joints/joint_directions.h"

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

// ---- building -------------------------------------------------------------------------------------------------

namespace {

// couplings of dummies between links that no joint connects
void couple_points(const Model& model, BodyModel& body) {
  std::vector<std::pair<int, int>>& couplings = body.pattern.couplings;
  for (const NodeDummy& dummy : model.node_dummies) {
    if (dummy.inner == 0 || dummy.outer == 0) continue;
    const auto is_same = [&](const std::pair<int, int>& pair) {
      return std::minmax(pair.first, pair.second) == std::minmax(dummy.outer - 1, dummy.inner - 1);
    };
    if (std::any_of(couplings.begin(), couplings.end(), is_same)) continue;
    couplings.emplace_back(std::max(dummy.outer, dummy.inner) - 1, std::min(dummy.outer, dummy.inner) - 1);
  }
}

// Nodes by whose motion the rows of a cut are met: the links of its loop, without the one where its sides meet, and
// the modes that carry them. The fewest neighbours alone would take a cut before the inner links of its loop.
void follow_loops(const Model& model, BodyModel& body) {
  const auto follow = [&](int closing, int link) {
    body.pattern.follows.emplace_back(closing, link - 1);
    if (model.links[at(link)].joint != LinkJoint::node) return;
    const int part = model.nodes[at(model.links[at(link)].node)].part;
    for (const ModalBlock& block : body.modal) {
      if (block.part == at(part)) body.pattern.follows.emplace_back(closing, block.node);
    }
  };
  for (std::size_t i = model.links.size(); i < body.joints.size(); ++i) {
    // links have higher numbers than their parents
    int a = body.joints[i].link1, b = body.joints[i].link2;
    while (a != b) {
      int& outer = a > b ? a : b;
      follow(static_cast<int>(i) - 1, outer);
      outer = model.links[at(outer)].parent;
    }
  }
}

}  // namespace

BodyModel build_body_model(const Model& model) {
  constexpr JointType kTypes[] = {JointType::revolute, JointType::prismatic, JointType::spherical,
                                  JointType::floating, JointType::universal, JointType::cylindrical,
                                  JointType::node};
  BodyModel body;
  body.links = static_cast<int>(model.links.size());
  body.joints.resize(model.links.size());
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    Constraint& joint = body.joints[i];
    joint.link1 = link.parent;
    joint.link2 = static_cast<int>(i);
    joint.node = link.node;
    // the point of a node is itself the frame
    joint.R_L1 = link.node < 0 ? link.R_PJ : Mat3::identity();
    joint.p_L1 = link.node < 0 ? link.p_PJ : Vec3();
    joint.R_L2 = Mat3::identity();
    const JointType type = kTypes[static_cast<std::size_t>(link.joint)];
    joint.rows = rows_of(type, Mat3::identity(), Vec3());
    for (int k = 0; k < 2; ++k) {
      if (link.drive[at(k)] < 0) continue;
      joint.rows.push_back(coordinate_row(type, k));
      joint.rows.back().drive = link.drive[at(k)];
    }
    body.pattern.nodes.push_back({kBody + static_cast<int>(joint.rows.size()), math::BlockKind::regular});
    if (link.parent > 0 && !joint.rows.empty()) {
      body.pattern.couplings.emplace_back(static_cast<int>(i) - 1, link.parent - 1);
    }
  }
  couple_points(model, body);
  for (const Cut& cut : model.cuts) {
    if (cut.rows.empty()) continue;
    const int node = static_cast<int>(body.pattern.nodes.size());
    body.joints.push_back(cut);
    body.pattern.nodes.push_back({static_cast<int>(cut.rows.size()), math::BlockKind::closing});
    for (const int link : {cut.link1, cut.link2}) {
      if (link > 0) body.pattern.couplings.emplace_back(node, link - 1);
    }
  }
  body.first_gear = static_cast<int>(body.pattern.nodes.size());
  for (std::size_t k = 0; k < model.gears.size(); ++k) {
    const int node = body.first_gear + static_cast<int>(k);
    body.pattern.nodes.push_back({1, math::BlockKind::closing});
    for (const int link : links_of(model, model.gears[k])) body.pattern.couplings.emplace_back(node, link - 1);
  }
  body.modal = add_modal_blocks(model, math::BlockKind::regular, body.pattern);
  follow_loops(model, body);
  return body;
}

BodyWorkspace::BodyWorkspace(const Model& model, const BodyModel& body) : ldl(body.pattern) {
  int row = 0;
  for (const Constraint& joint : body.joints) {
    first_row.push_back(row);
    row += static_cast<int>(joint.rows.size());
    first_modal.push_back(static_cast<int>(modal.size()));
    if (joint.node >= 0) modal.resize(modal.size() + joint.rows.size() * model.nodes[at(joint.node)].shift.size());
  }
  rows.resize(at(row) + model.gears.size());
  gears.resize(model.gears.size());
  int cut_row = 0;
  for (std::size_t i = model.links.size(); i < body.joints.size(); ++i) {
    for (int k = 0; k < static_cast<int>(body.joints[i].rows.size()); ++k) {
      ldl.set_reference(static_cast<int>(i) - 1, k, model.cut_reference[at(cut_row++)]);
    }
  }
  for (std::size_t k = 0; k < model.gears.size(); ++k) {
    const double reference = model.cut_reference.empty() ? 0 : model.cut_reference[at(cut_row++)];
    ldl.set_reference(body.first_gear + static_cast<int>(k), 0, reference);
  }
  solution.resize(at(ldl.rows()));
  free.resize(at(ldl.rows()));
  responses.resize(model.rows.size() * at(ldl.rows()));
  const std::size_t links = model.links.size() - 1, modes = mode_count(model);
  for (BodyState* copy : {&stage, &sum}) {
    copy->q.resize(7 * links + modes);
    copy->u.resize(6 * links + modes);
  }
  stage_joints = {model.start_q, model.start_u};
  qdot.resize(7 * links + modes);
  udot.resize(6 * links + modes);
  row_force.resize(model.rows.size());
}

BodyState body_state(const Model& model, const State& state) {
  Workspace ws(model);
  update_motion(model, state.q, state.u, ws);
  BodyState body;
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const LinkMotion& m = ws.motion[i];
    const math::Quaternion attitude = math::quaternion_of(m.R);
    for (const double x : m.p.array()) body.q.push_back(x);
    body.q.insert(body.q.end(), {attitude.w, attitude.x, attitude.y, attitude.z});
    for (const Vec3& part : {m.v, m.w}) {
      for (const double x : part.array()) body.u.push_back(x);
    }
  }
  for_each_mode(model, [&](std::size_t q, std::size_t u) {
    body.q.push_back(state.q[q]);
    body.u.push_back(state.u[u]);
  });
  return body;
}

// ---- coordinates ----------------------------------------------------------------------------------------------

void update_body_motion(const Model& model, const BodyState& state, Workspace& ws) noexcept {
  ws.motion[0].a = -model.gravity;
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    LinkMotion& m = ws.motion[i];
    const std::size_t q = 7 * (i - 1), u = 6 * (i - 1);
    m.p = vector_at(state.q, q);
    m.R = math::rotation_of({state.q[q + 3], state.q[q + 4], state.q[q + 5], state.q[q + 6]});
    m.v = vector_at(state.u, u);
    m.w = vector_at(state.u, u + 3);
    m.r = m.p - ws.motion[at(model.links[i].parent)].p;
    m.axis = m.R.c[2];
    m.alpha = Vec3();
    m.a = ws.motion[0].a;
  }
  if (model.parts.empty()) return;
  const std::size_t links = model.links.size() - 1;
  see_parts(model, std::span(state.q).subspan(7 * links), std::span(state.u).subspan(6 * links), ws);
}

namespace {

// the angle plus whole turns that is nearest to the previous one
double continued(double angle, double before) noexcept {
  constexpr double turn = 2 * std::numbers::pi;
  return angle + turn * std::round((before - angle) / turn);
}

}  // namespace

void find_joint_coordinates(const Model& model, const Workspace& ws, State& state) noexcept {
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    const LinkMotion& parent = ws.motion[at(link.parent)];
    const LinkMotion& child = ws.motion[i];
    double* q = state.q.data() + link.q;
    double* u = state.u.data() + link.u;
    switch (link.joint) {
      case LinkJoint::revolute: {
        const Mat3 R = parent.R * link.R_PJ;
        *q = continued(std::atan2(dot(R.c[1], child.R.c[0]), dot(R.c[0], child.R.c[0])), *q);
        *u = dot(child.axis, child.w - parent.w);
        break;
      }
      case LinkJoint::prismatic: {
        const Vec3 r = child.p - parent.p;
        *q = dot(child.axis, r - parent.R * link.p_PJ);
        *u = dot(child.axis, child.v - parent.v - cross(parent.w, r));
        break;
      }
      case LinkJoint::universal: {
        const Mat3 R = parent.R * link.R_PJ;
        const Vec3 z1 = R.c[2], z2 = child.axis, w = child.w - parent.w;
        q[0] = continued(std::atan2(dot(z2, R.c[1]), dot(z2, R.c[0])), q[0]);
        q[1] = continued(std::atan2(dot(child.R.c[0], z1), dot(child.R.c[0], cross(z1, z2))), q[1]);
        u[0] = dot(z1, w);
        u[1] = dot(z2, w);
        break;
      }
      case LinkJoint::cylindrical: {
        const Mat3 R = parent.R * link.R_PJ;
        const Vec3 r = child.p - parent.p;
        q[0] = continued(std::atan2(dot(R.c[1], child.R.c[0]), dot(R.c[0], child.R.c[0])), q[0]);
        q[1] = dot(child.axis, r - parent.R * link.p_PJ);
        u[0] = dot(child.axis, child.w - parent.w);
        u[1] = dot(child.axis, child.v - parent.v - cross(parent.w, r));
        break;
      }
      case LinkJoint::floating:
        put(child.p, q);
        put(child.v, u);
        q += 3;
        u += 3;
        [[fallthrough]];
      case LinkJoint::spherical: {
        const math::Quaternion attitude = math::quaternion_of(child.R);
        q[0] = attitude.w;
        q[1] = attitude.x;
        q[2] = attitude.y;
        q[3] = attitude.z;
        put(child.w - (link.joint == LinkJoint::spherical ? parent.w : Vec3()), u);
        break;
      }
      case LinkJoint::node:
        break;
    }
  }
  for (std::size_t k = 0; k < model.parts.size(); ++k) {
    const FlexiblePart& part = model.parts[k];
    std::copy(ws.parts[k].q.begin(), ws.parts[k].q.end(), state.q.begin() + part.q);
    std::copy(ws.parts[k].u.begin(), ws.parts[k].u.end(), state.u.begin() + part.u);
  }
}

Drift drift(const BodyWorkspace& bws) noexcept {
  Drift largest;
  for (const RowValue& row : bws.rows) largest.add(row);
  return largest;
}

}  // namespace slew::multibody
