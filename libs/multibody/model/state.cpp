// SPDX-License-Identifier: Apache-2.0
#include "multibody/model/state.h"

#include <algorithm>
#include <cstddef>
#include <type_traits>

#include "multibody/flexible/elastic_law.h"

namespace slew::multibody {

Workspace::Workspace(const Model& model)
    : motion(model.links.size()),
      inertia(model.links.size()),
      factor(model.links.size()),
      coupled(model.coupled.size()),
      lines(model.lines.size()),
      angles(model.angles.size()),
      delta_alpha(model.links.size()),
      delta_a(model.links.size()),
      pass_n(model.links.size() * kMaxJointRows),
      pass_f(model.links.size() * kMaxJointRows),
      body_n(model.bodies.size()),
      body_f(model.bodies.size()) {
  for (const FlexiblePart& part : model.parts) parts.emplace_back(part.modes);
  for (const FlexibleNode& node : model.nodes) nodes.emplace_back(node.shift.size());
  const auto modes_of = [&](int part) { return part < 0 ? 0 : model.parts[static_cast<std::size_t>(part)].modes; };
  for (const NodeDummy& dummy : model.node_dummies) {
    node_dummies.emplace_back(modes_of(dummy.inner_part), modes_of(dummy.outer_part));
  }
  const auto nq = model.start_q.size(), nu = model.start_u.size(), rows = model.rows.size();
  for (auto* by_u : {&tau, &residual, &udot, &u_stage, &u_sum, &udot_free, &residual_free}) by_u->assign(nu, 0.0);
  for (auto* by_q : {&q_stage, &qdot, &q_sum}) by_q->assign(nq, 0.0);
  for (auto* by_row : {&row_x, &row_v, &row_a_free, &row_force, &row_part}) by_row->assign(rows, 0.0);
  row_J.assign(rows * nu, 0.0);
  row_residual.assign(rows * nu, 0.0);
  row_rate.assign(rows * nu, 0.0);
  row_W.assign(rows * rows, 0.0);
  row_is_active.assign(rows, 1);
  const auto cut_rows = static_cast<std::size_t>(model.closing_row_count());
  loops.rows.resize(cut_rows);
  for (auto* by_row : {&loops.residual, &loops.rate}) by_row->assign(cut_rows * nu, 0.0);
  loops.multipliers.assign(cut_rows, 0.0);
  loops.step.assign(nu, 0.0);
  loops.gear_tau.assign(nu, 0.0);
  gear_force.assign(model.gears.size(), 0.0);
  loops.shown_q.assign(nq, 0.0);
  loops.shown_u.assign(nu, 0.0);
  loops.pattern = ClosingPattern(model);
  loops.factor = math::Semidefinite(loops.pattern.coupled);
  loops.W.assign(static_cast<std::size_t>(loops.factor.entry_count()), 0.0);
  for (ClosingBlock& block : loops.pattern.blocks) {
    const ClosingGroup &group = loops.pattern.groups[static_cast<std::size_t>(block.group)],
                       &other = loops.pattern.groups[static_cast<std::size_t>(block.other)];
    for (int k = 0; k < group.row_count; ++k) {
      block.entries.push_back(loops.factor.entry(group.first_row + k, other.first_row));
    }
  }
  std::size_t redundant = 0;
  for (const Cut& cut : model.cuts) redundant += cut.redundant.size();
  unit_force.resize(redundant * model.joints.size());
  unit_moment.resize(redundant * model.joints.size());
  for (auto* by_u : {&unit_residual, &unit_rate}) by_u->assign(redundant > 0 ? nu : 0, 0.0);
  found_reactions.resize(model.joints.size());
  unit_products.assign(redundant * redundant, 0.0);
  unit_shares.assign(redundant, 0.0);
  unit_factor = math::Semidefinite(static_cast<int>(redundant));
  if (model.contact != nullptr) contact = std::make_unique<ContactWorkspace>(*model.contact);
  motion[0].R = math::Mat3::identity();
  drives.resize(model.drives.size());
  set_time(model, 0, *this);
}

State start_state(const Model& model) {
  State state{.q = model.start_q, .u = model.start_u};
  if (model.contact != nullptr) state.contacts = contact::ContactMemory(model.contact->model);
  const bool any =
      std::any_of(model.rows.begin(), model.rows.end(), [](const Row& row) { return has_bristles(row.law); });
  if (any) state.bristles.assign(model.rows.size(), 0.0);
  return state;
}

void copy_state(const State& from, State& to) noexcept {
  to.q = from.q;
  to.u = from.u;
  to.time = from.time;
  to.bristles = from.bristles;
  to.contacts.assign(from.contacts);
}

namespace {

// live parameters in id order: gravity, masses, laws, elements by `visit_elements`, joints
template <typename AnyModel, typename Visit, typename VisitElements>
void for_each_parameter(AnyModel& model, Visit visit, VisitElements visit_elements) {
  Triple gravity = model.gravity.array();
  for (double& g : gravity) visit(g);
  if constexpr (!std::is_const_v<AnyModel>) model.gravity = math::Vec3(gravity);
  for (auto& part : model.lumped) visit(part.mass);
  const auto visit_law = [&visit](auto& law) {
    for (auto* x : {&law.spring, &law.damping, &law.free, &law.end_spring, &law.end_damping}) visit(*x);
  };
  for (auto& line : model.lines) visit_law(line.law);
  for (auto& angle : model.angles) visit_law(angle.law);
  visit_elements(model.elements);
  for (auto& row : model.rows) {
    auto& law = row.law;
    for (auto* x : {&law.coulomb, &law.viscous, &law.limit_stiffness, &law.limit_damping}) visit(*x);
  }
}

template <typename AnyModel, typename AnyState, typename Bytes>
void visit(AnyModel& model, AnyState& state, Bytes& bytes) {
  bytes.numbers(state.q);
  bytes.numbers(state.u);
  bytes.number(state.time);
  bytes.numbers(state.bristles);
  if constexpr (Bytes::kIsReading) {
    state.contacts.load(bytes);
    for_each_parameter(
        model, [&](double& value) { bytes.number(value); }, [&](ElementSet& set) { load(set, bytes); });
  } else {
    state.contacts.save(bytes);
    for_each_parameter(
        model, [&](double value) { bytes.number(value); }, [&](const ElementSet& set) { save(set, bytes); });
  }
  for (auto& part : model.parts) {
    bytes.numbers(part.stiffness);
    bytes.numbers(part.damping);
    bytes.numbers(part.preload);
    bytes.numbers(part.mass_matrix);
  }
}

}  // namespace

void add_to_hash(const Model& model, const State& state, StateHash& hash) noexcept {
  hash.add(std::span<const double>(state.q));
  hash.add(std::span<const double>(state.u));
  state.contacts.add_to_hash(hash);
  for (const double z : state.bristles) hash.add(z);
  if (depends_on_time(model.elements) || !model.drives.empty()) hash.add(state.time);
  for_each_parameter(
      model, [&](double value) { hash.add(value); }, [&](const ElementSet& set) { add_to_hash(set, hash); });
}

void save(const Model& model, const State& state, StateWriter& bytes) {
  visit(model, state, bytes);
}

void load(Model& model, State& state, StateReader& bytes) {
  visit(model, state, bytes);
  if (!bytes.is_sound()) return;
  lump_links(model);
  mark_used_elements(model);
  for (FlexiblePart& part : model.parts) part.is_diagonal = has_diagonal_law(part);
}

}  // namespace slew::multibody
