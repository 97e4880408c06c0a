#include "hydraulics_node/hydraulics_subsystem.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/failure.h"
#include "coupling/saved_model.h"
#include "coupling/static_forces.h"
#include "scene/deep_starts.h"
#include "scene/ports.h"

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

coupling::LineForce ReducedMechanics::line_force(std::size_t port, double F, double x, double v) const noexcept {
  if (ports_[port].level != coupling::Level::tlm) return laws_[port].evaluate(F, x, v);
  coupling::LineForce line = laws_[port].evaluate(ports_[port].thrust, x, v);
  line.d_pressure = 0;
  return line;
}

void ReducedMechanics::accelerations(const double* F, const double* x, const double* v, double* a) const noexcept {
  const std::size_t m = laws_.size();
  std::array<double, kMaxPorts> line{};
  for (std::size_t j = 0; j < m; ++j) line[j] = line_force(j, F[j], x[j], v[j]).force;
  for (std::size_t i = 0; i < m; ++i) {
    a[i] = 0;
    if (ports_[i].level != coupling::Level::two) continue;
    double sum = a_free_[i];
    for (std::size_t j = 0; j < m; ++j) sum += W_[i * m + j] * line[j];
    a[i] = sum;
  }
}

double ReducedMechanics::time_to_rest(const double* v, const double* a, const double* j) const noexcept {
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < laws_.size(); ++i) shortest = std::min(shortest, laws_[i].time_to_rest(v[i], a[i], j[i]));
  return shortest;
}

void ReducedMechanics::slopes(const double* F, const double* x, const double* v, double* da_dF, double* da_dx,
                              double* da_dv) const noexcept {
  const std::size_t m = laws_.size();
  for (std::size_t j = 0; j < m; ++j) {
    const coupling::LineForce line = line_force(j, F[j], x[j], v[j]);
    for (std::size_t i = 0; i < m; ++i) {
      const double w = ports_[i].level == coupling::Level::two ? W_[i * m + j] : 0.0;
      da_dF[i * m + j] = w * line.d_pressure;
      da_dx[i * m + j] = w * line.d_position;
      da_dv[i * m + j] = w * line.d_speed;
    }
  }
}

HydraulicsSubsystem::HydraulicsSubsystem(const scene::Scene& scene)
    : scene_(scene),
      m_(scene.ports.size()),
      levels_(scene::port_levels(scene)),
      H_(scene.session.step_duration()),
      is_free_running_(scene.session.mode == scene::ExchangeMode::free_running),
      ends_on_alarm_(scene.session.coupling_alarm == scene::CouplingAlarm::stop),
      exchange_every_(scene.session.exchange_every),
      past_(m_),
      history_(is_free_running_ ? static_cast<std::size_t>(coupling::kRememberedSteps) : 0),
      reduced_(laws_of(scene)),
      indicator_(m_, {H_.ns * exchange_every_}) {
  reset();
  for (const scene::PortDef& port : scene.ports) port_names_.push_back(port.name);
  for (const scene::InputDef& input : scene.inputs) {
    control_of_channel_.push_back(circuit_->find_control(input.primitive));
  }
  list_variables();
  saved_model_ = coupling::saved_model(
      variables_, {H_.ns, exchange_every_, is_free_running_, static_cast<int>(scene.hydraulics.solver)});
}

void HydraulicsSubsystem::reset() {
  integrator_.reset();
  circuit_ = std::make_unique<hydraulics::Circuit>(scene_.hydraulics);
  integrator_ = std::make_unique<hydraulics::CircuitIntegrator>(*circuit_, scene_.hydraulics);
  signal_trends_ = coupling::Trends(circuit_->flow_controls().size());
  signals_.resize(circuit_->flow_controls().size());
  indicator_.reset();
  ramps_ = coupling::ParameterRamps(circuit_->parameters().size());
  levels_.reset();
  failure_ = StepReport{};
  failure_text_length_ = 0;
  past_.clear();
  std::fill(history_.begin(), history_.end(), SentSample{});
  used_step_ = -1;
  partner_age_ = 0;
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
    if (scene_.hydraulics.start == hydraulics::StartState::equilibrium) {
      if (Status status = check_pressures({F.data(), m_}); !status.is_ok()) return status;
    }
  }
  integrator_->start({x.data(), m_}, {v.data(), m_}, {F.data(), m_});
  apply_levels();
  integrator_->refresh();
  publish(sample.actuators, 0, false);
  if (m_ > 0 && ends_on_alarm_) {
    if (Status status = check_coupling(*partners.mechanism); !status.is_ok()) return status;
  }
  return check_stability(partners.mechanism);
}

// Refuses a load that the circuit cannot hold at rest: the start pressures would be impossible for this machine.
Status HydraulicsSubsystem::check_pressures(std::span<const double> F) const {
  const std::optional<hydraulics::StartDemand> demand = circuit_->demand_beyond_limits(F);
  if (!demand) return Status::ok();
  constexpr double kBar = 1e5, kKilo = 1e3;
  const auto actuator = static_cast<std::size_t>(demand->actuator);
  std::string limit = "no oil has a pressure below 0";
  if (demand->pressure >= 0) {
    limit = demand->valve.empty()
                ? fmt::format("a chamber without a relief valve is taken to hold {:.0f} bar", demand->limit / kBar)
                : fmt::format("{} opens fully at {:.4g} bar", demand->valve, demand->limit / kBar);
  }
  const std::string contacts = scene::deep_starts(scene_);
  return Status::error(
      ExitCode::failed,
      fmt::format("hydraulics.start: equilibrium requires {:.4g} bar in {} to hold {:.4g} kN on {}, but {}. {}",
                  demand->pressure / kBar, circuit_->volume_name(demand->volume), F[actuator] / kKilo,
                  port_names_[actuator], limit,
                  contacts.empty() ? "Lighten the load or begin in another pose, or set hydraulics.start: table13"
                                   : contacts + ". Move these bodies apart, or set hydraulics.start: table13"));
}

// Refuses an explicit solver beyond its limit at the start; later steps are flagged.
Status HydraulicsSubsystem::check_stability(const coupling::MechanismSample* mechanism) {
  if (mechanism != nullptr && m_ > 0) reduced_.set_sample(*mechanism);
  const hydraulics::ExplicitStability stability = integrator_->explicit_stability(H_.seconds(), reduced_);
  if (!(stability.ratio > 1)) return Status::ok();
  return Status::error(
      ExitCode::failed,
      fmt::format(
          "hydraulics.solver: rk4 with sub-steps of {:.3g} ms would be unstable: {} moves {:.2g} times too fast "
          "for it. Set hydraulics.max_substep below {:.3g} ms, or solver: rodas3",
          1e3 * stability.substep, offender_name(stability.owner), stability.ratio,
          1e3 * stability.substep / stability.ratio));
}

// Refuses a coupling whose oil-spring frequency exceeds the Nyquist limit of the exchange (omega H > pi), or the lower
// limit of samples that are at least a step late.
Status HydraulicsSubsystem::check_coupling(const coupling::MechanismSample& mechanism) const {
  const double H = H_.seconds() * static_cast<double>(exchange_every_);
  coupling::PortArray K = published_.K;
  for (std::size_t i = 0; i < m_; ++i) {
    if (!coupling::is_balanced(levels_[i])) K[i] = 0;
  }
  const double omega_H = coupling::coupling_frequency(mechanism.W, K, H);
  const double limit = is_free_running_ ? coupling::kMostLate : coupling::kMostSampled;
  if (!(omega_H > limit)) return Status::ok();
  const char* const bound = is_free_running_
                                ? "above the limit for samples that are a step late (session.mode: free_running)"
                                : "above the Nyquist limit of the exchange";
  return Status::error(
      ExitCode::failed,
      fmt::format(
          "session.coupling: the oil-spring oscillation has omega_H = {:.2g} at one exchange in {:.3g} ms, {}: at most "
          "{:.2g}. Nothing was run. Set {} below {:.2g} ms{}, or session.coupling_alarm: warn to run it nevertheless",
          omega_H, 1e3 * H, bound, limit, exchange_every_ > 1 ? "the time between two exchanges" : "session.step",
          1e3 * H * limit / omega_H, is_free_running_ ? ", or session.mode: lockstep" : ""));
}

// ---- step -----------------------------------------------------------------------------------------------------

void HydraulicsSubsystem::apply_levels() noexcept {
  for (std::size_t i = 0; i < m_; ++i) {
    reduced_.set_level(i, levels_[i]);
    integrator_->set_line(static_cast<int>(i), levels_[i] == coupling::Level::tlm, H_.seconds());
  }
}

// The pistons take the positions of this step's sample. Without a new sample they continue with the copy of the
// mechanics.
void HydraulicsSubsystem::take_mechanism(StepIndex n, const coupling::MechanismSample& mechanism, StepIndex age,
                                         StepReport& report) noexcept {
  partner_age_ = age;
  const bool has_new_sample = n - age != used_step_;
  used_step_ = n - age;
  if (has_new_sample && age == 0) {
    indicator_.update(mechanism, published_, stiffness_, levels_);
    integrator_->align(mechanism.x.span(), mechanism.v.span());
  } else if (has_new_sample) {
    take_late_sample(used_step_, mechanism);
  }
  // the exchange used the levels of the finished step; those of the next step hold now
  apply_levels();
  if (has_new_sample) {
    for (std::size_t i = 0; i < m_; ++i) {
      reduced_.set_thrust(i, published_.F[i] - published_.D[i] * (mechanism.v[i] - published_.v_ref[i]));
    }
    reduced_.set_sample(mechanism);
  }
  if (!is_free_running_) return;
  keep_begin(n);
  const double late = static_cast<double>(age) * H_.seconds();
  if (age > 0 && coupling::coupling_frequency(mechanism.W, published_.K, late) > coupling::kDegradedAbove) {
    report.raise(StepFlag::late_input);
  }
}

// A late sample corrects the pistons by its deviation at the step it belongs to (coupling/own_past.h). The indicator
// compares the displacements of both sides in that step, since the circuit's own position then lacks later corrections.
void HydraulicsSubsystem::take_late_sample(StepIndex step, const coupling::MechanismSample& mechanism) noexcept {
  if (!past_.has(step)) return;
  std::array<double, kMaxPorts> x{}, v{};
  for (std::size_t i = 0; i < m_; ++i) {
    const double dx = mechanism.x[i] - past_.first(step, i);
    const double dv = mechanism.v[i] - past_.second(step, i);
    past_.correct(step, i, dx, dv);
    x[i] = integrator_->actuators()[i].x + dx;
    v[i] = integrator_->actuators()[i].v + dv;
  }
  integrator_->align({x.data(), m_}, {v.data(), m_});
  const SentSample& sent = history_[static_cast<std::size_t>(step) % history_.size()];
  if (sent.step != step) return;
  coupling::ActuatorSample own = sent.sample;
  for (std::size_t i = 0; i < m_; ++i) {
    own.x_ref[i] = mechanism.x[i] - (mechanism.v_mean[i] * H_.seconds() - sent.displacement[i]);
  }
  indicator_.update(mechanism, own, stiffness_, levels_);
}

void HydraulicsSubsystem::keep_begin(StepIndex n) noexcept {
  std::array<double, kMaxPorts> x{}, v{};
  for (std::size_t i = 0; i < m_; ++i) {
    const int port = static_cast<int>(i);
    x[i] = integrator_->state()[static_cast<std::size_t>(circuit_->position(port))];
    v[i] = integrator_->state()[static_cast<std::size_t>(circuit_->speed(port))];
  }
  past_.keep(n, {x.data(), m_}, {v.data(), m_});
}

void HydraulicsSubsystem::keep_end(StepIndex n) noexcept {
  SentSample& sent = history_[static_cast<std::size_t>(n) % history_.size()];
  sent.step = n;
  sent.sample = published_;
  sent.displacement.resize(m_);
  for (std::size_t i = 0; i < m_; ++i) sent.displacement[i] = published_.x_ref[i] - past_.first(n - 1, i);
}

StepReport HydraulicsSubsystem::step(StepIndex n, const coupling::PartnerSamples& partners,
                                     std::span<const double> controls, coupling::OwnSample& sample) noexcept {
  if (failure_.has_failed()) {
    sample.actuators = published_;
    return failure_;
  }
  take_tick(n, controls);
  StepReport taken;
  if (partners.mechanism != nullptr && m_ > 0) take_mechanism(n, *partners.mechanism, partners.mechanism_age, taken);
  StepReport report = integrator_->step(H_.seconds(), reduced_);
  report.flags |= taken.flags;
  if (const std::optional<std::size_t> port = first_energy_alarm()) {
    report.raise(StepFlag::coupling_creates_energy);
    if (ends_on_alarm_ && coupling::is_balanced(levels_[*port])) {
      report.raise(StepFlag::ended);
      format_alarm_text(*port);
    }
  }
  if (report.has_failed()) {
    failure_ = report;
    sample.actuators = published_;
    return report;
  }
  publish(sample.actuators, report.flags, n % exchange_every_ != 0);
  if (is_free_running_ && m_ > 0) keep_end(n + 1);
  return report;
}

// The first port with the energy alarm. Levels linear and two end the session, the others are only flagged. A port that
// ends the session takes precedence over one that is only flagged.
std::optional<std::size_t> HydraulicsSubsystem::first_energy_alarm() const noexcept {
  std::optional<std::size_t> flagged;
  for (std::size_t i = 0; i < m_; ++i) {
    if (coupling::is_balanced(levels_[i])) {
      if (indicator_.diverges(i)) return i;
    } else if (!flagged && indicator_.port(i).creates_energy) {
      flagged = i;
    }
  }
  return flagged;
}

void HydraulicsSubsystem::format_alarm_text(std::size_t port) noexcept {
  const char* const remedy = levels_[port] != coupling::Level::two ? "a shorter session.step or coupling: two"
                             : is_free_running_                    ? "a shorter session.step or session.mode: lockstep"
                                                                   : "a shorter session.step";
  const auto written =
      fmt::format_to_n(failure_text_.data(), failure_text_.size(),
                       "{}: the coupling diverges: over the last second the works of both sides differed by {:.2g} % "
                       "of the work done, in "
                       "several exchanges, at omega_H = {:.2g} of the oil-spring oscillation; use {}, or "
                       "session.coupling_alarm: warn to "
                       "continue with red lamps",
                       port_names_[port], 1e2 * indicator_.own_residual(port), indicator_.omega_H(), remedy);
  failure_text_length_ = std::min(written.size, failure_text_.size());
}

// parameter ramps, and the controls of the step
void HydraulicsSubsystem::take_tick(StepIndex n, std::span<const double> controls) noexcept {
  for (std::size_t k = 0; k < signals_.size(); ++k) {
    const auto control = static_cast<std::size_t>(circuit_->flow_controls()[k]);
    static_cast<void>(signal_trends_.begin(k, circuit_->control_signals()[control]));
  }
  ramps_.apply(n, [this](int parameter, double value) { circuit_->set_parameter(parameter, value); });
  for (std::size_t i = 0; i < std::min(controls.size(), control_of_channel_.size()); ++i) {
    if (control_of_channel_[i] >= 0) circuit_->set_control(control_of_channel_[i], controls[i]);
  }
  for (std::size_t k = 0; k < signals_.size(); ++k) {
    signal_trends_.end(k, circuit_->control_signals()[static_cast<std::size_t>(circuit_->flow_controls()[k])]);
  }
}

// F_dot holds for the next step, whose signals have not arrived: their trend is continued with the limiter of trends.h,
// which drops a jump.
void HydraulicsSubsystem::extrapolate_signals() noexcept {
  bool is_any_moving = false;
  const std::span<const int> controls = circuit_->flow_controls();
  for (std::size_t k = 0; k < signals_.size(); ++k) {
    signals_[k] = circuit_->control_signals()[static_cast<std::size_t>(controls[k])];
    const double change = signal_trends_.begin(k, signals_[k]);
    if (change == 0) continue;
    circuit_->set_control(controls[k], signals_[k] + change);
    is_any_moving = true;
  }
  if (!is_any_moving) return;
  integrator_->refresh_force_rates();
  for (std::size_t k = 0; k < signals_.size(); ++k) circuit_->set_control(controls[k], signals_[k]);
}

StepReport HydraulicsSubsystem::follow(StepIndex n, const FollowedCircuit& step,
                                       const coupling::PartnerSamples& partners, std::span<const double> controls,
                                       coupling::OwnSample& sample) noexcept {
  take_tick(n, controls);
  if (partners.mechanism != nullptr && m_ > 0) indicator_.update(*partners.mechanism, published_, stiffness_, levels_);
  std::copy(step.state.begin(), step.state.end(), integrator_->mutable_state().begin());
  circuit_->set_vapour_capacities(step.vapour);
  integrator_->refresh();
  StepReport report;
  report.flags = circuit_->flags(step.state.data());
  report.offender = circuit_->farthest_beyond_oil_law(step.state.data());
  if (report.offender < 0) report.offender = circuit_->first_cavitating(step.state.data());
  publish(sample.actuators, report.flags, false);
  std::copy(step.work.begin(), step.work.end(), sample.actuators.work.begin());
  std::copy(step.impulse.begin(), step.impulse.end(), sample.actuators.impulse.begin());
  published_ = sample.actuators;
  return report;
}

// adds_up: work and impulse continue from the previous sample, since no exchange took place between
void HydraulicsSubsystem::publish(coupling::ActuatorSample& sample, std::uint32_t flags, bool adds_up) noexcept {
  if (sample.F.size() != m_) coupling::resize(sample, m_);
  extrapolate_signals();
  const std::span<const hydraulics::ActuatorLinearisation> actuators = integrator_->actuators();
  for (std::size_t i = 0; i < m_; ++i) {
    const hydraulics::ActuatorLinearisation& a = actuators[i];
    sample.F[i] = a.F;
    sample.F_dot[i] = a.F_dot;
    sample.K[i] = a.K;
    sample.lambda[i] = a.lambda;
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
  signal_trends_.add_to(hash);
  for (const int control : circuit_->flow_controls()) {
    hash.add(circuit_->control_signals()[static_cast<std::size_t>(control)]);
  }
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
  if (is_free_running_) variables_.push_back({"hydraulics.partner_age", Dimension::none});
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
  const std::size_t rest = circuit + m_ * kIndicatorVariables;
  values[rest] = indicator_.omega_H();
  if (is_free_running_) values[rest + 1] = static_cast<double>(partner_age_);
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
  require(scene::check_is_split(scene));
  return std::make_unique<HydraulicsSubsystem>(scene);
}

}  // namespace slew::hydraulic_node
