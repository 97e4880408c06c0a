// SPDX-License-Identifier: Apache-2.0
#include "multibody/formulations/singularity.h"

#include <cmath>
#include <cstddef>
#include <span>
#include <string>

#include "multibody/flexible/deflection.h"
#include "multibody/formulations/dynamics.h"

namespace slew::multibody {
namespace {

// a real part has at least 1e-9 of its largest inertia about any axis; rounding leaves 1e-16
constexpr double kSmallestShare = 1e-12;

bool is_singular(const Link& link, const Workspace& ws, std::size_t i) {
  const ArticulatedInertia& I = ws.inertia[i];
  const JointFactor& factor = ws.factor[i];
  const double turning = I.J(0, 0) + I.J(1, 1) + I.J(2, 2);
  // a singular joint further out corrupts the inertia it passes on: name that joint
  if (!std::isfinite(turning)) return false;
  switch (link.joint) {
    case LinkJoint::revolute:
      return !(1 / factor.d_inv > kSmallestShare * turning);
    case LinkJoint::prismatic:
      return !(1 / factor.d_inv > 0);
    case LinkJoint::spherical:
    case LinkJoint::floating:
    case LinkJoint::universal:
    case LinkJoint::cylindrical:
      break;
    case LinkJoint::node:
      return false;
  }
  // the largest element of the inverse against the size of the inertia
  double largest = 0;
  for (int k = 0; k < 9; ++k) {
    const double element = std::abs(factor.D_inv(k / 3, k % 3));
    if (!std::isfinite(element)) return true;
    largest = std::fmax(largest, element);
  }
  return !(1 / largest > kSmallestShare * turning);
}

// The joint's load has inertia if no flexible body is bent: returns the body with the largest bend.
std::string bent_body(const Model& model, const State& state, std::size_t link, Workspace& ws) {
  State straight = state;
  for_each_mode(model, [&](std::size_t q, std::size_t) { straight.q[q] = 0; });
  forward_dynamics(model, straight.q, straight.u, {}, ws);
  if (is_singular(model.links[link], ws, link)) return "";
  std::string name;
  double furthest = 0;
  for (const FlexiblePart& part : model.parts) {
    const std::span<const double> q(state.q.data() + part.q, part.modes);
    const double share = largest_deflection(*part.source, part.watched, q).size / part.length;
    if (share > furthest) furthest = share, name = part.name;
  }
  return name;
}

}  // namespace

void find_singular_joints(const MechanicsDef& mechanics, Problems& problems) {
  const Model model = build_model(mechanics);
  Workspace ws(model), scratch(model);
  const State state = start_state(model);
  forward_dynamics(model, state.q, state.u, {}, ws);
  for (const Joint& joint : model.joints) {
    const auto link = static_cast<std::size_t>(joint.link);
    if (joint.link == 0 || !is_singular(model.links[link], ws, link)) continue;
    const std::string bent = bent_body(model, state, link, scratch);
    if (!bent.empty()) {
      problems.push_back(
          {bent + ".flex_modes",
           "bent as it is at the start, its modes with their shortening leave no inertia to the joint '" + joint.name +
               "'",
           "fewer modes, less load, files without geometric stiffening, or type segmented", ""});
      continue;
    }
    problems.push_back({joint.name,
                        "the load of this joint has no inertia about one of its free directions",
                        "inertia about every free axis: a point mass must not turn about itself",
                        {}});
  }
}

}  // namespace slew::multibody
