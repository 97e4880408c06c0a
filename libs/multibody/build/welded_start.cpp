// SPDX-License-Identifier: Apache-2.0
#include "multibody/build/welded_start.h"

#include <algorithm>
#include <cstddef>
#include <string>

#include "core/index.h"
#include "multibody/flexible/expand_nodes.h"
#include "multibody/formulations/passes.h"
#include "multibody/joints/joint_directions.h"
#include "multibody/model/state.h"

namespace slew::multibody {

using math::Vec3;

namespace {

// the joint that frees a lump, which with_nodes() has named after it; -1: a joint of the scene leads to the lump
int own_joint(const MechanicsDef& expanded, const std::string& lump) {
  for (std::size_t j = 0; j < expanded.joints.size(); ++j) {
    const JointDef& joint = expanded.joints[j];
    if (joint.type == JointType::floating && joint.name == lump && joint.body2 == lump) return static_cast<int>(j);
  }
  return -1;
}

// visit(segmented body, lump) for every lump but the roots
template <typename Visit>
void for_each_lump(const MechanicsDef& expanded, Visit visit) {
  for (const SegmentedBodyDef& segmented : expanded.segmented_bodies) {
    for (std::size_t i = 0; i < segmented.chain->lumps.size(); ++i) {
      if (i != segmented.chain->root) visit(segmented, i);
    }
  }
}

bool follows_its_root(const MechanicsDef& expanded, const std::vector<TreeEdge>& tree) {
  if (!cut_joints(expanded, tree).empty()) return false;
  bool all_are_free = true;
  for_each_lump(expanded, [&](const SegmentedBodyDef& segmented, std::size_t i) {
    all_are_free = all_are_free && own_joint(expanded, lump_name(segmented, i)) >= 0;
  });
  return all_are_free;
}

// All lumps fixed to their roots. Joints keep their numbers.
MechanicsDef welded(const MechanicsDef& expanded) {
  MechanicsDef rigid = expanded;
  for_each_lump(expanded, [&](const SegmentedBodyDef& segmented, std::size_t i) {
    const std::string lump = lump_name(segmented, i);
    const JointDef weld{.name = lump,
                        .type = JointType::fixed,
                        .body1 = segmented.body,
                        .point1 = segmented.chain->lumps[i].station.array(),
                        .body2 = lump};
    const int own = own_joint(expanded, lump);
    if (own >= 0) {
      rigid.joints[at(own)] = weld;
    } else {
      rigid.joints.push_back(weld);
    }
  });
  rigid.segmented_bodies.clear();
  return rigid;
}

// coordinates' speeds between two links in motion
void put_speeds(const Link& link, const LinkMotion& parent, const LinkMotion& m, std::span<double> u) {
  if (link.joint == LinkJoint::node) return;
  if (link.joint == LinkJoint::floating) {
    store(u, link.u, m.v);
    store(u, link.u + 3, m.w);
    return;
  }
  const Vec3 turn = m.w - parent.w, slide = m.v - parent.v - cross(parent.w, m.p - parent.p);
  switch (link.joint) {
    case LinkJoint::revolute:
      u[at(link.u)] = dot(m.axis, turn);
      return;
    case LinkJoint::prismatic:
      u[at(link.u)] = dot(m.axis, slide);
      return;
    case LinkJoint::spherical:
      store(u, link.u, turn);
      return;
    case LinkJoint::cylindrical:
      u[at(link.u)] = dot(m.axis, turn);
      u[at(link.u) + 1] = dot(m.axis, slide);
      return;
    case LinkJoint::universal: {
      // the axes stay at a right angle
      const Pair S = directions(link.joint, m);
      u[at(link.u)] = dot(S.turn[0], turn);
      u[at(link.u) + 1] = dot(S.turn[1], turn);
      return;
    }
    case LinkJoint::node:
    case LinkJoint::floating:
      return;
  }
}

}  // namespace

std::optional<WeldedStart> welded_start(const MechanicsDef& expanded, const std::vector<TreeEdge>& tree) {
  if (expanded.segmented_bodies.empty() || follows_its_root(expanded, tree)) return std::nullopt;
  WeldedStart start;
  const Model model = build_expanded_model(welded(expanded), start.report);
  Workspace ws(model);
  update_motion(model, model.start_q, model.start_u, ws);
  for (const Body& body : model.bodies) {
    const LinkMotion& m = ws.motion[at(body.link)];
    const Vec3 arm = m.R * body.p_LB;
    start.poses.push_back({m.R * body.R_LB, m.p + arm});
    start.v_WB.push_back(m.v + cross(m.w, arm));
    start.w_WB.push_back(m.w);
  }
  for_each_mode(model, [&](std::size_t, std::size_t u) { start.modal_speed.push_back(model.start_u[u]); });
  return start;
}

void take_over(const WeldedStart& welded, Model& model, AssemblyReport& report) {
  Workspace ws(model);
  update_motion(model, model.start_q, std::vector<double>(model.start_u.size()), ws);
  for (std::size_t b = 1; b < model.bodies.size(); ++b) {
    const Body& body = model.bodies[b];
    if (body.link == 0) continue;
    LinkMotion& m = ws.motion[at(body.link)];
    m.w = welded.w_WB[b];
    m.v = welded.v_WB[b] - cross(m.w, m.R * body.p_LB);
  }
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    put_speeds(link, ws.motion[at(link.parent)], ws.motion[i], model.start_u);
  }
  report.speeds = welded.report.speeds;
  report.singular = welded.report.singular;
  if (!welded.report.open.empty()) report.open = welded.report.open;
}

}  // namespace slew::multibody
