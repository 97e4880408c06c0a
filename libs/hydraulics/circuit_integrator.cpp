// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/circuit_integrator.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/reductions.h"
#include "math/cvode_stepper.h"
#include "math/implicit_euler.h"
#include "math/runge_kutta4.h"

namespace slew::hydraulics {
namespace {

math::SparsityPattern coupled_pattern(const Circuit& circuit) {
  math::SparsityPattern pattern = circuit.pattern();
  for (int i = 0; i < circuit.actuator_count(); ++i) {
    const auto row = static_cast<std::size_t>(circuit.speed(i));
    for (int j = 0; j < circuit.actuator_count(); ++j) {
      const Actuator& actuator = circuit.actuators()[static_cast<std::size_t>(j)];
      for (const StateIndex port : {actuator.port_a, actuator.port_b}) {
        if (!circuit.is_fixed(port)) pattern.add(row, static_cast<std::size_t>(port));
      }
      pattern.add(row, static_cast<std::size_t>(circuit.position(j)));
      pattern.add(row, static_cast<std::size_t>(circuit.speed(j)));
      for (const StateIndex state : {actuator.setting.state, actuator.brake.state}) {
        if (state >= 0) pattern.add(row, static_cast<std::size_t>(state));
      }
    }
  }
  return pattern;
}

// The pistons take the mechanics' positions and speeds at the next exchange.
std::vector<char> replaced_states(const Circuit& circuit) {
  std::vector<char> is_replaced(static_cast<std::size_t>(circuit.state_count()), 0);
  for (int j = 0; j < circuit.actuator_count(); ++j) {
    is_replaced[static_cast<std::size_t>(circuit.position(j))] = 1;
    is_replaced[static_cast<std::size_t>(circuit.speed(j))] = 1;
  }
  return is_replaced;
}

math::StiffOptions options_of(const Circuit& circuit, const HydraulicsDef& def) {
  return {.relative_tolerance = def.relative_tolerance,
          .minimum_step = def.minimum_step,
          .maximum_step = def.max_substep,
          .substep_budget = static_cast<std::uint32_t>(def.substep_budget),
          .scale = circuit.scales(),
          .relative = circuit.relatives(),
          .relative_below_zero = circuit.relatives_below_zero(),
          .is_replaced = replaced_states(circuit)};
}

// Of an interval that is only foreseen.
math::StiffOptions options_ahead(math::StiffOptions options) {
  options.relative_tolerance = std::max(options.relative_tolerance, math::kSoundShare);
  return options;
}

std::unique_ptr<math::StiffIntegrator> make_solver(const Circuit& circuit, Solver choice,
                                                   const math::StiffOptions& options) {
  const auto stride = static_cast<std::size_t>(circuit.state_count());
  switch (choice) {
    case Solver::rk4:
      return std::make_unique<math::RungeKutta4>(stride, options);
    case Solver::implicit_euler:
      return std::make_unique<math::ImplicitEuler>(coupled_pattern(circuit), stride, options);
    case Solver::cvode:
      return std::make_unique<math::CvodeStepper>(stride, options);
    case Solver::rodas3:
      break;
  }
  return std::make_unique<math::Rodas3>(coupled_pattern(circuit), stride, options);
}

// Function of a volume's state.
class VolumePressure final : public math::StateFunction {
 public:
  VolumePressure(const Circuit& circuit, int volume) noexcept : circuit_(circuit), volume_(volume) {}
  [[nodiscard]] Value at(double u) const noexcept override {
    const ValueSlope p = circuit_.pressure_at(volume_, u);
    return {p.value, p.slope};
  }

 private:
  const Circuit& circuit_;
  int volume_;
};

std::size_t at(int i) noexcept {
  return static_cast<std::size_t>(i);
}

constexpr double kMisplacedOil = 1e-3;  // share of a pressure's size in an Euler sub-step: a volume that empties from
                                        // 150 to 4 bar gives up 1.1 to 1.2 times its oil, without this bound 5 times
constexpr int kRadiusIterations = 200;  // iterations of the one estimate before a run

}  // namespace

CircuitIntegrator::CircuitIntegrator(Circuit& circuit, const HydraulicsDef& def)
    : circuit_(circuit),
      m_(static_cast<std::size_t>(circuit.actuator_count())),
      y_(static_cast<std::size_t>(circuit.state_count()), 0),
      y_start_(y_),
      f_(y_),
      F_(m_),
      F_dot_(m_),
      F_mean_(m_),
      jerk_(m_),
      da_dF_(m_ * m_),
      da_dx_(m_ * m_),
      da_dv_(m_ * m_),
      C_(static_cast<std::size_t>(circuit.volume_count())),
      outflow_(C_),
      pressure_integral_(2 * m_),
      substep_pressure_(2 * m_),
      published_(m_),
      options_(options_of(circuit, def)),
      choice_(def.solver),
      solver_(make_solver(circuit, def.solver, options_)),
      ahead_solver_(coupled_pattern(circuit), y_.size(), options_ahead(options_)),
      y_ahead_(y_),
      f_ahead_(y_),
      vapour_(C_.size()),
      inputs_(def.solver == Solver::cvode ? circuit.control_signals().size() + circuit.parameter_values().size() : 0),
      quasi_static_above_(def.quasi_static_above),
      mass_(y_.size(), 1),
      response_(circuit),
      algebraic_(0) {
  for (int i = 0; i < circuit.volume_count(); ++i) {
    const bool is_chamber = std::any_of(circuit.actuators().begin(), circuit.actuators().end(),
                                        [i](const Actuator& a) { return a.port_a == i || a.port_b == i; });
    may_be_quasi_static_.push_back(!is_chamber && !circuit.is_fixed(i) ? 1 : 0);
    is_marked_.push_back(def.volumes[static_cast<std::size_t>(i)].quasi_static ? 1 : 0);
  }
  is_quasi_static_.resize(may_be_quasi_static_.size());
  circuit_.start_at_initial_pressures(y_);
  choose_quasi_static();
  is_consistent_ = make_consistent();
  refresh();
}

void CircuitIntegrator::start(std::span<const double> x, std::span<const double> v, std::span<const double> F,
                              std::span<const double> W) noexcept {
  SLEW_CHECK(x.size() == m_ && v.size() == m_ && F.size() == m_);
  for (std::size_t j = 0; j < m_; ++j) circuit_.lump_line(static_cast<int>(j), y_.data());
  // the areas of stages are those at the stroke
  std::copy(x.begin(), x.end(), y_.begin() + circuit_.position(0));
  circuit_.start(F, y_, W);
  for (std::size_t j = 0; j < m_; ++j) {
    y_[static_cast<std::size_t>(circuit_.position(static_cast<int>(j)))] = x[j];
    y_[static_cast<std::size_t>(circuit_.speed(static_cast<int>(j)))] = v[j];
    published_[j].work = published_[j].impulse = 0;
  }
  if (circuit_.has_temperatures()) circuit_.start_heat(y_.data());
  solver_->restart();
  has_failed_ = false;
  choose_quasi_static();
  is_consistent_ = make_consistent();
  circuit_.follow_vapour(y_.data());
  refresh();
}

// Quasi-static volumes: marked by the Def, or with a rate at the present state above the limit.
void CircuitIntegrator::choose_quasi_static() {
  if (quasi_static_above_ > 0) {
    circuit_.outflow_slopes(y_.data(), outflow_.data());
    circuit_.capacities(y_.data(), C_.data());
  }
  for (std::size_t i = 0; i < may_be_quasi_static_.size(); ++i) {
    const bool is_fast = quasi_static_above_ > 0 && outflow_[i] > quasi_static_above_ * C_[i];
    is_quasi_static_[i] = may_be_quasi_static_[i] && (is_marked_[i] || is_fast) ? 1 : 0;
  }
  list_quasi_static();
}

void CircuitIntegrator::list_quasi_static() {
  quasi_static_.clear();
  for (std::size_t i = 0; i < is_quasi_static_.size(); ++i) {
    circuit_.take_up_vapour(static_cast<int>(i), is_quasi_static_[i] == 0);
    mass_[i] = is_quasi_static_[i] != 0 ? 0 : 1;
    if (is_quasi_static_[i] != 0) quasi_static_.push_back(static_cast<StateIndex>(i));
  }
  if (solver_->takes_algebraic_rows()) solver_->set_mass(mass_);
  ahead_solver_.set_mass(mass_);
  algebraic_ = math::DenseLu(quasi_static_.size());
  before_.assign(quasi_static_.size(), 0.0);
  balanced_ = before_;
}

// Reports a step change of an input to a multistep solver.
void CircuitIntegrator::note_inputs() noexcept {
  bool has_changed = false;
  std::size_t k = 0;
  for (const std::span<const double> values : {circuit_.control_signals(), circuit_.parameter_values()}) {
    for (const double value : values) {
      has_changed = has_changed || inputs_[k] != value;
      inputs_[k++] = value;
    }
  }
  if (has_changed) solver_->inputs_jumped();
}

ExplicitStability CircuitIntegrator::explicit_stability(double H, const PistonMotion& motion) {
  if (choice_ != Solver::rk4) return {};
  motion_ = &motion;
  derivative(y_.data(), f_.data());
  math::SpectralRadius radius(options_.scale, y_.size());
  const double lambda = radius.update(jacobian(y_.data(), f_.data()), kRadiusIterations);
  motion_ = nullptr;
  const double h = H / std::max(1.0, std::ceil(H / options_.maximum_step * (1 - 1e-12)));
  return {.ratio = h * lambda / math::kExplicitLimit, .substep = h, .owner = radius.owner()};
}

void CircuitIntegrator::align(std::span<const double> x, std::span<const double> v) noexcept {
  SLEW_ASSERT(x.size() == m_ && v.size() == m_);
  if (has_failed_) return;
  was_clamped_ = !circuit_.move_pistons(y_.data(), x.data());
  for (std::size_t j = 0; j < m_; ++j) y_[static_cast<std::size_t>(circuit_.speed(static_cast<int>(j)))] = v[j];
}

void CircuitIntegrator::set_line(int actuator, bool is_line, double H) noexcept {
  if (has_failed_ || is_line == circuit_.is_line(actuator)) return;
  if (is_line) {
    circuit_.make_line(actuator, H, y_.data());
  } else {
    circuit_.lump_line(actuator, y_.data());
  }
}

void CircuitIntegrator::derivative(const double* y, double* f) noexcept {
  circuit_.rates(y, f);
  add_accelerations(y, f);
}

const double* CircuitIntegrator::jacobian(const double* y, const double* f) noexcept {
  double* const J = circuit_.jacobian(y, f);
  circuit_.pressure_forces(y, F_.data());
  stamp_accelerations(y, J);
  return J;
}

const double* CircuitIntegrator::linearise(const double* y, double* f) noexcept {
  double* const J = circuit_.linearise(y, f);
  add_accelerations(y, f);
  stamp_accelerations(y, J);
  return J;
}

// y'' = J y'
double CircuitIntegrator::time_to_bend(const double* y, const double* f, const double* J) noexcept {
  const std::size_t n = y_.size(), first = static_cast<std::size_t>(circuit_.speed(0));
  for (std::size_t j = 0; j < m_; ++j) jerk_[j] = fixed_dot({J + (first + j) * n, n}, {f, n});
  return motion_->time_to_rest(y + first, f + first, jerk_.data());
}

void CircuitIntegrator::add_accelerations(const double* y, double* f) noexcept {
  circuit_.pressure_forces(y, F_.data());
  motion_->accelerations(F_.data(), y + circuit_.position(0), y + circuit_.speed(0), f + circuit_.speed(0));
}

// Pre-condition: F_ holds the forces at y.
void CircuitIntegrator::stamp_accelerations(const double* y, double* J) noexcept {
  if (m_ == 0) return;
  motion_->slopes(F_.data(), y + circuit_.position(0), y + circuit_.speed(0), da_dF_.data(), da_dx_.data(),
                  da_dv_.data());
  const int n = circuit_.state_count(), m = static_cast<int>(m_);
  for (int i = 0; i < m; ++i) {
    double* const row = J + circuit_.speed(i) * n;
    for (int j = 0; j < m; ++j) {
      const Actuator& actuator = circuit_.actuators()[static_cast<std::size_t>(j)];
      double da_dF = da_dF_[static_cast<std::size_t>(i * m + j)];
      if (actuator.brake.state >= 0) row[actuator.brake.state] += da_dF * actuator.brake.force;
      double by_stages = 0;
      if (actuator.setting.state >= 0) row[actuator.setting.state] += da_dF * at_full_setting(actuator, y);
      if (actuator.stages.area != nullptr) {
        by_stages = da_dF * at_full_setting(actuator, y) * actuator.stages.share_at(y).slope;
      }
      if (actuator.has_share()) da_dF *= actuator.setting_at(y);
      if (!circuit_.is_fixed(actuator.port_a))
        row[actuator.port_a] += da_dF * actuator.area_a * circuit_.pressure(actuator.port_a, y).slope;
      if (!circuit_.is_fixed(actuator.port_b))
        row[actuator.port_b] -= da_dF * actuator.area_b * circuit_.pressure(actuator.port_b, y).slope;
      row[circuit_.position(j)] = da_dx_[static_cast<std::size_t>(i * m + j)];
      if (actuator.stages.area != nullptr) row[circuit_.position(j)] += by_stages;
      row[circuit_.speed(j)] = da_dv_[static_cast<std::size_t>(i * m + j)];
    }
  }
}

CircuitIntegrator::PressureForce CircuitIntegrator::pressure_force(const Actuator& actuator, const double* y,
                                                                   const double* f) const noexcept {
  const ValueSlope a = circuit_.pressure(actuator.port_a, y), b = circuit_.pressure(actuator.port_b, y);
  PressureForce force{a.value * actuator.area_a - b.value * actuator.area_b,
                      a.slope * f[actuator.port_a] * actuator.area_a - b.slope * f[actuator.port_b] * actuator.area_b};
  if (actuator.setting.state >= 0) {
    const double e = y[actuator.setting.state];
    force = {e * force.F, e * force.rate + f[actuator.setting.state] * force.F};
  }
  if (actuator.stages.area != nullptr) {
    const ValueSlope e = actuator.stages.share_at(y);
    force = {e.value * force.F, e.value * force.rate + e.slope * f[actuator.stages.position] * force.F};
  }
  if (actuator.brake.state >= 0) {
    force.F += actuator.brake_at(y);
    force.rate += actuator.brake.force * f[actuator.brake.state];
  }
  return force;
}

// Force of the pressures at a setting of 1, and on the largest areas of stages.
double CircuitIntegrator::at_full_setting(const Actuator& actuator, const double* y) const noexcept {
  return circuit_.pressure(actuator.port_a, y).value * actuator.area_a -
         circuit_.pressure(actuator.port_b, y).value * actuator.area_b;
}

std::int32_t CircuitIntegrator::impossible_state(double h, const double* y_before, const double* y) noexcept {
  return circuit_.emptied_without_outflow(h, y_before, y);
}

math::StiffSystem::Unbalanced CircuitIntegrator::unbalanced_state(const double* y_before, const double* y) noexcept {
  return circuit_.unbalanced_volume(kMisplacedOil, y_before, y);
}

bool CircuitIntegrator::has_measure(std::size_t state) const noexcept {
  return state < C_.size() && circuit_.may_cavitate(state);
}

math::StiffSystem::Measure CircuitIntegrator::measure(std::size_t state, double y) const noexcept {
  const OilMeasure w = circuit_.oil_measure(state, y);
  return {w.value, w.slope, w.bend};
}

double CircuitIntegrator::state_of_measure(std::size_t state, double w) const noexcept {
  return circuit_.state_of_oil(state, w);
}

std::size_t CircuitIntegrator::soft_states(const double* y, std::span<std::size_t> states) const noexcept {
  return circuit_.soft_volumes(y, states);
}

// (1); the slope at the end of a sub-step is taken when the next one starts.
void CircuitIntegrator::accepted(double h, const double* y_before, const double* f_before, double* y) noexcept {
  close_quadrature(y_before, f_before);
  const double weight = h * h / 12;
  for (std::size_t j = 0; j < m_; ++j) {
    const Actuator& actuator = circuit_.actuators()[j];
    const int x = circuit_.position(static_cast<int>(j)), v = circuit_.speed(static_cast<int>(j));
    const PressureForce before = pressure_force(actuator, y_before, f_before);
    const double F_0 = before.F, F_1 = pressure_force(actuator, y, f_before).F, F_dot = before.rate;
    const double half = 0.5 * (F_1 - F_0);
    F_mean_[j] = 0.5 * (F_0 + F_1);
    published_[j].work += F_mean_[j] * (y[x] - y_before[x]) + 0.5 * h * half * (y[v] - y_before[v]) +
                          weight * (F_dot * y_before[v] - half * f_before[v]);
    published_[j].impulse += 0.5 * h * (F_0 + F_1) + weight * F_dot;
  }
  integrate_pressures(h, y_before, f_before, y);
  open_quadrature_ = weight;
  was_clamped_ = circuit_.bound(y) || was_clamped_;
  circuit_.keep_closed_oil(h, y_before, f_before, y, substep_pressure_);
  circuit_.follow_vapour(y);
  if (circuit_.has_temperatures()) circuit_.add_heat(h, y);
}

void CircuitIntegrator::integrate_pressures(double h, const double* y_before, const double* f_before,
                                            const double* y) noexcept {
  for (std::size_t i = 0; i < pressure_integral_.size(); ++i) {
    const LineChamber& line = circuit_.lines()[i];
    if (!line.is_line) continue;
    const VolumePressure pressure(circuit_, line.volume);
    substep_pressure_[i] = solver_->integral(pressure, at(line.volume), h, y_before, f_before, y);
    pressure_integral_[i] += substep_pressure_[i];
  }
}

void CircuitIntegrator::close_quadrature(const double* y, const double* f) noexcept {
  if (open_quadrature_ == 0) return;
  for (std::size_t j = 0; j < m_; ++j) {
    const Actuator& actuator = circuit_.actuators()[j];
    const int v = circuit_.speed(static_cast<int>(j));
    const auto [F, F_dot] = pressure_force(actuator, y, f);
    published_[j].work -= open_quadrature_ * (F_dot * y[v] + (F - F_mean_[j]) * f[v]);
    published_[j].impulse -= open_quadrature_ * F_dot;
  }
  open_quadrature_ = 0;
}

StepReport CircuitIntegrator::step(double H, const PistonMotion& motion) noexcept {
  StepReport report;
  if (!has_failed_ && !all_finite(y_)) {
    has_failed_ = true;
    const auto first = std::find_if(y_.begin(), y_.end(), [](double value) { return !std::isfinite(value); });
    offender_ = static_cast<StateIndex>(first - y_.begin());
  }
  if (has_failed_) {
    report.raise(failure_flag());
    report.offender = offender_;
    return report;
  }
  motion_ = &motion;
  std::copy(y_.begin(), y_.end(), y_start_.begin());
  for (ActuatorLinearisation& actuator : published_) actuator.work = actuator.impulse = 0;
  std::fill(pressure_integral_.begin(), pressure_integral_.end(), 0.0);
  open_quadrature_ = 0;
  if (!inputs_.empty()) note_inputs();
  if (!quasi_static_.empty()) is_consistent_ = make_consistent();
  if (circuit_.has_temperatures()) circuit_.begin_heat(y_.data());
  report_ = solver_->advance(*this, y_, H);
  if (!report_.is_finite || report_.is_impossible) {
    has_failed_ = true;
    offender_ = report_.worst_state;
    std::copy(y_start_.begin(), y_start_.end(), y_.begin());
    open_quadrature_ = 0;
  }
  if (circuit_.has_temperatures() && !has_failed_) circuit_.end_heat(H, y_.data());
  circuit_.rates_and_outflow(y_.data(), f_.data(), outflow_.data(), C_.data());
  add_accelerations(y_.data(), f_.data());
  close_quadrature(y_.data(), f_.data());
  for (double& value : pressure_integral_) value /= H;
  if (!has_failed_) circuit_.end_line_step(y_.data(), pressure_integral_);
  publish();
  report_flags(report);
  was_clamped_ = false;
  motion_ = nullptr;
  return report;
}

void CircuitIntegrator::report_flags(StepReport& report) noexcept {
  report.flags = circuit_.flags(y_.data());
  // the search for them only where a flag is raised
  if (report.has(StepFlag::beyond_oil_law)) report.offender = circuit_.farthest_beyond_oil_law(y_.data());
  if (report.offender < 0 && report.has(StepFlag::cavitating)) {
    report.offender = circuit_.first_cavitating(y_.data());
  }
  report.substeps = report_.accepted;
  report.iterations = report_.accepted + report_.rejected;
  report.residual = report_.largest_error;
  if (report_.is_over_budget) report.raise(StepFlag::step_budget);
  if (report_.is_at_minimum_step) report.raise(StepFlag::not_converged);
  if (report_.is_unstable || !is_consistent_) report.raise(StepFlag::not_converged);
  const int overdrawn = report.has(StepFlag::cavitating) ? circuit_.first_overdrawn(y_.data()) : -1;
  if (overdrawn >= 0) report.raise(StepFlag::not_converged);
  if (was_clamped_) report.raise(StepFlag::clamp_active);
  if (!is_consistent_) report.offender = quasi_static_.front();
  if (overdrawn >= 0) report.offender = overdrawn;
  const bool has_error = report_.is_over_budget || report_.is_at_minimum_step || report_.is_unstable;
  if (has_error || has_failed_) report.offender = report_.worst_state;
  if (has_failed_) report.raise(failure_flag());
}

void CircuitIntegrator::refresh() noexcept {
  circuit_.rates_and_outflow(y_.data(), f_.data(), outflow_.data(), C_.data());
  publish();
}

void CircuitIntegrator::refresh_force_rates() noexcept {
  circuit_.rates(y_.data(), f_.data());
  for (std::size_t j = 0; j < m_; ++j) {
    if (!circuit_.is_line(static_cast<int>(j))) publish_force_rate(j);
  }
}

// F_dot of an actuator and the shares of its springs, from y_ and its rates f_. A motor's setting that moves counts
// with chamber A.
void CircuitIntegrator::publish_force_rate(std::size_t j) noexcept {
  const Actuator& actuator = circuit_.actuators()[j];
  ActuatorLinearisation& out = published_[j];
  out.F_dot = pressure_force(actuator, y_.data(), f_.data()).rate;
  const double b = -actuator.setting_at(y_.data()) * actuator.area_b *
                   circuit_.pressure(actuator.port_b, y_.data()).slope * f_[at(actuator.port_b)];
  double brake = actuator.brake.state < 0 ? 0 : actuator.brake.force * f_[at(actuator.brake.state)];
  if (actuator.stages.area != nullptr) {
    brake = at_full_setting(actuator, y_.data()) * actuator.stages.share_at(y_.data()).slope *
            y_[at(actuator.stages.position + circuit_.actuator_count())];
  }
  out.springs[0].F_dot = out.F_dot - b - brake;
  out.springs[1].F_dot = b;
  out.springs[2].F_dot = brake;
}

// Stiffness of an actuator's brake: its own while it holds, none while it slips. Of stages that of the present stop.
double CircuitIntegrator::brake_stiffness(int actuator) noexcept {
  const Actuator& braked = circuit_.actuators()[at(actuator)];
  if (braked.stages.area != nullptr) {
    return std::max(0.0, -at_full_setting(braked, y_.data()) * braked.stages.share_at(y_.data()).slope);
  }
  if (braked.brake.state < 0) return 0;
  const double K = circuit_.brake_stiffness(actuator, y_.data());
  const double held = -K * y_[at(circuit_.speed(actuator))];  // rate of its force while it holds
  if (held == 0) return K;
  return K * std::clamp(braked.brake.force * f_[at(braked.brake.state)] / held, 0.0, 1.0);
}

// (2), from y_, its rates f_, outflow_ and C_
void CircuitIntegrator::publish() noexcept {
  for (std::size_t j = 0; j < m_; ++j) {
    const Actuator& actuator = circuit_.actuators()[j];
    const auto a = static_cast<std::size_t>(actuator.port_a), b = static_cast<std::size_t>(actuator.port_b);
    ActuatorLinearisation& out = published_[j];
    out.x = y_[static_cast<std::size_t>(circuit_.position(static_cast<int>(j)))];
    out.v = y_[static_cast<std::size_t>(circuit_.speed(static_cast<int>(j)))];
    const ValueSlope p_a = circuit_.pressure(actuator.port_a, y_.data());
    const ValueSlope p_b = circuit_.pressure(actuator.port_b, y_.data());
    out.p_a = p_a.value, out.p_b = p_b.value;
    out.F = pressure_force(actuator, y_.data(), f_.data()).F;
    const double e = actuator.setting_at(y_.data()), A_a = e * actuator.area_a, A_b = e * actuator.area_b;
    out.Q_a = C_[a] * f_[a] + out.v * A_a;
    out.Q_b = C_[b] * f_[b] - out.v * A_b;
    out.empty_a = A_a * (circuit_.pressure_floor() - p_a.value);
    out.empty_b = -A_b * (circuit_.pressure_floor() - p_b.value);
    // a chamber that cavitates is no spring
    const auto spring = [this](std::size_t volume, double area, double slope) {
      const double C = C_[volume];
      return C > 0 ? math::RelaxingSpring{area * area / C * slope, std::max(0.0, outflow_[volume] / C)}
                   : math::RelaxingSpring{};
    };
    out.springs = {spring(a, A_a, p_a.slope), spring(b, A_b, p_b.slope),
                   math::RelaxingSpring{brake_stiffness(static_cast<int>(j))}};
    publish_force_rate(j);
    out.K = out.lambda = 0;
    for (const math::RelaxingSpring& part : out.springs) out.K += part.K, out.lambda += part.K * part.lambda;
    if (out.K > 0) out.lambda /= out.K;
    out.stiffness = out.K;
    out.D = 0;
    if (circuit_.is_line(static_cast<int>(j))) publish_line(static_cast<int>(j));
  }
}

// values of the lines in the next step
void CircuitIntegrator::publish_line(int actuator) noexcept {
  ActuatorLinearisation& out = published_[static_cast<std::size_t>(actuator)];
  const LineThrust thrust = circuit_.line_thrust(actuator, y_.data());
  out.D = thrust.damping;
  out.F = thrust.force - out.D * out.v;
  out.K = out.F_dot = out.lambda = out.stiffness = 0;
  out.springs = {};
  out.empty_a = out.empty_b = 0;
  for (std::size_t side = 0; side < 2; ++side) {
    const LineChamber& line = circuit_.lines()[2 * static_cast<std::size_t>(actuator) + side];
    if (!line.is_line) continue;
    const double p = circuit_.pressure(line.volume, y_.data()).value;
    const double C = C_[static_cast<std::size_t>(line.volume)];
    out.stiffness += line.slope * line.slope / (C + circuit_.line_capacity(line, p, out.x));
    (side == 0 ? out.Q_a : out.Q_b) = C * f_[static_cast<std::size_t>(line.volume)] + line.inflow(p);
  }
}

void CircuitIntegrator::add_to(StateHash& hash) const noexcept {
  hash.add(std::span<const double>(y_));
  solver_->add_to(hash);
  hash.add(has_failed_);
  circuit_.add_vapour_to(hash, y_.data());
  hash.add(circuit_.parameter_values());
  circuit_.add_lines_to(hash);
  if (circuit_.has_temperatures()) circuit_.add_heat_to(hash);
}

}  // namespace slew::hydraulics
