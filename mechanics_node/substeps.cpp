// One sub-step of the mechanics: rows, their implicit solve, the mechanism under their forces.
#include <algorithm>
#include <cmath>

#include "mechanics_node/mechanics_subsystem.h"
#include "mechanics_node/row_laws.h"
#include "multibody/joint_law.h"
#include "multibody/rows.h"

namespace slew::mechanics {
namespace {

// a limit takes part in the port problem when it could be reached within so many sub-steps
constexpr double kLimitLookAhead = 4;

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

coupling::PortStep MechanicsSubsystem::advance(StepIndex n, double h, const coupling::ActuatorSample* partner,
                                               bool is_first_substep) noexcept {
  evaluate();
  if (select_rows(h)) {
    is_evaluated_ = false;
    evaluate();
  }
  // the reduced model at the rows, in port coordinates
  active_.clear();
  for (std::size_t row = 0; row < model_.rows.size(); ++row) {
    if (row_is_active_[row] != 0) active_.push_back(row);
  }
  const std::size_t rows = model_.rows.size();
  const bool takes_step = touches() || (has_long_substeps_ && is_soft_behind_ports_);
  const Rows of = takes_step ? rows_over(h) : rows_now();
  dynamics_.set_rows(active_.size());
  for (std::size_t k = 0; k < active_.size(); ++k) {
    const std::size_t row = active_[k];
    const double ratio = ratio_of(row);
    dynamics_.x()[k] = (row < ports_.size() ? ports_[row].offset : 0) + ratio * workspace_.row_x[row];
    dynamics_.v()[k] = ratio * workspace_.row_v[row];
    dynamics_.a_free()[k] = ratio * of.a_free[row];
    // that over a sub-step is a mean already
    const bool is_mean = of.kind == coupling::MobilityKind::step;
    if (is_mean) a_free_trends_.forget(row);
    dynamics_.a_free_rate()[k] = is_mean ? 0.0 : a_free_trends_.next(row, ratio * of.a_free[row]) / h;
    for (std::size_t j = 0; j < active_.size(); ++j) {
      dynamics_.W()[k * active_.size() + j] = ratio * of.W[row * rows + active_[j]] * ratio_of(active_[j]);
    }
  }
  load_partner(partner, is_first_substep);
  if (is_first_substep && is_free_running_) {
    past_.keep(n, dynamics_.x().first(ports_.size()), dynamics_.z().first(ports_.size()));
  }
  coupling::PortStep solved = dynamics_.solve(h, micro_steps_, *laws_);
  // the mechanism under these forces
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
