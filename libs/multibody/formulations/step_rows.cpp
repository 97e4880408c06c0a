// SPDX-License-Identifier: Apache-2.0
#include "multibody/formulations/step_rows.h"

#include <algorithm>
#include <array>

#include "core/index.h"
#include "multibody/constraints/loops.h"
#include "multibody/constraints/rows.h"
#include "multibody/contacts/contact_passes.h"
#include "multibody/contacts/contact_stiffness.h"
#include "multibody/formulations/body_block.h"
#include "multibody/formulations/body_passes.h"
#include "multibody/formulations/dynamics.h"
#include "multibody/formulations/integrators.h"
#include "multibody/formulations/passes.h"

namespace slew::multibody {

using math::Vec3;

namespace {

// A symmetric matrix over the links' speeds times these, block by block.
class SpeedProduct final : public LinkMatrix {
 public:
  SpeedProduct(std::span<const LinkMotion> motion, const math::BlockLdl& ldl, std::span<double> product) noexcept
      : motion_(motion), ldl_(ldl), product_(product) {}

  void add(int row_link, int column_link, const SpatialBlock& block) noexcept override {
    const Six column = speeds(column_link);
    double* y = product_.data() + ldl_.first_row(row_link - 1);
    for (std::size_t r = 0; r < kLinkSpeeds; ++r) {
      for (std::size_t c = 0; c < kLinkSpeeds; ++c) y[r] += block[r * kLinkSpeeds + c] * column[c];
    }
    if (row_link == column_link) return;
    const Six row = speeds(row_link);
    y = product_.data() + ldl_.first_row(column_link - 1);
    for (std::size_t r = 0; r < kLinkSpeeds; ++r) {
      for (std::size_t c = 0; c < kLinkSpeeds; ++c) y[c] += block[r * kLinkSpeeds + c] * row[r];
    }
  }

 private:
  [[nodiscard]] Six speeds(int link) const noexcept {
    const LinkMotion& m = motion_[slew::at(link)];
    return {m.v[0], m.v[1], m.v[2], m.w[0], m.w[1], m.w[2]};
  }

  std::span<const LinkMotion> motion_;
  const math::BlockLdl& ldl_;
  std::span<double> product_;
};

// accelerations in body coordinates: none of a single link
void forget_accelerations(Workspace& ws) noexcept {
  for (std::size_t i = 1; i < ws.motion.size(); ++i) {
    ws.motion[i].alpha = Vec3();
    ws.motion[i].a = ws.motion[0].a;
  }
}

}  // namespace

bool has_springs(const Model& model) noexcept {
  const auto is_active = [](const auto& element) { return element.law.is_active; };
  return !model.parts.empty() || has_slopes(model.elements) || model.contact != nullptr ||
         std::any_of(model.lines.begin(), model.lines.end(), is_active) ||
         std::any_of(model.angles.begin(), model.angles.end(), is_active);
}

StepRows::StepRows(const Model& model)
    : tree_(model),
      body_(build_stiff_body_model(model)),
      ws_(model),
      bws_(model, body_),
      strain_(bws_.solution.size()) {}

bool StepRows::evaluate(const Model& model, const State& state, const Workspace& at, double H,
                        StepShares shares) noexcept {
  std::copy(at.row_is_active.begin(), at.row_is_active.end(), ws_.row_is_active.begin());
  begin_contacts(model, state, ws_);
  set_time(model, state.time, ws_);
  return evaluate_tree(model, state, H, shares) || evaluate_bodies(model, state, H, shares);
}

// False: tree_matrix.h does not cover an element.
bool StepRows::evaluate_tree(const Model& model, const State& state, double H, StepShares shares) noexcept {
  ws_.shares = {shares.position * H * H, shares.rate * H, shares.strain * H};
  find_loads(model, state.q, state.u, ws_);
  const auto fill = [&](ChangeWeights weights, Stiffness which) {
    tree_.clear();
    add_stiffness(model, ws_, weights, tree_, which);
    add_contact_stiffness(model, ws_, weights, tree_);
  };
  fill({.position = ws_.shares.strain, .rate = 0}, Stiffness::of_strain);
  tree_.load_speeds(ws_);
  fill({.position = ws_.shares.position, .rate = ws_.shares.rate}, Stiffness::with_pulls);
  tree_.load_accelerations(ws_);
  if (!tree_.put(ws_)) return false;
  ws_.across = &tree_;
  solve_accelerations(model, ws_);
  ws_.across = nullptr;
  ws_.udot_free = ws_.udot;
  evaluate_rows(model, state, ws_);
  return true;
}

bool StepRows::evaluate_bodies(const Model& model, const State& state, double H, StepShares shares) noexcept {
  ws_.shares = {};
  update_motion(model, state.q, state.u, ws_);
  forget_accelerations(ws_);
  apply_all(model, state.q, ws_);
  evaluate_joints(model, body_, state, ws_, bws_);
  fill_matrix(model, body_, ws_, bws_);
  BodyMatrix matrix(body_, bws_.ldl);
  const ChangeWeights weights{.position = shares.position * H * H, .rate = shares.rate * H};
  add_stiffness(model, ws_, weights, matrix);
  add_contact_stiffness(model, ws_, weights, matrix);
  add_modal_stiffness(model, body_.modal, weights, ws_, bws_.ldl);
  const bool is_regular = bws_.ldl.factorize(kDependent);
  put_bias(model, body_, ws_, bws_);
  subtract_strain(model, shares.strain * H);
  bws_.ldl.solve(bws_.solution);
  bws_.free = bws_.solution;
  find_rows(model, body_, state, ws_, bws_);
  return is_regular;
}

void StepRows::subtract_strain(const Model& model, double H) noexcept {
  std::fill(strain_.begin(), strain_.end(), 0.0);
  SpeedProduct product(ws_.motion, bws_.ldl, strain_);
  const ChangeWeights weights{.position = H, .rate = 0};
  add_stiffness(model, ws_, weights, product, Stiffness::of_strain);
  add_contact_stiffness(model, ws_, weights, product);
  for (const ModalBlock& block : body_.modal) {
    const FlexiblePart& part = model.parts[block.part];
    const std::vector<double>& u = ws_.parts[block.part].u;
    double* y = strain_.data() + bws_.ldl.first_row(block.node);
    for (std::size_t k = 0; k < block.count; ++k) {
      const double* K = part.stiffness.data() + (block.first + k) * part.modes;
      for (std::size_t l = 0; l < part.modes; ++l) y[k] += H * K[l] * u[l];
    }
  }
  for (std::size_t i = 0; i < strain_.size(); ++i) bws_.solution[i] -= strain_[i];
}

}  // namespace slew::multibody
