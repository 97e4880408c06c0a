// SPDX-License-Identifier: Apache-2.0
// The left side of an implicit stage: masses, joints, and the stiffness and damping of force elements.
#include <algorithm>
#include <set>

#include "core/index.h"
#include "multibody/constraints/loops.h"
#include "multibody/contacts/contact_stiffness.h"
#include "multibody/formulations/body_block.h"
#include "multibody/formulations/stage_passes.h"

namespace slew::multibody {

using math::Vec3;

namespace {

// A joint's pulling force F at s from a link's origin turns it back: (F . s) across s. A pushing force is omitted, so
// that the matrix stays definite.
void add_pulls(const StageContext& at, double weight, LinkMatrix& matrix) noexcept {
  for (std::size_t i = 1; i < at.body.joints.size(); ++i) {
    const Constraint& joint = at.body.joints[i];
    const double* multipliers =
        at.stages.multipliers.data() + at.bws.ldl.first_row(static_cast<int>(i) - 1) + at.body.row_offset(i);
    Vec3 F1, F2;
    for (std::size_t k = 0; k < joint.rows.size(); ++k) {
      const RowGradient& G = at.bws.rows[slew::at(at.bws.first_row[i]) + k].G;
      F1 -= G.v1 * multipliers[k];
      F2 -= G.v2 * multipliers[k];
    }
    const LinkMotion& link1 = at.ws.motion[slew::at(joint.link1)];
    const Vec3 s1 = joint.node < 0 ? link1.R * joint.p_L1 : at.ws.motion[slew::at(joint.link2)].p - link1.p;
    add_pull(joint.link1, s1, F1, weight, matrix);
    add_pull(joint.link2, at.ws.motion[slew::at(joint.link2)].R * joint.p_L2, F2, weight, matrix);
  }
}

}  // namespace

BodyModel build_stiff_body_model(const Model& model) {
  BodyModel body = build_body_model(model);
  std::set<std::pair<int, int>> coupled;
  for (const auto& [a, b] : body.pattern.couplings) coupled.insert({std::min(a, b), std::max(a, b)});
  const auto couple = [&](int link1, int link2) {
    if (link1 == 0 || link2 == 0 || link1 == link2) return;
    const std::pair<int, int> nodes(std::min(link1, link2) - 1, std::max(link1, link2) - 1);
    if (coupled.insert(nodes).second) body.pattern.couplings.push_back(nodes);
  };
  for_each_coupling(model, couple);
  return body;
}

bool factorize_stage(const StageContext& at, const Stage& stage) noexcept {
  fill_matrix(at.model, at.body, at.ws, at.bws);
  BodyMatrix matrix(at.body, at.bws.ldl);
  const ChangeWeights weights{.position = stage.tau * stage.sigma, .rate = stage.tau};
  add_stiffness(at.model, at.ws, weights, matrix);
  add_contact_stiffness(at.model, at.ws, weights, matrix);
  add_modal_stiffness(at.model, at.body.modal, weights, at.ws, at.bws.ldl);
  if (at.stages.has_pulls) add_pulls(at, weights.position, matrix);
  return at.bws.ldl.factorize(kDependent);
}

}  // namespace slew::multibody
