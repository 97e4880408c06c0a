// SPDX-License-Identifier: Apache-2.0
// Sub-steps that meet an end stop or a joint limit: repeated in parts where the mechanism does not follow the port
// problem.
//
// The port problem follows a stop as finely as its spring swings (coupling/port_dynamics.h). The mechanism then
// receives a mean and a slope of the force over the whole sub-step, has its own mobility on the way, and an integrator
// that may use only the mean. Where it goes deeper into the spring than the port problem did, energy is created. Such a
// sub-step is repeated from its start in kParts, and each part likewise, until that energy is small.
#include <algorithm>
#include <cmath>

#include "math/stop.h"
#include "mechanics_node/port_problem.h"

namespace slew::mechanics_node {
namespace {

// parts of one division
constexpr int kParts = 4;
// Accepted difference between the coordinate and the port problem's, in units of what the row's speed covers in the
// sub-step; and the speed that the difference of the spring's energy means, in units of the row's own: 1e-3 of its
// energy.
constexpr double kLargestStray = 0.03;
// a port's stop is near when it could be reached within so many sub-steps
constexpr double kNear = 4;

}  // namespace

// The coordinates of the port problem go back as well.
void PortProblem::restore_start(std::size_t depth) noexcept {
  mechanism_.restore(starts_[depth]);
  for (std::size_t k = 0; k < active_.size() && is_port(active_[k]); ++k) ports_[active_[k]].z = z_begin_[k];
  a_free_trends_.clear();
}

// Stops of ports by their speeds, limits of joints always: a large load may reach one from rest.
bool PortProblem::may_meet_stop(double h) const noexcept {
  for (std::size_t row = 0; row < mechanism_.row_count(); ++row) {
    if (!is_port(row) && mechanism_.model().rows[row].law.limit_stiffness > 0) return true;
    const double x = position_of(row);
    const double reach = kNear * h * std::fabs(ratio_of(row) * mechanism_.workspace().row_v[row]);
    if (stop_at(row, x - reach).stiffness > 0 || stop_at(row, x + reach).stiffness > 0) return true;
  }
  return false;
}

// The row of a limit that a load reached took no part in the port problem.
bool PortProblem::misses_limit() const noexcept {
  for (std::size_t row = ports_.size(); row < mechanism_.row_count(); ++row) {
    if (!mechanism_.is_row_active(row) && stop_at(row, position_of(row)).stiffness > 0) return true;
  }
  return false;
}

PortProblem::Stop PortProblem::stop_at(std::size_t row, double x) const noexcept {
  if (is_port(row)) {
    const coupling::LineForceDef& def = ports_[row].law.def();
    const math::StopForce stop = math::stop_force(x, 0, def.stroke_min, def.stroke_max, def.stop_stiffness, 0);
    return {stop.force, -stop.d_x};
  }
  const multibody::JointLaw& law = mechanism_.model().rows[row].law;
  if (!(law.limit_stiffness > 0)) return {};
  const math::StopForce stop = math::stop_force(x, 0, law.limit_min, law.limit_max, law.limit_stiffness, 0);
  return {stop.force, -stop.d_x};
}

// Largest net acceleration of a row: at the end of the sub-step, with all its forces, and the mean over it.
double PortProblem::net_acceleration(std::size_t k, double h) noexcept {
  const std::size_t rows = active_.size();
  double at_end = dynamics_.a_free()[k];
  for (std::size_t l = 0; l < rows; ++l) {
    at_end += dynamics_.W()[k * rows + l] * (dynamics_.f_mean()[l] + h / 2 * dynamics_.f_slope()[l]);
  }
  return std::max(std::fabs(at_end), std::fabs(dynamics_.v()[k] - v_begin_[k]) / h);
}

// Energy f^2/2k of a stop's spring, as a speed of the row's mass 1/W, after a sub-step, evaluated at its end. The row's
// other forces take back their share of a difference df: (df/k) (f + f_others) is created, and W (f + f_others) is the
// row's acceleration. A row at rest against a stop creates none, whatever presses it.
bool PortProblem::strays_in_stop(double h) noexcept {
  const std::size_t rows = active_.size();
  for (std::size_t k = 0; k < rows; ++k) {
    const std::size_t row = active_[k];
    const double x = position_of(row);
    const Stop there = stop_at(row, x), expected = stop_at(row, dynamics_.x()[k]);
    const double stiffness = std::max(there.stiffness, expected.stiffness);
    if (!(stiffness > 0)) continue;
    const double speed =
        std::max({std::fabs(v_begin_[k]), std::fabs(dynamics_.v()[k]), h * std::fabs(dynamics_.a_free()[k])});
    if (std::fabs(x - dynamics_.x()[k]) > kLargestStray * h * speed) return true;
    const double displacement = std::fabs(there.force - expected.force) / stiffness;
    if (2 * displacement * net_acceleration(k, h) > kLargestStray * kLargestStray * speed * speed) return true;
  }
  return false;
}

void PortProblem::take_substep(const Step& step, double h, bool is_first, std::size_t depth) noexcept {
  mechanism_.evaluate();
  const bool may_stray = !starts_.empty() && may_meet_stop(h);
  const bool may_divide = depth < starts_.size();
  if (may_stray && may_divide) mechanism_.keep(starts_[depth]);
  coupling::PortStep solved = advance(step, h, is_first);
  if (may_stray) {
    mechanism_.evaluate();
    if ((solved.meets_stop && strays_in_stop(h)) || misses_limit()) {
      if (may_divide) {
        restore_start(depth);
        for (int part = 0; part < kParts; ++part) take_substep(step, h / kParts, false, depth + 1);
        // the trends are those of parts, over another time
        a_free_trends_.clear();
        return;
      }
      solved.has_converged = false;
    }
  }
  if (!solved.has_converged) {
    step.report.raise(StepFlag::not_converged);
    const auto& contact = mechanism_.workspace().contact;
    if (contact != nullptr && step.report.offender < 0) step.report.offender = contact->lost_pair;
  }
  step.report.iterations += static_cast<std::uint32_t>(solved.iterations + mechanism_.dynamics().iterations());
  step.report.substeps += static_cast<std::uint32_t>(mechanism_.dynamics().parts());
  if (!(solved.residual <= step.report.residual)) step.report.residual = solved.residual;  // NaN stays
  finish_substep(step);
}

}  // namespace slew::mechanics_node
