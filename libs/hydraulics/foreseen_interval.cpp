// SPDX-License-Identifier: Apache-2.0
// An interval that comes, computed by the circuit as it is, after which its state is the one before.
#include "hydraulics/foreseen_interval.h"

#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "hydraulics/circuit_integrator.h"
#include "math/relaxing_spring.h"

namespace slew::hydraulics {
namespace {

constexpr std::size_t kMostSubsteps = 256;

}  // namespace

ForeseenInterval::ForeseenInterval(std::size_t ports) : actuators(ports) {
  h_.reserve(kMostSubsteps);
  speeds_.reserve(kMostSubsteps * ports);
}

void ForeseenInterval::clear() noexcept {
  std::fill(actuators.begin(), actuators.end(), ForeseenActuator{});
  h_.clear();
  speeds_.clear();
}

bool ForeseenInterval::add(double h) noexcept {
  if (h_.size() == kMostSubsteps) return false;
  h_.push_back(h);
  return true;
}

SpringWay ForeseenInterval::way(std::size_t j, double lambda) const noexcept {
  SpringWay way;
  const std::size_t m = actuators.size();
  for (std::size_t k = 0; k < h_.size(); ++k) {
    const double h = h_[k], x = lambda * h, r = way.r;
    const math::DecayedIntegrals phi = math::decayed_integrals(x);
    const Speed& speed = speeds_[k * m + j];
    const double u = h * speed.begin, a = h * h * speed.acceleration, c = 2 * (h * (speed.end - speed.begin) - a);
    way.moment += h * way.way + h * h * (phi.phi_2 * r + phi.phi_3 * u + phi.phi_4 * a + phi.phi_5 * c);
    way.way += h * (phi.phi_1 * r + phi.phi_2 * u + phi.phi_3 * a + phi.phi_4 * c);
    way.r = r - x * phi.phi_1 * r + phi.phi_1 * u + phi.phi_2 * a + phi.phi_3 * c;
  }
  return way;
}

// The integrator's system with sub-steps that only count what the actuators do.
class CircuitIntegrator::Ahead final : public math::StiffSystem {
 public:
  Ahead(CircuitIntegrator& own, double H, ForeseenInterval& interval) noexcept
      : own_(own), interval_(interval), left_(H) {}
  void derivative(const double* y, double* f) noexcept override { own_.derivative(y, f); }
  const double* jacobian(const double* y, const double* f) noexcept override { return own_.jacobian(y, f); }
  const double* linearise(const double* y, double* f) noexcept override { return own_.linearise(y, f); }
  [[nodiscard]] double time_to_bend(const double* y, const double* f, const double* J) noexcept override {
    return own_.time_to_bend(y, f, J);
  }
  [[nodiscard]] std::int32_t impossible_state(double h, const double* y_before, const double* y) noexcept override {
    return own_.impossible_state(h, y_before, y);
  }
  [[nodiscard]] Unbalanced unbalanced_state(const double* y_before, const double* y) noexcept override {
    return own_.unbalanced_state(y_before, y);
  }
  [[nodiscard]] bool has_measure(std::size_t state) const noexcept override { return own_.has_measure(state); }
  [[nodiscard]] Measure measure(std::size_t state, double y) const noexcept override { return own_.measure(state, y); }
  [[nodiscard]] double state_of_measure(std::size_t state, double w) const noexcept override {
    return own_.state_of_measure(state, w);
  }
  [[nodiscard]] std::size_t soft_states(const double* y, std::span<std::size_t> states) const noexcept override {
    return own_.soft_states(y, states);
  }
  void accepted(double h, const double* y_before, const double* f_before, double* y) noexcept override;
  [[nodiscard]] bool is_complete() const noexcept { return is_complete_; }
  // Ends the sub-step before with the rates f at its end y.
  void close(const double* y, const double* f) noexcept {
    for (std::size_t j = 0; j < interval_.actuators.size(); ++j) {
      const double rate = own_.pressure_force(own_.circuit_.actuators()[j], y, f).rate;
      interval_.actuators[j].impulse -= weight_ * rate;
      interval_.actuators[j].moment -= weight_ * rate * left_;
    }
    weight_ = 0;
  }

 private:
  [[nodiscard]] double spring(std::size_t volume, double area, const double* y) const noexcept {
    if (own_.circuit_.is_fixed(static_cast<int>(volume)) || !(own_.C_[volume] > 0)) return 0;
    const double slope = own_.circuit_.pressure(static_cast<int>(volume), y).slope;
    return area * area / own_.circuit_.capacity_at(volume, y) * slope;
  }

  CircuitIntegrator& own_;
  ForeseenInterval& interval_;
  double left_;        // s
  double weight_ = 0;  // h^2/12 of the sub-step before
  bool is_complete_ = true;
};

// (1) of circuit_integrator.h
void CircuitIntegrator::Ahead::accepted(double h, const double* y_before, const double* f_before, double* y) noexcept {
  close(y_before, f_before);
  weight_ = h * h / 12;
  is_complete_ = is_complete_ && interval_.add(h);
  const double after = left_ - h;
  for (std::size_t j = 0; j < interval_.actuators.size(); ++j) {
    const Actuator& actuator = own_.circuit_.actuators()[j];
    ForeseenActuator& ahead = interval_.actuators[j];
    const PressureForce before = own_.pressure_force(actuator, y_before, f_before);
    const double F_0 = before.F, F_1 = own_.pressure_force(actuator, y, f_before).F;
    ahead.impulse += 0.5 * h * (F_0 + F_1) + weight_ * before.rate;
    ahead.moment += 0.5 * h * (F_0 * left_ + F_1 * after) + weight_ * (before.rate * left_ - F_0 + F_1);
    for (const std::size_t side : {0u, 1u}) {
      const std::size_t volume = at(actuator.volume(side));
      ahead.K[side] += 0.5 * h *
                       (spring(volume, actuator.signed_area(side, y_before), y_before) +
                        spring(volume, actuator.signed_area(side, y), y));
    }
    ahead.end = F_1;
    const std::size_t v = at(own_.circuit_.speed(static_cast<int>(j)));
    const double v_ref = own_.published_[j].v;
    if (is_complete_) interval_.add_speed(y_before[v] - v_ref, f_before[v], y[v] - v_ref);
  }
  left_ = after;
  static_cast<void>(own_.circuit_.bound(y));
  own_.circuit_.follow_vapour(y);
}

bool CircuitIntegrator::foresee(double H, const PistonMotion& motion, ForeseenInterval& interval) noexcept {
  if (has_failed_) return false;
  std::copy(y_.begin(), y_.end(), y_ahead_.begin());
  std::copy(circuit_.vapour_capacities().begin(), circuit_.vapour_capacities().end(), vapour_.begin());
  interval.clear();
  motion_ = &motion;
  // a memory of the interval before would be a state of the circuit
  ahead_solver_.restart();
  if (choice_ == Solver::rodas3) ahead_solver_.set_step_size(solver_->step_size());
  Ahead system(*this, H, interval);
  const math::StiffReport report = ahead_solver_.advance(system, y_ahead_, H);
  const bool is_sound = report.is_finite && !report.is_impossible && !report.is_over_budget && system.is_complete();
  if (is_sound) {
    derivative(y_ahead_.data(), f_ahead_.data());
    system.close(y_ahead_.data(), f_ahead_.data());
    for (ForeseenActuator& actuator : interval.actuators) {
      for (double& K : actuator.K) K /= H;
    }
  }
  motion_ = nullptr;
  circuit_.set_vapour_capacities(vapour_);
  // pressures of load sensing are those of the last evaluation
  circuit_.rates(y_.data(), f_ahead_.data());
  return is_sound;
}

}  // namespace slew::hydraulics
