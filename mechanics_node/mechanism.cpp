// SPDX-License-Identifier: Apache-2.0
#include "mechanics_node/mechanism.h"

#include <algorithm>
#include <utility>

#include "multibody/results/observe.h"
#include "scene/ports.h"

namespace slew::mechanics_node {
namespace {

// format of a snapshot's bytes, which stay in this process
constexpr StateFormat kSnapshot{};

}  // namespace

Mechanism::Mechanism(const scene::Scene& scene, multibody::MechanicsDef def)
    : def_(std::move(def)),
      row_names_(scene::row_names(scene)),
      model_(multibody::build_model(def_, row_names_)),
      state_(multibody::start_state(model_)),
      dynamics_(def_.formulation, model_, state_, multibody::step_rule(def_)),
      workspace_(model_) {
  for (std::size_t i = 0; i < scene.inputs.size(); ++i) {
    const int load = multibody::find_load(model_.elements, scene.inputs[i].primitive);
    if (load >= 0) operated_.push_back({i, static_cast<std::size_t>(load)});
  }
  set_signals({});
}

void Mechanism::reset() {
  model_ = multibody::build_model(def_, row_names_);
  state_ = multibody::start_state(model_);
  dynamics_ = multibody::Dynamics(def_.formulation, model_, state_, multibody::step_rule(def_));
  workspace_ = multibody::Workspace(model_);
  set_signals({});
  mark_changed();
}

void Mechanism::set_row_active(std::size_t row, bool is_active) noexcept {
  if (is_active) {
    multibody::activate_row(workspace_, static_cast<int>(row));
  } else {
    multibody::deactivate_row(workspace_, static_cast<int>(row));
  }
  mark_changed();
}

bool Mechanism::set_signals(std::span<const double> controls) noexcept {
  bool has_changed = false;
  for (const OperatedLoad& operated : operated_) {
    const double signal = operated.channel < controls.size() ? controls[operated.channel] : 0.0;
    double& present = model_.elements.loads[operated.load].signal;
    if (present == signal) continue;
    present = signal;
    has_changed = true;
  }
  if (has_changed) mark_changed();
  return has_changed;
}

void Mechanism::free_accelerations_at(double time, std::span<double> a_free) noexcept {
  const double now = std::exchange(state_.time, time);
  dynamics_.evaluate(model_, state_, workspace_);
  std::copy(workspace_.row_a_free.begin(), workspace_.row_a_free.end(), a_free.begin());
  state_.time = now;
  mark_changed();
}

bool Mechanism::advance(double h, std::span<const double> mean, std::span<const double> slope,
                        multibody::RowHold* hold) noexcept {
  mark_changed();
  workspace_.hold = hold;
  const bool is_sound = dynamics_.advance(model_, state_, workspace_, h, mean, slope);
  workspace_.hold = nullptr;
  return is_sound;
}

void Mechanism::observe() noexcept {
  // evaluate() leaves it so, but for prescribed motions at a time that was set since
  const bool is_at_time = workspace_.time == state_.time;
  workspace_.time = state_.time;
  if (def_.formulation == multibody::Formulation::recursive && (is_at_time || model_.drives.empty())) return;
  multibody::observe(model_, state_, workspace_);
  is_observed_ = true;
}

const multibody::Workspace& Mechanism::observed() const noexcept {
  if (!is_observed_) multibody::observe_elements(model_, state_, workspace_);
  is_observed_ = true;
  return workspace_;
}

void Mechanism::show(const multibody::State& state) noexcept {
  multibody::copy_state(state, state_);
  multibody::evaluate(model_, state_, workspace_);
  is_evaluated_ = true;
  is_observed_ = false;
}

Mechanism::Snapshot Mechanism::snapshot() const {
  Snapshot start{state_, {}};
  keep(start);
  return start;
}

void Mechanism::keep(Snapshot& snapshot) const noexcept {
  multibody::copy_state(state_, snapshot.state);
  // the size never changes: the bytes allocate once only
  snapshot.dynamics.clear();
  StateWriter bytes(snapshot.dynamics, kSnapshot);
  dynamics_.save(bytes);
  bytes.finish();
}

void Mechanism::restore(const Snapshot& snapshot) noexcept {
  multibody::copy_state(snapshot.state, state_);
  StateReader bytes(snapshot.dynamics, kSnapshot);
  dynamics_.load(bytes);
  mark_changed();
}

void Mechanism::add_to(StateHash& hash) const noexcept {
  multibody::add_to_hash(model_, state_, hash);
  dynamics_.add_to_hash(hash);
}

void Mechanism::add_signals_to(StateHash& hash) const noexcept {
  for (const OperatedLoad& operated : operated_) hash.add(model_.elements.loads[operated.load].signal);
}

void Mechanism::save(StateWriter& bytes) const {
  multibody::save(model_, state_, bytes);
  dynamics_.save(bytes);
}

void Mechanism::load(StateReader& bytes) {
  mark_changed();
  multibody::load(model_, state_, bytes);
  dynamics_.load(bytes);
}

}  // namespace slew::mechanics_node
