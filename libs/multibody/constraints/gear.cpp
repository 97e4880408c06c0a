// SPDX-License-Identifier: Apache-2.0
#include "multibody/constraints/gear.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/index.h"
#include "multibody/build/build_rows.h"
#include "multibody/formulations/body_passes.h"
#include "multibody/model/state.h"

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

GearEnd end_of(const Model& model, const std::string& name, double factor) {
  GearEnd end;
  end.joint = find_joint(model, name);
  end.link = model.joints[at(end.joint)].link;
  end.q = model.links[at(end.link)].q;
  end.u = model.links[at(end.link)].u;
  end.factor = factor;
  return end;
}

// The offset that fits the start: the scene's, up to whole turns of joint 2's angle.
double offset_of(const GearDef& def, const Model& model, const std::array<GearEnd, 2>& ends) {
  const double start = model.start_q[at(ends[1].q)] + ends[0].factor * model.start_q[at(ends[0].q)];
  if (!is_given(def.offset)) return start;
  if (def.kind != GearKind::gear) return def.offset;
  constexpr double turn = 2 * std::numbers::pi;
  return def.offset + turn * std::round((start - def.offset) / turn);
}

// coordinate of a revolute or prismatic joint of the tree, an angle the nearest to the one before
double coordinate_of(const Model& model, const Workspace& ws, int moved, double near) noexcept {
  const Link& link = model.links[at(moved)];
  const LinkMotion &parent = ws.motion[at(link.parent)], &child = ws.motion[at(moved)];
  const Mat3 R = parent.R * link.R_PJ;
  if (link.joint == LinkJoint::prismatic) return dot(child.axis, child.p - parent.p - parent.R * link.p_PJ);
  const double angle = std::atan2(dot(R.c[1], child.R.c[0]), dot(R.c[0], child.R.c[0]));
  constexpr double turn = 2 * std::numbers::pi;
  return angle + turn * std::round((near - angle) / turn);
}

}  // namespace

void add_gears(const MechanicsDef& mechanics, Model& model) {
  for (const GearDef& def : mechanics.gears) {
    Gear gear;
    gear.name = def.name;
    gear.kind = def.kind;
    gear.ends = {end_of(model, def.joint1, -def.ratio), end_of(model, def.joint2, 1)};
    gear.offset = offset_of(def, model, gear.ends);
    add_supports(model, gear);
    model.gears.push_back(std::move(gear));
  }
}

RowValue gear_value(const Gear& gear, const Model& model, std::span<const double> q, std::span<const double> u,
                    const Workspace& ws) noexcept {
  RowValue row;
  row.g = -gear.offset;
  for (const GearEnd& end : gear.ends) {
    row.g += end.factor * q[at(end.q)];
    row.rate += end.factor * u[at(end.u)];
    const int drive = model.links[at(end.link)].drive[0];
    if (drive >= 0) row.bias += end.factor * ws.drives[at(drive)].acceleration;
  }
  return row;
}

GearRow gear_row(const Model& model, const BodyModel& body, const State& near, const Gear& gear,
                 const Workspace& ws) noexcept {
  GearRow row;
  row.g = -gear.offset;
  for (std::size_t k = 0; k < 2; ++k) {
    const GearEnd& end = gear.ends[k];
    const BodyRow own =
        body_row(model, body, near, {.kind = RowKind::joint, .element = end.joint, .link = end.link}, ws);
    row.links[2 * k] = own.link1;
    row.links[2 * k + 1] = own.link2;
    row.v[2 * k] = own.J.v1 * end.factor;
    row.w[2 * k] = own.J.w1 * end.factor;
    row.v[2 * k + 1] = own.J.v2 * end.factor;
    row.w[2 * k + 1] = own.J.w2 * end.factor;
    row.g += end.factor * coordinate_of(model, ws, end.link, near.q[at(end.q)]);
    row.bias += end.factor * own.bias;
  }
  for_each_end(row, [&](int link, Vec3 v, Vec3 w) {
    row.rate += dot(v, ws.motion[at(link)].v) + dot(w, ws.motion[at(link)].w);
  });
  return row;
}

double gear_force(const Model& model, const Workspace& ws, std::size_t gear, std::size_t end) noexcept {
  return model.gears[gear].ends[end].factor * ws.gear_force[gear];
}

std::vector<int> links_of(const Model& model, const Gear& gear) {
  std::vector<int> links;
  for (const GearEnd& end : gear.ends) {
    for (const int link : {model.links[at(end.link)].parent, end.link}) {
      if (link > 0 && std::find(links.begin(), links.end(), link) == links.end()) links.push_back(link);
    }
  }
  return links;
}

}  // namespace slew::multibody
