// One sub-step of the mechanics: rows, their implicit solve, the mechanism under their forces.
#include <algorithm>
#include <cmath>
#include <utility>

#include "mechanics_node/mechanics_subsystem.h"
#include "mechanics_node/row_laws.h"
#include "multibody/constraints/rows.h"
#include "multibody/joints/joint_law.h"

namespace slew::mechanics {
namespace {

// a limit takes part in the port problem when it could be reached within so many sub-steps
constexpr double kLimitLookAhead = 4;

// micro-step of the port problem: resolves an oil spring of 300 rad/s to 1e-3 of its phase
constexpr double kMicroStep = 0.25e-3;

// How the mechanism's rule answers a force that is held over a sub-step; generalised_alpha is the trapezoid but for
// what it carries along. sdirk2: to second order, and what swings much faster than the sub-step stops at its end.
multibody::StepShares shares_of(multibody::Integrator rule) noexcept {
  switch (rule) {
    case multibody::Integrator::trapezoidal:
    case multibody::Integrator::generalised_alpha:
    case multibody::Integrator::index3_trapezoidal:
      return multibody::kTrapezoidalShares;
    case multibody::Integrator::sdirk2:
      return {.position = 0.5, .rate = 1, .strain = 0.5};
    default:
      return {};
  }
}

}  // namespace

// rows of the coming sub-step; true when the choice changed
bool MechanicsSubsystem::select_rows(double h) noexcept {
  bool has_changed = false;
  const std::span<const double> x = multibody::row_positions(workspace_);
  const std::span<const double> v = multibody::row_speeds(workspace_);
  for (std::size_t row = ports_.size(); row < model_.rows.size(); ++row) {
    const multibody::JointLaw& law = multibody::law_of(model_, row);
    const double reach = kLimitLookAhead * h * std::fabs(v[row]);
    const bool near_limit =
        law.limit_stiffness > 0 && (x[row] - reach <= law.limit_min || x[row] + reach >= law.limit_max);
    const bool is_active = law.coulomb > 0 || law.viscous > 0 || near_limit;
    if (is_active == (row_is_active_[row] != 0)) continue;
    has_changed = true;
    row_is_active_[row] = is_active ? 1 : 0;
    a_free_trends_.forget(row);
    if (is_active) {
      multibody::activate_row(workspace_, static_cast<int>(row));
    } else {
      multibody::deactivate_row(workspace_, static_cast<int>(row));
    }
  }
  return has_changed;
}

// The pressure force at the start of the step, where the port is at x: that of this step's sample, moved to the true
// position; without news the copy goes on, and a late sample corrects it by what it says of its own step.
double MechanicsSubsystem::force_at_exchange(std::size_t port, const coupling::ActuatorSample& partner,
                                             double x) noexcept {
  const double copy = ports_[port].z;
  if (!has_news_) return copy;
  const bool is_hold = levels_[port] == coupling::Level::hold;
  const auto at = [&](double position) {
    return is_hold ? partner.F[port] : partner.F[port] - partner.K[port] * (position - partner.x_ref[port]);
  };
  if (partner_age_ == 0) return at(x);
  if (!past_.has(used_step_)) return copy;
  const double correction = at(past_.first(used_step_, port)) - past_.second(used_step_, port);
  past_.correct(used_step_, port, 0, correction);
  return copy + correction;
}

// the partner's linearisation, and where the pressure force starts
void MechanicsSubsystem::load_partner(const coupling::ActuatorSample* partner, bool is_first_substep) noexcept {
  for (std::size_t k = 0; k < active_.size(); ++k) {
    const std::size_t row = active_[k];
    coupling::RowPartner law;
    double z = 0;
    if (row < ports_.size() && partner != nullptr) {
      z = is_first_substep ? force_at_exchange(row, *partner, dynamics_.x()[k]) : ports_[row].z;
      if (levels_[row] != coupling::Level::hold) {
        law = {partner->F_dot[row], partner->K[row], partner->lambda[row],
               partner->D[row],     partner->F[row], partner->v_ref[row]};
      }
    }
    dynamics_.partner()[k] = law;
    dynamics_.z()[k] = z;
  }
}

// Free accelerations of the present motion under the loads of the middle and of the end of the sub-step.
void MechanicsSubsystem::look_ahead(double h) noexcept {
  const double now = state_.time;
  for (auto [later, a] : {std::pair{0.5 * h, &a_middle_}, std::pair{h, &a_end_}}) {
    state_.time = now + later;
    mechanism_.evaluate(model_, state_, workspace_);
    *a = workspace_.row_a_free;
  }
  state_.time = now;
  is_evaluated_ = false;
}

// A line through what the mechanism's rule will integrate: its quadrature of the change by time alone.
MechanicsSubsystem::Course MechanicsSubsystem::course_of(std::size_t row, double a_free, double h) const noexcept {
  if (!has_timed_loads_ || rule_ == multibody::Integrator::semi_implicit_euler) return {};
  const double middle = a_middle_[row] - a_free, end = a_end_[row] - a_free;
  const double mean = rule_ == multibody::Integrator::rk4 ? (4 * middle + end) / 6 : 0.5 * end;
  return {mean - 0.5 * end, end / h};
}

// the reduced model at the active rows, in port coordinates
void MechanicsSubsystem::take_rows(double h) noexcept {
  active_.clear();
  for (std::size_t row = 0; row < model_.rows.size(); ++row) {
    if (row_is_active_[row] != 0) active_.push_back(row);
  }
  if (has_timed_loads_) a_begin_ = workspace_.row_a_free;
  const std::size_t rows = model_.rows.size();
  const bool is_touching = touches();
  const Rows of = is_touching || is_soft_behind_rows_ ? rows_over(h, shares_of(rule_)) : rows_now();
  // that over a sub-step is a mean already, and a contact's no free acceleration that goes on
  const bool goes_on = of.kind == coupling::MobilityKind::instant && !is_touching;
  dynamics_.set_rows(active_.size());
  for (std::size_t k = 0; k < active_.size(); ++k) {
    const std::size_t row = active_[k];
    const double ratio = ratio_of(row);
    dynamics_.x()[k] = (row < ports_.size() ? ports_[row].offset : 0) + ratio * workspace_.row_x[row];
    dynamics_.v()[k] = ratio * workspace_.row_v[row];
    double a_free = ratio * of.a_free[row], rate = 0;
    if (goes_on) {
      const Course course = course_of(row, of.a_free[row], h);
      rate = a_free_trends_.begin(row, a_free) / h + ratio * course.rate;
      a_free += ratio * course.start;
    } else {
      a_free_trends_.forget(row);
    }
    dynamics_.a_free()[k] = a_free;
    dynamics_.a_free_rate()[k] = rate;
    for (std::size_t j = 0; j < active_.size(); ++j) {
      dynamics_.W()[k * active_.size() + j] = ratio * of.W[row * rows + active_[j]] * ratio_of(active_[j]);
    }
  }
}

// means and slopes of the last solve; pressure forces at its end
void MechanicsSubsystem::put_row_forces() noexcept {
  std::fill(force_mean_.begin(), force_mean_.end(), 0.0);
  std::fill(force_slope_.begin(), force_slope_.end(), 0.0);
  for (std::size_t k = 0; k < active_.size(); ++k) {
    const std::size_t row = active_[k];
    force_mean_[row] = ratio_of(row) * dynamics_.f_mean()[k];
    force_slope_[row] = ratio_of(row) * dynamics_.f_slope()[k];
    if (row >= ports_.size()) continue;
    const coupling::RowPartner& law = dynamics_.partner()[k];
    ports_[row].z = dynamics_.z()[k];
    ports_[row].F = dynamics_.z()[k] - law.D * (dynamics_.v()[k] - law.v_ref);
  }
}

coupling::PortStep MechanicsSubsystem::advance(StepIndex n, double h, const coupling::ActuatorSample* partner,
                                               bool is_first_substep) noexcept {
  if (select_rows(h)) is_evaluated_ = false;
  if (has_timed_loads_) look_ahead(h);
  evaluate();
  take_rows(h);
  load_partner(partner, is_first_substep);
  std::copy(dynamics_.v().begin(), dynamics_.v().end(), v_begin_.begin());
  std::copy(dynamics_.z().begin(), dynamics_.z().end(), z_begin_.begin());
  if (is_first_substep && is_free_running_) {
    past_.keep(n, dynamics_.x().first(ports_.size()), dynamics_.z().first(ports_.size()));
  }
  const int micro_steps = std::max(1, static_cast<int>(std::ceil(h / kMicroStep - 1e-9)));
  coupling::PortStep solved = dynamics_.solve(h, micro_steps, *laws_);
  put_row_forces();
  const bool is_closed = mechanism_.advance(model_, state_, workspace_, h, force_mean_, force_slope_);
  solved.has_converged = solved.has_converged && is_closed;
  is_evaluated_ = false;
  return solved;
}

// Work and impulse of the sub-step. The mechanism moved by dx more than its reduced model in the port problem: the
// pressure force follows the true way, and does its work on it. Without this the large static force times the tiny dx
// would look like a coupling error.
void MechanicsSubsystem::finish_substep(const coupling::ActuatorSample* partner,
                                        coupling::MechanismSample& sample) noexcept {
  evaluate();
  for (const std::size_t row : active_) {
    const double a_free = workspace_.row_a_free[row];
    const double by_time = has_timed_loads_ ? a_end_[row] - a_begin_[row] : 0.0;
    a_free_trends_.end(row, ratio_of(row) * (a_free - by_time));
  }
  if (touches()) a_free_trends_.clear();
  for (std::size_t k = 0; k < active_.size() && active_[k] < ports_.size(); ++k) {
    const std::size_t row = active_[k];
    Port& port = ports_[row];
    const double dx = port.offset + port.ratio * workspace_.row_x[row] - dynamics_.x()[k];
    const double K = partner == nullptr ? 0.0 : dynamics_.partner()[k].K;
    sample.work[row] += dynamics_.work()[k] + (port.F - 0.5 * K * dx) * dx;
    sample.impulse[row] += dynamics_.impulse()[k];
    port.z -= K * dx;
    port.F -= K * dx;
  }
  // bristles follow the true way as well: what sticks stays where it is
  for (std::size_t k = 0; k < active_.size() && !state_.bristles.empty(); ++k) {
    const std::size_t row = active_[k];
    // a ball has no coordinate to tell by
    if (multibody::has_bristles(model_.rows[row].law) && !is_ball(row)) {
      state_.bristles[row] += workspace_.row_x[row] - dynamics_.x()[k];
    }
  }
}

}  // namespace slew::mechanics
