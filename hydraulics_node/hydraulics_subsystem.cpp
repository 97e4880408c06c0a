// SPDX-License-Identifier: Apache-2.0
#include "hydraulics_node/hydraulics_subsystem.h"

#include <algorithm>
#include <array>
#include <string>

#include "core/failure.h"
#include "coupling/indicator.h"
#include "coupling/own_past.h"
#include "coupling/saved_model.h"
#include "coupling/static_forces.h"
#include "hydraulics_node/start_checks.h"
#include "measurement/measuring_subsystem.h"
#include "scene/instruments.h"
#include "scene/ports.h"

namespace slew::hydraulics_node {
namespace {

using coupling::kMaxPorts;

std::vector<coupling::LineForceLaw> laws_of(const scene::Scene& scene) {
  std::vector<coupling::LineForceLaw> laws;
  for (const scene::PortDef& port : scene.ports) laws.emplace_back(port.line_force);
  return laws;
}

constexpr std::size_t kIndicatorVariables = 7;

}  // namespace

HydraulicsSubsystem::HydraulicsSubsystem(const scene::Scene& scene)
    : scene_(scene),
      circuit_(std::make_unique<hydraulics::Circuit>(scene.hydraulics)),
      integrator_(std::make_unique<hydraulics::CircuitIntegrator>(*circuit_, scene.hydraulics)),
      m_(scene.ports.size()),
      H_(scene.session.step_duration()),
      exchange_every_(scene.session.exchange_every),
      is_free_running_(scene.session.mode == scene::ExchangeMode::free_running),
      levels_(scene::port_levels(scene)),
      signals_(scene, *circuit_),
      shared_(*circuit_, scene.hydraulics),
      reduced_(laws_of(scene)),
      springs_(m_),
      emptying_(m_),
      foreseen_(*circuit_, is_free_running_),
      late_samples_(m_, cross_count(), is_free_running_ ? static_cast<std::size_t>(coupling::kRememberedSteps) : 0),
      alarm_(scene),
      convergence_(scene.hydraulics.solver),
      ramps_(circuit_->parameters().size()) {
  coupling::resize(published_, m_);
  stiffness_.resize(m_);
  list_variables();
  saved_model_ = coupling::saved_model(
      variables_, {H_.ns, exchange_every_, is_free_running_, static_cast<int>(scene.hydraulics.solver)});
  // states without K_cross, of earlier programs, do not fit
  if (shared_.any()) saved_model_ += 1;
}

void HydraulicsSubsystem::reset() {
  integrator_.reset();
  circuit_ = std::make_unique<hydraulics::Circuit>(scene_.hydraulics);
  integrator_ = std::make_unique<hydraulics::CircuitIntegrator>(*circuit_, scene_.hydraulics);
  signals_ = ControlSignals(scene_, *circuit_);
  alarm_.reset();
  convergence_.reset();
  ramps_ = coupling::ParameterRamps(circuit_->parameters().size());
  levels_.reset();
  failure_ = StepReport{};
  late_samples_.clear();
  used_step_ = -1;
  partner_age_ = 0;
  foreseen_.reset();
  has_own_ = false;
  coupling::resize(own_, m_);
  coupling::resize(published_, m_);
  stiffness_.resize(m_);
  for (double& K : stiffness_) K = 0;
}

// ---- start ----------------------------------------------------------------------------------------------------

bool HydraulicsSubsystem::first_sample(coupling::OwnSample&) noexcept {
  return false;
}

Status HydraulicsSubsystem::start(const coupling::PartnerSamples& partners, coupling::OwnSample& sample) {
  std::array<double, kMaxPorts> x{}, v{}, F{};
  std::span<const double> W;
  if (m_ > 0) {
    if (partners.mechanism == nullptr || partners.mechanism->x.size() != m_) {
      return Status::error(ExitCode::failed, "mechanics states " +
                                                 std::to_string(partners.mechanism ? partners.mechanism->x.size() : 0) +
                                                 " ports, hydraulics has " + std::to_string(m_) +
                                                 " actuators: the nodes run different scenes");
    }
    const coupling::MechanismSample& mechanism = *partners.mechanism;
    std::copy(mechanism.x.begin(), mechanism.x.end(), x.begin());
    std::copy(mechanism.v.begin(), mechanism.v.end(), v.begin());
    W = mechanism.W.span();
    if (scene_.hydraulics.start == hydraulics::StartState::equilibrium &&
        !coupling::static_forces(W, mechanism.a_free.span(), {F.data(), m_})) {
      return Status::error(ExitCode::failed, std::string(coupling::kNoStaticForces));
    }
    if (scene_.hydraulics.start == hydraulics::StartState::equilibrium) {
      if (Status status = check_pressures(scene_, *circuit_, {F.data(), m_}, W, {x.data(), m_}); !status.is_ok())
        return status;
    }
  }
  integrator_->start({x.data(), m_}, {v.data(), m_}, {F.data(), m_}, W);
  apply_levels();
  integrator_->refresh();
  if (partners.mechanism != nullptr && m_ > 0) reduced_.set_sample(*partners.mechanism);
  publish(sample.actuators, 0, false, true);
  if (m_ > 0 && alarm_.ends_session()) {
    Status status = check_coupling(scene_, partners.mechanism->W, published_, levels_);
    if (!status.is_ok()) return status;
  }
  const hydraulics::ExplicitStability stability = integrator_->explicit_stability(H_.seconds(), reduced_);
  return check_stability(stability, offender_name(stability.owner));
}

// ---- step -----------------------------------------------------------------------------------------------------

void HydraulicsSubsystem::apply_levels() noexcept {
  for (std::size_t i = 0; i < m_; ++i) {
    reduced_.set_level(i, levels_[i]);
    integrator_->set_line(static_cast<int>(i), levels_[i] == coupling::Level::tlm, H_.seconds());
  }
}

// As apply_levels(), of a step that another integrator computes: no chamber is a line, whatever its level.
void HydraulicsSubsystem::lump_lines() noexcept {
  for (std::size_t i = 0; i < m_; ++i) integrator_->set_line(static_cast<int>(i), false, H_.seconds());
}

// The pistons take the positions of a new sample of this step; a late one corrects them.
void HydraulicsSubsystem::align(const coupling::MechanismSample& mechanism, StepIndex age) noexcept {
  if (age == 0) {
    alarm_.update(mechanism, at_instant(), stiffness_, levels_, foreseen_.bends());
    integrator_->align(mechanism.x.span(), mechanism.v.span());
    return;
  }
  late_samples_.align(used_step_, mechanism, *integrator_);
  coupling::ActuatorSample own;
  if (late_samples_.own_sample(used_step_, mechanism, H_.seconds(), own)) {
    alarm_.update(mechanism, own, stiffness_, levels_, foreseen_.bends());
  }
}

// Without a new sample the pistons continue by their own copy of the mechanics.
void HydraulicsSubsystem::take_mechanism(StepIndex n, const coupling::MechanismSample& mechanism, StepIndex age,
                                         StepReport& report) noexcept {
  partner_age_ = age;
  const bool is_new = n - age != used_step_;
  used_step_ = n - age;
  if (is_new) align(mechanism, age);
  // the exchange used the levels of the finished step; the coming step uses the present ones
  apply_levels();
  if (is_new) {
    for (std::size_t i = 0; i < m_; ++i) {
      reduced_.set_thrust(i, published_.F[i] - published_.D[i] * (mechanism.v[i] - published_.v_ref[i]));
    }
    reduced_.set_sample(mechanism);
  }
  if (!is_free_running_) return;
  late_samples_.keep_pistons(n, *circuit_, *integrator_);
  const double late = static_cast<double>(age) * H_.seconds();
  if (age > 0 &&
      coupling::coupling_frequency(mechanism.W, published_.K, late, published_.K_cross) > coupling::kDegradedAbove) {
    report.raise(StepFlag::late_input);
  }
}

StepReport HydraulicsSubsystem::step(StepIndex n, const coupling::PartnerSamples& partners,
                                     std::span<const double> controls, coupling::OwnSample& sample) noexcept {
  if (failure_.has_failed()) {
    sample.actuators = published_;
    return failure_;
  }
  apply_tick(n, controls);
  StepReport taken;
  if (partners.mechanism != nullptr && m_ > 0) take_mechanism(n, *partners.mechanism, partners.mechanism_age, taken);
  StepReport report = integrator_->step(H_.seconds(), reduced_);
  report.flags |= taken.flags;
  alarm_.raise_flags(levels_, report);
  const std::string_view hardened = offender_name(integrator_->beyond_waves());
  if (convergence_.ends_run(report, *integrator_, offender_name(report.offender), hardened) ||
      is_out_of_barrel(integrator_->state().data())) {
    report.raise(StepFlag::ended);
  }
  if (report.has_failed()) {
    failure_ = report;
    sample.actuators = published_;
    return report;
  }
  publish(sample.actuators, report.flags, n % exchange_every_ != 0, (n + 1) % exchange_every_ == 0);
  if (is_free_running_ && m_ > 0) late_samples_.keep_sent(n + 1, published_);
  return report;
}

// Parameters that change over a time, and the controls of the step.
void HydraulicsSubsystem::apply_tick(StepIndex n, std::span<const double> controls) noexcept {
  ramps_.apply(n, [this](int parameter, double value) { circuit_->set_parameter(parameter, value); });
  signals_.set(controls, *circuit_);
}

StepReport HydraulicsSubsystem::follow(StepIndex n, const FollowedCircuit& step,
                                       const coupling::PartnerSamples& partners, std::span<const double> controls,
                                       coupling::OwnSample& sample) noexcept {
  apply_tick(n, controls);
  lump_lines();
  if (partners.mechanism != nullptr && m_ > 0)
    alarm_.update(*partners.mechanism, at_instant(), stiffness_, levels_, foreseen_.bends());
  const bool is_step = n >= 0 && circuit_->has_temperatures();
  if (is_step) circuit_->begin_heat(integrator_->state().data());
  std::copy(step.state.begin(), step.state.end(), integrator_->mutable_state().begin());
  circuit_->set_vapour_capacities(step.vapour);
  // from the flows at both ends of the step
  if (is_step) circuit_->add_heat(H_.seconds(), step.state.data()), circuit_->end_heat(H_.seconds(), step.state.data());
  integrator_->refresh();
  StepReport report;
  report.flags = circuit_->flags(step.state.data());
  report.offender = circuit_->farthest_beyond_oil_law(step.state.data());
  if (report.offender < 0) report.offender = circuit_->first_cavitating(step.state.data());
  const int overdrawn = report.has(StepFlag::cavitating) ? circuit_->first_overdrawn(step.state.data()) : -1;
  if (overdrawn >= 0) report.raise(StepFlag::not_converged), report.offender = overdrawn;
  if (n >= 0 && convergence_.ends_followed_run(overdrawn >= 0, offender_name(overdrawn))) {
    report.raise(StepFlag::ended);
  }
  if (is_out_of_barrel(step.state.data())) report.raise(StepFlag::ended);
  publish(sample.actuators, report.flags, false, false);
  std::copy(step.work.begin(), step.work.end(), sample.actuators.work.begin());
  std::copy(step.impulse.begin(), step.impulse.end(), sample.actuators.impulse.begin());
  published_ = sample.actuators;
  return report;
}

bool HydraulicsSubsystem::is_out_of_barrel(const double* y) noexcept {
  return convergence_.ends_out_of_barrel(
      *circuit_, y, [this](int j) -> std::string_view { return scene_.ports[static_cast<std::size_t>(j)].name; });
}

// adds_up: work and impulse continue those of the sample before, since there was no exchange in between; is_used: the
// mechanics continues from this sample
void HydraulicsSubsystem::publish(coupling::ActuatorSample& sample, std::uint32_t flags, bool adds_up,
                                  bool is_used) noexcept {
  if (sample.F.size() != m_) coupling::resize(sample, m_);
  signals_.foresee(*circuit_, *integrator_);
  const double exchange = exchange_every_ * H_.seconds();
  const std::span<const hydraulics::ActuatorLinearisation> actuators = integrator_->actuators();
  for (std::size_t i = 0; i < m_; ++i) springs_[i] = actuators[i].springs;
  const bool takes_part = integrator_->take_part(exchange, springs_);
  if (is_used) foreseen_.follow(*integrator_, *circuit_, reduced_, levels_, exchange);
  has_own_ = is_used && foreseen_.foresee(*integrator_, reduced_, levels_, exchange, springs_);
  signals_.recall(*circuit_);
  if (!has_own_) emptying_.end_springs(*integrator_, *circuit_, shared_, reduced_, exchange, springs_);
  for (std::size_t i = 0; i < m_; ++i) {
    const hydraulics::ActuatorLinearisation& a = actuators[i];
    const math::RelaxingSpring spring = math::one_for_all(springs_[i], exchange);
    sample.F[i] = a.F;
    sample.F_dot[i] = spring.F_dot;
    sample.K[i] = spring.K;
    sample.lambda[i] = spring.lambda;
    sample.D[i] = a.D;
    stiffness_[i] = a.stiffness;
    sample.x_ref[i] = a.x;
    sample.v_ref[i] = a.v;
    sample.friction_scale[i] = reduced_.law(i).friction_scale(a.F);
    sample.work[i] = a.work + (adds_up ? published_.work[i] : 0.0);
    sample.impulse[i] = a.impulse + (adds_up ? published_.impulse[i] : 0.0);
    sample.p_A[i] = a.p_a;
    sample.p_B[i] = a.p_b;
    sample.Q_A[i] = a.Q_a;
    sample.Q_B[i] = a.Q_b;
    circuit_->set_line_force(static_cast<int>(i), reduced_.law(i).evaluate(a.F, a.x, a.v).force);
    if (circuit_->has_temperatures()) circuit_->set_friction(static_cast<int>(i), reduced_.law(i).friction(a.F, a.v));
  }
  if (shared_.any()) {
    shared_.write(springs_, takes_part ? &integrator_->response() : nullptr, *circuit_, integrator_->state().data(),
                  exchange, sample.lambda, sample.K_cross);
  }
  if (has_own_) {
    own_ = sample;
    for (std::size_t i = 0; i < m_; ++i) own_.K[i] = actuators[i].K;
    foreseen_.set_forces(exchange, sample);
  }
  sample.flags = flags;
  published_ = sample;
}

// ---- parameters, hash, variables ------------------------------------------------------------------------------

bool HydraulicsSubsystem::change_parameter(StepIndex n, const coupling::ParameterChange& change) noexcept {
  if (levels_.change(change.path, change.value)) return true;
  const int parameter = circuit_->find_parameter(change.path);
  if (parameter < 0) return false;
  const double now = *circuit_->parameters()[static_cast<std::size_t>(parameter)].value;
  ramps_.begin(parameter, now, change.value, n, change.over, H_);
  return true;
}

std::uint64_t HydraulicsSubsystem::state_hash() const noexcept {
  StateHash hash;
  integrator_->add_to(hash);
  ramps_.add_to(hash);
  if (exchange_every_ > 1) reduced_.add_to(hash);  // otherwise every step replaces it
  levels_.add_to(hash);
  signals_.add_to(*circuit_, hash);
  convergence_.add_to(hash);
  foreseen_.add_to(hash);
  hash.add(failure_.has_failed());
  return hash.digest();
}

void HydraulicsSubsystem::list_variables() {
  const std::span<const ElementVariable> circuit = circuit_->variables();
  variables_.assign(circuit.begin(), circuit.end());
  for (const scene::PortDef& def : scene_.ports) {
    const std::string& port = def.name;
    const coupling::PortDimensions dimensions = coupling::dimensions_of(def.unit);
    variables_.push_back({port + ".coupling_e_x", dimensions.position});
    variables_.push_back({port + ".coupling_e_v", dimensions.speed});
    variables_.push_back({port + ".coupling_e_F", dimensions.force});
    variables_.push_back({port + ".coupling_dE", Dimension::energy});
    variables_.push_back({port + ".coupling_dE_star", Dimension::energy});
    variables_.push_back({port + ".coupling_eta", Dimension::none});
    variables_.push_back({port + ".coupling_net", Dimension::none});
  }
  variables_.push_back({"hydraulics.omega_H", Dimension::none});
  if (is_free_running_) variables_.push_back({"hydraulics.partner_age", Dimension::none});
}

void HydraulicsSubsystem::read_variables(std::span<double> values) const noexcept {
  const std::size_t circuit = circuit_->variables().size();
  circuit_->read_variables(integrator_->state().data(), values.first(circuit));
  for (std::size_t i = 0; i < m_; ++i) {
    const coupling::PortDefects& defects = indicator().port(i);
    const std::array<double, kIndicatorVariables> shown = {defects.e_x,     defects.e_v, defects.e_F, defects.dE,
                                                           defects.dE_star, defects.eta, defects.net};
    std::copy(shown.begin(), shown.end(), values.begin() + static_cast<std::ptrdiff_t>(circuit + i * shown.size()));
  }
  const std::size_t rest = circuit + m_ * kIndicatorVariables;
  values[rest] = indicator().omega_H();
  if (is_free_running_) values[rest + 1] = static_cast<double>(partner_age_);
}

std::string_view HydraulicsSubsystem::offender_name(std::int32_t index) const noexcept {
  if (index >= 0 && index < circuit_->volume_count()) return circuit_->volume_name(index);
  const std::int32_t actuator = index - circuit_->volume_count();
  if (actuator >= 0 && actuator < 2 * circuit_->actuator_count()) {
    return scene_.ports[static_cast<std::size_t>(actuator % circuit_->actuator_count())].name;
  }
  const std::int32_t state = index - circuit_->first_component_state();
  if (index >= 0 && index < circuit_->state_count()) return circuit_->state_owner(state);
  return "a state of the circuit";
}

std::unique_ptr<coupling::Subsystem> make_hydraulics_subsystem(const scene::Scene& scene) {
  require(scene::check_is_split(scene));
  return measurement::with_instruments(std::make_unique<HydraulicsSubsystem>(scene),
                                       scene::instruments_of(scene, scene::Computes::hydraulics),
                                       scene.session.step_duration(), {});
}

}  // namespace slew::hydraulics_node
