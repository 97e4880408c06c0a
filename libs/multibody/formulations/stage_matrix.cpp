// SPDX-License-Identifier: Apache-2.0
// The left side of an implicit stage: masses, joints, and the stiffness and damping of force elements.
#include <algorithm>
#include <set>

#include "core/index.h"
#include "multibody/constraints/loops.h"
#include "multibody/contacts/contact_stiffness.h"
#include "multibody/forces/element_law.h"
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

void see_stops(const Model& model, const Workspace& ws, std::span<signed char> stops) noexcept {
  const auto side_of = [](const ElementLaw& law, double x, double rate) -> signed char {
    if (!(law.end_spring > 0)) return 0;
    const double force = math::stop_force(x, rate, law.min, law.max, law.end_spring, law.end_damping).force;
    return force > 0 ? -1 : force < 0 ? 1 : 0;
  };
  std::size_t k = 0;
  for (std::size_t i = 0; i < model.lines.size(); ++i) {
    stops[k++] = side_of(model.lines[i].law, ws.lines[i].length, ws.lines[i].rate);
  }
  for (std::size_t i = 0; i < model.angles.size(); ++i) {
    stops[k++] = side_of(model.angles[i].law, ws.angles[i].angle, ws.angles[i].rate);
  }
  for_each_force_kind([&](auto row) {
    if constexpr (decltype(row)::kHasStops) {
      for (const auto& element : elements_of(row, model.elements)) {
        stops[k++] = static_cast<signed char>(row.side_of(element, ws.motion));
      }
    }
  });
  if (model.contact == nullptr) return;
  const std::span<signed char> pairs = stops.subspan(k);
  std::fill(pairs.begin(), pairs.end(), static_cast<signed char>(0));
  const std::span<const contact::ContactPoint> points = ws.contact->set.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const math::Vec3 force = ws.contact->forces[i].normal_W;
    if (dot(force, force) > 0) ++pairs[points[i].pair];
  }
}

std::size_t stop_count(const Model& model) noexcept {
  return model.lines.size() + model.angles.size() + stop_count(model.elements) +
         (model.contact == nullptr ? 0 : model.contact->model.pairs().size());
}

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
  if (at.stages.has_multipliers) add_pulls(at, weights.position, matrix);
  return at.bws.ldl.factorize(kDependent);
}

}  // namespace slew::multibody
