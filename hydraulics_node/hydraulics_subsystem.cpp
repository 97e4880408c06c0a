#include "hydraulics_node/hydraulics_subsystem.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "cli_support/failure.h"
#include "coupling/static_forces.h"

namespace slew::hydraulic_node {
namespace {

using coupling::kMaxPorts;

std::vector<coupling::LineForceLaw> laws_of(const scene::Scene& scene) {
  std::vector<coupling::LineForceLaw> laws;
  for (const scene::PortDef& port : scene.ports) laws.emplace_back(port.line_force);
  return laws;
}

constexpr std::size_t kIndicatorVariables = 7;

}  // namespace

void ReducedMechanics::accelerations(const double* F, const double* x, const double* v, double* a) const noexcept {
  const std::size_t m = laws_.size();
  std::array<double, kMaxPorts> line{};
  for (std::size_t j = 0; j < m; ++j) line[j] = laws_[j].evaluate(F[j], x[j], v[j]).force;
  for (std::size_t i = 0; i < m; ++i) {
    double sum = a_free_[i];
    for (std::size_t j = 0; j < m; ++j) sum += W_[i * m + j] * line[j];
    a[i] = sum;
  }
}

void ReducedMechanics::slopes(const double* F, const double* x, const double* v, double* da_dF, double* da_dx,
                              double* da_dv) const noexcept {
  const std::size_t m = laws_.size();
  for (std::size_t j = 0; j < m; ++j) {
    const coupling::LineForce line = laws_[j].evaluate(F[j], x[j], v[j]);
    for (std::size_t i = 0; i < m; ++i) {
      const double w = W_[i * m + j];
      da_dF[i * m + j] = w * line.d_pressure;
      da_dx[i * m + j] = w * line.d_position;
      da_dv[i * m + j] = w * line.d_speed;
    }
  }
}

HydraulicsSubsystem::HydraulicsSubsystem(const scene::Scene& scene)
    : scene_(scene),
      m_(scene.ports.size()),
      level_(scene.session.coupling),
      H_(scene.session.step_duration()),
      reduced_(laws_of(scene)),
      held_(m_),
      indicator_(m_, H_) {
  reset();
  for (const scene::PortDef& port : scene.ports) port_names_.push_back(port.name);
  for (const scene::InputDef& input : scene.inputs) {
    control_of_channel_.push_back(circuit_->find_control(input.primitive));
  }
  list_variables();
}

void HydraulicsSubsystem::reset() {
  integrator_.reset();
  circuit_ = std::make_unique<hydraulics::Circuit>(scene_.hydraulics);
  integrator_ = std::make_unique<hydraulics::CircuitIntegrator>(*circuit_, scene_.hydraulics);
  indicator_.reset();
  ramps_ = coupling::ParameterRamps(circuit_->parameters().size());
  failure_ = StepReport{};
  coupling::resize(published_, m_);
}

// ---- start ----------------------------------------------------------------------------------------------------

bool HydraulicsSubsystem::first_sample(coupling::OwnSample&) noexcept {
  return false;
}

Status HydraulicsSubsystem::start(const coupling::PartnerSamples& partners, coupling::OwnSample& sample) {
  std::array<double, kMaxPorts> x{}, v{}, F{};
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
    if (scene_.hydraulics.start == hydraulics::StartState::equilibrium &&
        !coupling::static_forces(mechanism.W.span(), mechanism.a_free.span(), {F.data(), m_})) {
      return Status::error(ExitCode::failed, std::string(coupling::kNoStaticForces));
    }
  }
  integrator_->start({x.data(), m_}, {v.data(), m_}, {F.data(), m_});
  integrator_->refresh();
  publish(sample.actuators, 0);
  return Status::ok();
}

// ---- step -----------------------------------------------------------------------------------------------------

void HydraulicsSubsystem::take_mechanism(const coupling::MechanismSample& mechanism) noexcept {
  indicator_.update(mechanism, published_);
  integrator_->align(mechanism.x.span(), mechanism.v.span());
  reduced_.set_sample(mechanism);
}

StepReport HydraulicsSubsystem::step(StepIndex n, const coupling::PartnerSamples& partners,
                                     std::span<const double> controls, coupling::OwnSample& sample) noexcept {
  if (failure_.has_failed()) {
    sample.actuators = published_;
    return failure_;
  }
  take_tick(n, controls);
  if (partners.mechanism != nullptr && m_ > 0) take_mechanism(*partners.mechanism);
  const bool is_hold = level_ == coupling::Level::hold;
  StepReport report =
      integrator_->step(H_.seconds(), is_hold ? static_cast<const hydraulics::PistonMotion&>(held_) : reduced_);
  if (indicator_.creates_energy()) report.raise(StepFlag::coupling_creates_energy);
  if (report.has_failed()) {
    failure_ = report;
    sample.actuators = published_;
    return report;
  }
  publish(sample.actuators, report.flags);
  return report;
}

// parameters on their way, and the controls of the step
void HydraulicsSubsystem::take_tick(StepIndex n, std::span<const double> controls) noexcept {
  ramps_.apply(n, [this](int parameter, double value) { circuit_->set_parameter(parameter, value); });
  for (std::size_t i = 0; i < std::min(controls.size(), control_of_channel_.size()); ++i) {
    if (control_of_channel_[i] >= 0) circuit_->set_control(control_of_channel_[i], controls[i]);
  }
}

StepReport HydraulicsSubsystem::follow(StepIndex n, const FollowedCircuit& step,
                                       const coupling::PartnerSamples& partners, std::span<const double> controls,
                                       coupling::OwnSample& sample) noexcept {
  take_tick(n, controls);
  if (partners.mechanism != nullptr && m_ > 0) indicator_.update(*partners.mechanism, published_);
  std::copy(step.state.begin(), step.state.end(), integrator_->mutable_state().begin());
  integrator_->refresh();
  StepReport report;
  report.flags = circuit_->flags(step.state.data());
  report.offender = circuit_->first_cavitating(step.state.data());
  publish(sample.actuators, report.flags);
  std::copy(step.work.begin(), step.work.end(), sample.actuators.work.begin());
  std::copy(step.impulse.begin(), step.impulse.end(), sample.actuators.impulse.begin());
  published_ = sample.actuators;
  return report;
}

void HydraulicsSubsystem::publish(coupling::ActuatorSample& sample, std::uint32_t flags) noexcept {
  if (sample.F.size() != m_) coupling::resize(sample, m_);
  const std::span<const hydraulics::ActuatorLinearisation> actuators = integrator_->actuators();
  for (std::size_t i = 0; i < m_; ++i) {
    const hydraulics::ActuatorLinearisation& a = actuators[i];
    sample.F[i] = a.F;
    sample.F_dot[i] = a.F_dot;
    sample.K[i] = a.K;
    sample.lambda[i] = a.lambda;
    sample.D[i] = 0;
    sample.x_ref[i] = a.x;
    sample.v_ref[i] = a.v;
    sample.friction_scale[i] = reduced_.law(i).friction_scale(a.F);
    sample.work[i] = a.work;
    sample.impulse[i] = a.impulse;
    sample.p_A[i] = a.p_a;
    sample.p_B[i] = a.p_b;
    sample.Q_A[i] = a.Q_a;
    sample.Q_B[i] = a.Q_b;
    circuit_->set_line_force(static_cast<int>(i), reduced_.law(i).evaluate(a.F, a.x, a.v).force);
  }
  sample.flags = flags;
  published_ = sample;
}

// ---- parameters, hash, variables ------------------------------------------------------------------------------

bool HydraulicsSubsystem::change_parameter(StepIndex n, const coupling::ParameterChange& change) noexcept {
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
  hash.add(failure_.has_failed());
  return hash.digest();
}

void HydraulicsSubsystem::list_variables() {
  const std::span<const ElementVariable> circuit = circuit_->variables();
  variables_.assign(circuit.begin(), circuit.end());
  for (const std::string& port : port_names_) {
    variables_.push_back({port + ".coupling_e_x", Dimension::length});
    variables_.push_back({port + ".coupling_e_v", Dimension::velocity});
    variables_.push_back({port + ".coupling_e_F", Dimension::force});
    variables_.push_back({port + ".coupling_dE", Dimension::energy});
    variables_.push_back({port + ".coupling_dE_star", Dimension::energy});
    variables_.push_back({port + ".coupling_eta", Dimension::none});
    variables_.push_back({port + ".coupling_net", Dimension::none});
  }
  variables_.push_back({"hydraulics.omega_H", Dimension::none});
}

void HydraulicsSubsystem::read_variables(std::span<double> values) const noexcept {
  const std::size_t circuit = circuit_->variables().size();
  circuit_->read_variables(integrator_->state().data(), values.first(circuit));
  for (std::size_t i = 0; i < m_; ++i) {
    const coupling::PortDefects& defects = indicator_.port(i);
    const std::array<double, kIndicatorVariables> shown = {defects.e_x,     defects.e_v, defects.e_F, defects.dE,
                                                           defects.dE_star, defects.eta, defects.net};
    std::copy(shown.begin(), shown.end(), values.begin() + static_cast<std::ptrdiff_t>(circuit + i * shown.size()));
  }
  values[circuit + m_ * kIndicatorVariables] = indicator_.omega_H();
}

std::string_view HydraulicsSubsystem::offender_name(std::int32_t index) const noexcept {
  if (index >= 0 && index < circuit_->volume_count()) return circuit_->volume_name(index);
  const std::int32_t actuator = index - circuit_->volume_count();
  if (actuator >= 0 && actuator < 2 * circuit_->actuator_count()) {
    return port_names_[static_cast<std::size_t>(actuator % circuit_->actuator_count())];
  }
  return "a state of a hydraulic component";
}

std::unique_ptr<coupling::Subsystem> make_hydraulics_subsystem(const scene::Scene& scene) {
  cli_support::require(scene::check_is_split(scene));
  return std::make_unique<HydraulicsSubsystem>(scene);
}

}  // namespace slew::hydraulic_node
