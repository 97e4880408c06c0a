// SPDX-License-Identifier: Apache-2.0
#include "monolith/scene_equations.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "coupling/static_forces.h"
#include "multibody/constraints/loops.h"
#include "multibody/constraints/rows.h"
#include "multibody/formulations/passes.h"
#include "multibody/model/parameters.h"
#include "scene/ports.h"

namespace slew::monolith {
namespace {

constexpr double kAngleScale = 0.01;           // rad: with 1e-9 an error of about 1e-3 N in a stiff oil spring
constexpr double kLengthScale = 0.01;          // m
constexpr double kMechanismSpeedScale = 0.01;  // rad/s, m/s
constexpr double kWorkScale = 1e3;             // J
constexpr double kImpulseScale = 1e3;          // N s

// first entry of a joint's quaternion in q, or -1
int quaternion_of(const multibody::Link& link) {
  if (link.joint == multibody::LinkJoint::spherical) return link.q;
  if (link.joint == multibody::LinkJoint::floating) return link.q + 3;
  return -1;
}

}  // namespace

SceneEquations::SceneEquations(const scene::Scene& scene)
    : model_(multibody::build_model(scene.mechanics, scene::row_names(scene))),
      state_(multibody::start_state(model_)),
      workspace_(model_),
      levels_(scene::port_levels(scene)),
      row_force_(model_.rows.size()),
      q_rate_(state_.q.size()),
      u_rate_(state_.u.size()),
      port_states_(scene.ports.size()) {
  for (const scene::PortDef& port : scene.ports) {
    ports_.push_back({port.name, port.offset, port.ratio, coupling::LineForceLaw(port.line_force), port.unit});
  }
  u_ = state_.q.size();
  z_ = u_ + state_.u.size();
  p_ = z_ + state_.bristles.size();
  component_ = work_ = p_;
  if (scene.has_hydraulics()) {
    circuit_ = std::make_unique<hydraulics::Circuit>(scene.hydraulics);
    const auto states = static_cast<std::size_t>(circuit_->state_count());
    component_ = p_ + static_cast<std::size_t>(circuit_->volume_count());
    work_ = component_ + states - static_cast<std::size_t>(circuit_->first_component_state());
    circuit_y_.assign(states, 0);
    circuit_rates_.assign(states, 0);
    observed_y_.assign(states, 0);
    start_ = scene.hydraulics.start;
    SLEW_CHECK(static_cast<std::size_t>(circuit_->actuator_count()) == ports_.size());
  }
  F_.assign(ports_.size(), 0);
  impulse_ = work_ + ports_.size();
  size_ = impulse_ + ports_.size();
  for (const scene::InputDef& input : scene.inputs) {
    control_of_channel_.push_back(circuit_ ? circuit_->find_control(input.primitive) : -1);
    load_of_channel_.push_back(multibody::find_load(model_.elements, input.primitive));
  }
  control_.assign(scene.inputs.size(), 0);
  control_slope_.assign(scene.inputs.size(), 0);
  list_variables();
}

std::vector<double> SceneEquations::absolute_scales() const {
  std::vector<double> scale(size_, kAngleScale);
  for (std::size_t i = 1; i < model_.links.size(); ++i) {
    const multibody::Link& link = model_.links[i];
    const auto q = static_cast<std::ptrdiff_t>(link.q);
    if (link.joint == multibody::LinkJoint::prismatic) scale[static_cast<std::size_t>(q)] = kLengthScale;
    if (link.joint == multibody::LinkJoint::floating) std::fill_n(scale.begin() + q, 3, kLengthScale);
  }
  std::fill(scale.begin() + static_cast<std::ptrdiff_t>(u_), scale.begin() + static_cast<std::ptrdiff_t>(z_),
            kMechanismSpeedScale);
  // scale of bristles: the bending at which they slide
  for (std::size_t k = 0; k < state_.bristles.size(); ++k) {
    if (k < ports_.size()) continue;
    const multibody::JointLaw& law = multibody::law_of(model_, k);
    if (multibody::has_bristles(law)) scale[z_ + k] = law.breakaway_ratio * law.coulomb / law.bristle_stiffness;
  }
  if (circuit_) {
    const std::vector<double>& of_circuit = circuit_->scales();
    const auto volumes = static_cast<std::ptrdiff_t>(component_ - p_);
    std::copy_n(of_circuit.begin(), volumes, scale.begin() + static_cast<std::ptrdiff_t>(p_));
    std::copy(of_circuit.begin() + circuit_->first_component_state(), of_circuit.end(),
              scale.begin() + static_cast<std::ptrdiff_t>(component_));
  }
  std::fill(scale.begin() + static_cast<std::ptrdiff_t>(work_), scale.begin() + static_cast<std::ptrdiff_t>(impulse_),
            kWorkScale);
  std::fill(scale.begin() + static_cast<std::ptrdiff_t>(impulse_), scale.end(), kImpulseScale);
  return scale;
}

std::string SceneEquations::state_name(std::size_t index) const {
  if (index >= impulse_) return "the impulse of " + ports_[index - impulse_].name;
  if (index >= work_) return "the work of " + ports_[index - work_].name;
  if (index >= component_) return "a state of " + circuit_->state_owner(static_cast<int>(index - component_));
  if (index >= p_) return "the pressure of " + circuit_->volume_name(static_cast<int>(index - p_));
  if (index >= z_) return "the bristles of " + model_.rows[index - z_].name;
  return (index < u_ ? "the position of " : "the speed of ") +
         std::string(multibody::joint_of(model_, static_cast<int>(index)));
}

StateOwner SceneEquations::owner(std::size_t index) const {
  using enum StateOwner::Kind;
  if (index >= work_) return {port, ports_[(index - work_) % ports_.size()].name};
  if (index >= component_) return {component, circuit_->state_owner(static_cast<int>(index - component_))};
  if (index >= p_) return {volume, circuit_->volume_name(static_cast<int>(index - p_))};
  if (index >= z_) return {joint, model_.rows[index - z_].name};
  for (const multibody::FlexiblePart& part : model_.parts) {
    const std::size_t first = index < u_ ? static_cast<std::size_t>(part.q) : u_ + static_cast<std::size_t>(part.u);
    if (index >= first && index < first + part.modes)
      return {mode, "mode " + std::to_string(index - first + 1) + " of " + part.name};
  }
  return {joint, std::string(multibody::joint_of(model_, static_cast<int>(index)))};
}

bool SceneEquations::is_held(std::size_t index) const noexcept {
  if (index >= work_) return true;
  if (index >= component_) return false;
  if (index >= p_) return circuit_->is_fixed(static_cast<int>(index - p_));
  if (index >= z_) return index - z_ < ports_.size() || !multibody::has_bristles(model_.rows[index - z_].law);
  for (const multibody::Link& link : model_.links) {
    if (!link.is_driven) continue;
    const std::size_t first = index < u_ ? static_cast<std::size_t>(link.q) : u_ + static_cast<std::size_t>(link.u);
    if (index >= first && index < first + link.drive.size() && link.drive[index - first] >= 0) return true;
  }
  return false;
}

void SceneEquations::take(const multibody::Model& model, const multibody::State& state,
                          const hydraulics::Circuit* circuit, std::span<const double> circuit_y, std::span<double> y) {
  SLEW_CHECK(y.size() == size_ && (circuit == nullptr) == (circuit_ == nullptr));
  SLEW_CHECK(state.q.size() == state_.q.size() && state.u.size() == state_.u.size());
  model_ = model;
  multibody::copy_state(state, state_);
  std::fill(y.begin(), y.end(), 0.0);
  std::copy(state.q.begin(), state.q.end(), y.begin());
  std::copy(state.u.begin(), state.u.end(), y.begin() + static_cast<std::ptrdiff_t>(u_));
  std::copy(state.bristles.begin(), state.bristles.end(), y.begin() + static_cast<std::ptrdiff_t>(z_));
  if (circuit == nullptr) return;
  for (std::size_t i = 0; i < circuit->parameters().size(); ++i) {
    circuit_->set_parameter(static_cast<int>(i), circuit->parameter_values()[i]);
  }
  circuit_->set_vapour_capacities(circuit->vapour_capacities());
  if (circuit_->has_temperatures()) circuit_->set_temperatures(circuit->temperatures(), circuit_y.data());
  std::copy_n(circuit_y.begin(), component_ - p_, y.begin() + static_cast<std::ptrdiff_t>(p_));
  std::copy(circuit_y.begin() + circuit_->first_component_state(), circuit_y.end(),
            y.begin() + static_cast<std::ptrdiff_t>(component_));
}

void SceneEquations::neglect_dry_friction() {
  for (Port& port : ports_) {
    coupling::LineForceDef def = port.law.def();
    def.friction_curve.clear();
    def.efficiency = 1;
    def.seal_friction = 0;
    def.breakaway_friction = 0;
    port.law = coupling::LineForceLaw(def);
  }
  for (multibody::Row& row : model_.rows) row.law.coulomb = row.law.bristle_stiffness = 0;
}

std::string SceneEquations::touching_pair() const {
  if (workspace_.contact == nullptr || workspace_.contact->force_count == 0) return {};
  return model_.contact->pairs[static_cast<std::size_t>(workspace_.contact->forces[0].pair)].name;
}

// ---- start and changes ----------------------------------------------------------------------------------------

// line forces that would hold the ports where they are, joint laws included: W F = -(a_free + W_ar f_r)
Status SceneEquations::find_static_forces(std::span<double> F, std::vector<double>& mobility) {
  const std::size_t m = ports_.size(), rows = model_.rows.size();
  multibody::evaluate(model_, state_, workspace_);
  const std::span<const double> W = multibody::row_mobility(workspace_);
  mobility.resize(m * m);
  std::vector<double> a_free(m);
  for (std::size_t i = 0; i < m; ++i) {
    double a = workspace_.row_a_free[i];
    for (std::size_t r = m; r < rows; ++r) {
      a += W[i * rows + r] *
           multibody::joint_force(model_, r, workspace_.row_x, workspace_.row_v, 0, bristle_of(r)).force;
    }
    a_free[i] = ports_[i].ratio * a;
    for (std::size_t j = 0; j < m; ++j) mobility[i * m + j] = ports_[i].ratio * W[i * rows + j] * ports_[j].ratio;
  }
  if (coupling::static_forces(mobility, a_free, F)) return Status::ok();
  return Status::error(ExitCode::failed, std::string(coupling::kNoStaticForces));
}

Status SceneEquations::start(std::span<double> y) {
  SLEW_CHECK(y.size() == size_);
  state_ = multibody::start_state(model_);
  std::fill(y.begin(), y.end(), 0.0);
  std::copy(state_.q.begin(), state_.q.end(), y.begin());
  std::copy(state_.u.begin(), state_.u.end(), y.begin() + static_cast<std::ptrdiff_t>(u_));
  std::copy(state_.bristles.begin(), state_.bristles.end(), y.begin() + static_cast<std::ptrdiff_t>(z_));
  std::fill(control_.begin(), control_.end(), 0.0);
  std::fill(control_slope_.begin(), control_slope_.end(), 0.0);
  if (circuit_ == nullptr) return Status::ok();
  std::fill(F_.begin(), F_.end(), 0.0);
  std::vector<double> mobility;
  if (start_ == hydraulics::StartState::equilibrium) {
    if (const Status status = find_static_forces(F_, mobility); !status.is_ok()) return status;
  }
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    const auto position = static_cast<std::size_t>(circuit_->position(static_cast<int>(i)));
    circuit_y_[position] = ports_[i].offset + ports_[i].ratio * workspace_.row_x[i];
  }
  circuit_->start(F_, circuit_y_, mobility);
  if (circuit_->has_temperatures()) circuit_->start_heat(circuit_y_.data());
  std::copy_n(circuit_y_.begin(), component_ - p_, y.begin() + static_cast<std::ptrdiff_t>(p_));
  std::copy(circuit_y_.begin() + circuit_->first_component_state(), circuit_y_.end(),
            y.begin() + static_cast<std::ptrdiff_t>(component_));
  return Status::ok();
}

void SceneEquations::set_controls(double t_0, std::span<const double> controls, std::span<const double> slopes) {
  SLEW_CHECK(controls.size() == control_.size() && slopes.size() == control_.size());
  control_time_ = t_0;
  std::copy(controls.begin(), controls.end(), control_.begin());
  std::copy(slopes.begin(), slopes.end(), control_slope_.begin());
}

Status SceneEquations::set_parameter(std::string_view path, double value) {
  if (const auto parameter = multibody::find_parameter(model_, path)) {
    multibody::set_parameter(model_, *parameter, value);
    return Status::ok();
  }
  if (circuit_) {
    const int index = circuit_->find_parameter(path);
    if (index >= 0 && circuit_->set_parameter(index, value) == hydraulics::ParameterResult::ok) return Status::ok();
    if (index >= 0) return Status::error(ExitCode::bad_input, std::string(path) + ": the value is out of its range");
  }
  // settings of the split have no effect on the undivided machine
  if (levels_.change(path, value)) return Status::ok();
  return Status::error(ExitCode::bad_input, std::string(path) + ": there is no live parameter of this name");
}

std::optional<double> SceneEquations::parameter(std::string_view path) const {
  if (const auto found = multibody::find_parameter(model_, path)) return multibody::get_parameter(model_, *found);
  if (circuit_ == nullptr) return std::nullopt;
  const int index = circuit_->find_parameter(path);
  if (index < 0) return std::nullopt;
  return *circuit_->parameters()[static_cast<std::size_t>(index)].value;
}

// ---- equations ------------------------------------------------------------------------------------------------

void SceneEquations::normalize(std::span<double> y) const noexcept {
  for (std::size_t i = 1; i < model_.links.size(); ++i) {
    const int first = quaternion_of(model_.links[i]);
    if (first < 0) continue;
    const auto k = static_cast<std::size_t>(first);
    const math::Quaternion unit = math::normalized({y[k], y[k + 1], y[k + 2], y[k + 3]});
    y[k] = unit.w;
    y[k + 1] = unit.x;
    y[k + 2] = unit.y;
    y[k + 3] = unit.z;
  }
}

void SceneEquations::take_controls(double t) noexcept {
  for (std::size_t i = 0; i < control_.size(); ++i) {
    const double signal = control_[i] + (t - control_time_) * control_slope_[i];
    if (load_of_channel_[i] >= 0) model_.elements.loads[static_cast<std::size_t>(load_of_channel_[i])].signal = signal;
    if (control_of_channel_[i] >= 0) circuit_->set_control(control_of_channel_[i], signal);
  }
}

void SceneEquations::take_state(double t, const double* y) noexcept {
  std::copy_n(y, state_.q.size(), state_.q.begin());
  normalize(state_.q);
  std::copy_n(y + u_, state_.u.size(), state_.u.begin());
  std::copy_n(y + z_, state_.bristles.size(), state_.bristles.begin());
  state_.time = t;
  take_controls(t);
  multibody::set_time(model_, t, workspace_);
  multibody::impose_positions(model_, workspace_, state_.q);
  multibody::impose_speeds(model_, workspace_, state_.u);
  if (has_loops()) {
    multibody::renew_matrix(model_, state_.q, state_.u, workspace_);
    is_closed_ = multibody::project(model_, state_.q, state_.u, workspace_);
  }
  multibody::evaluate(model_, state_, workspace_);
  if (circuit_ == nullptr) return;
  std::copy_n(y + p_, component_ - p_, circuit_y_.begin());
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    const int actuator = static_cast<int>(i);
    const Port& port = ports_[i];
    circuit_y_[static_cast<std::size_t>(circuit_->position(actuator))] = port.offset + port.ratio * workspace_.row_x[i];
    circuit_y_[static_cast<std::size_t>(circuit_->speed(actuator))] = port.ratio * workspace_.row_v[i];
  }
  std::copy_n(y + component_, work_ - component_, circuit_y_.begin() + circuit_->first_component_state());
}

bool SceneEquations::close(double t, std::span<double> y) noexcept {
  take_state(t, y.data());
  std::copy(state_.q.begin(), state_.q.end(), y.begin());
  std::copy(state_.u.begin(), state_.u.end(), y.begin() + static_cast<std::ptrdiff_t>(u_));
  return is_closed_;
}

// (3), (4)
void SceneEquations::evaluate_ports() noexcept {
  if (row_forces_ == RowForces::held) return;
  if (circuit_) circuit_->pressure_forces(circuit_y_.data(), F_.data());
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    const Port& port = ports_[i];
    PortState& now = port_states_[i];
    now.x = port.offset + port.ratio * workspace_.row_x[i];
    now.v = port.ratio * workspace_.row_v[i];
    now.F = F_[i];
    now.line_force = port.law.evaluate(now.F, now.x, now.v).force;
    row_force_[i] = port.ratio * now.line_force;
  }
  for (std::size_t r = ports_.size(); r < model_.rows.size(); ++r) {
    row_force_[r] = multibody::joint_force(model_, r, workspace_.row_x, workspace_.row_v, 0, bristle_of(r)).force;
  }
}

void SceneEquations::rates(double t, const double* y, double* f) noexcept {
  take_state(t, y);
  evaluate_ports();
  // (2)
  multibody::coordinate_rates(model_, workspace_, {y, u_}, state_.u, q_rate_);
  multibody::accelerations(model_, workspace_, row_force_, u_rate_);
  std::copy(q_rate_.begin(), q_rate_.end(), f);
  std::copy(u_rate_.begin(), u_rate_.end(), f + u_);
  // (4); rows of ports have none
  for (std::size_t k = 0; k < state_.bristles.size(); ++k) {
    const bool is_port = k < ports_.size();
    f[z_ + k] = is_port ? 0 : multibody::joint_bristle_rate(model_, k, workspace_.row_v, state_.bristles[k]);
  }
  // (5)
  if (circuit_) {
    circuit_->rates(circuit_y_.data(), circuit_rates_.data());
    std::copy_n(circuit_rates_.begin(), component_ - p_, f + p_);
    std::copy(circuit_rates_.begin() + circuit_->first_component_state(), circuit_rates_.end(), f + component_);
  }
  // (6)
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    f[work_ + i] = port_states_[i].F * port_states_[i].v;
    f[impulse_ + i] = port_states_[i].F;
  }
}

// ---- readings -------------------------------------------------------------------------------------------------

void SceneEquations::observe(double t, const double* y) {
  take_state(t, y);
  if (circuit_) circuit_->follow_vapour(circuit_y_.data());
  if (circuit_ && circuit_->has_temperatures()) take_heat(t);
  evaluate_ports();
  const std::size_t rows = model_.rows.size();
  const std::span<const double> W = multibody::row_mobility(workspace_);
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    PortState& now = port_states_[i];
    double a = workspace_.row_a_free[i];
    for (std::size_t r = 0; r < rows; ++r) a += W[i * rows + r] * row_force_[r];
    now.a = ports_[i].ratio * a;
    now.friction = ports_[i].law.friction(now.F, now.v);
    now.stop = ports_[i].law.stop_force(now.x, now.v);
    now.work = y[work_ + i];
    now.impulse = y[impulse_ + i];
    if (circuit_) circuit_->set_line_force(static_cast<int>(i), now.line_force);
    if (circuit_ && circuit_->has_temperatures()) circuit_->set_friction(static_cast<int>(i), now.friction);
  }
  multibody::observe(model_, state_, workspace_);
}

// Temperatures at t, from the flows at both ends of the interval.
void SceneEquations::take_heat(double t) noexcept {
  if (t > observed_) {
    circuit_->begin_heat(observed_y_.data());
    circuit_->add_heat(t - observed_, circuit_y_.data());
    circuit_->end_heat(t - observed_, circuit_y_.data());
  }
  std::copy(circuit_y_.begin(), circuit_y_.end(), observed_y_.begin());
  observed_ = t;
}

void SceneEquations::list_variables() {
  variables_ = multibody::variables(model_);
  model_variables_ = variables_.size();
  reactions_.resize(model_.joints.size());
  for (ElementVariable& variable : multibody::reaction_variables(model_)) variables_.push_back(std::move(variable));
  reaction_variables_ = variables_.size() - model_variables_;
  for (const Port& port : ports_) {
    const Dimension force = coupling::dimensions_of(port.unit).force;
    variables_.push_back({port.name + ".line_force", force});
    variables_.push_back({port.name + ".friction_force", force});
    variables_.push_back({port.name + ".end_stop_force", force});
    if (port.law.has_cushion()) variables_.push_back({port.name + ".cushion_force", force});
  }
  if (circuit_ == nullptr) return;
  const std::span<const ElementVariable> circuit = circuit_->variables();
  variables_.insert(variables_.end(), circuit.begin(), circuit.end());
}

void SceneEquations::read_variables(std::span<double> values) {
  SLEW_CHECK(values.size() == variables_.size());
  multibody::read_variables(model_, state_, workspace_, row_force_, values.first(model_variables_));
  multibody::joint_reactions(model_, state_, workspace_, row_force_, reactions_);
  multibody::read_reactions(model_, workspace_, row_force_, reactions_,
                            values.subspan(model_variables_, reaction_variables_));
  std::size_t k = model_variables_ + reaction_variables_;
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    const PortState& port = port_states_[i];
    values[k++] = port.line_force;
    values[k++] = port.friction;
    values[k++] = port.stop;
    if (ports_[i].law.has_cushion()) values[k++] = ports_[i].law.cushion_force(port.x, port.v);
  }
  if (circuit_) circuit_->read_variables(circuit_y_.data(), values.subspan(k));
}

}  // namespace slew::monolith
