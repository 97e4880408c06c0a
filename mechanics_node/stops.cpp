// Sub-steps that meet an end stop or a joint limit: in parts where the mechanism does not go where its rows' problem
// went.
//
// The port problem follows a stop as finely as it swings (coupling/port_dynamics.h); the mechanism then has a mean and
// a slope of the force over the whole sub-step, its own mobility on the way, and a rule that may have only the mean.
// What it gets deeper into the spring than the rows' problem did is energy that nobody put there. Such a sub-step is
// taken again from its start, in kParts, and each of them in turn, until that energy is small.
#include <algorithm>
#include <cmath>

#include "math/stop.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "multibody/constraints/rows.h"
#include "multibody/joints/joint_law.h"

namespace slew::mechanics {
namespace {

// parts of a sub-step, and how often a part is parted again: 1024 of a sub-step
constexpr int kParts = 4;
constexpr std::size_t kDeepest = 5;
// What the way may be off by, of the way that the row's speed goes in the sub-step, and as the speed that the stop's
// spring makes of it, of the row's own: 1e-3 of its energy.
constexpr double kMostStray = 0.03;
// a stop is near when it could be reached within so many sub-steps
constexpr double kNear = 4;
// of a part's bytes
constexpr StateFormat kPart{};

}  // namespace

void MechanicsSubsystem::prepare_substeps() {
  bool has_stops = false;
  for (const Port& port : ports_) has_stops = has_stops || port.law.def().stop_stiffness > 0;
  for (const multibody::Row& row : model_.rows) has_stops = has_stops || row.law.limit_stiffness > 0;
  if (!has_stops) return;
  starts_.assign(kDeepest, {state_, {}});
  for (std::size_t depth = 0; depth < kDeepest; ++depth) keep(depth);
}

void MechanicsSubsystem::keep(std::size_t depth) noexcept {
  Start& start = starts_[depth];
  multibody::copy_state(state_, start.state);
  // of one size always, for which there is room from the first time on
  start.mechanism.clear();
  StateWriter bytes(start.mechanism, kPart);
  mechanism_.save(bytes);
  bytes.finish();
}

void MechanicsSubsystem::go_back(std::size_t depth) noexcept {
  const Start& start = starts_[depth];
  multibody::copy_state(start.state, state_);
  StateReader bytes(start.mechanism, kPart);
  mechanism_.load(bytes);
  for (std::size_t k = 0; k < active_.size() && active_[k] < ports_.size(); ++k) ports_[active_[k]].z = z_begin_[k];
  a_free_trends_.clear();
  is_evaluated_ = false;
}

bool MechanicsSubsystem::comes_near_stop(double h) const noexcept {
  for (std::size_t row = 0; row < model_.rows.size(); ++row) {
    const bool is_port = row < ports_.size();
    const double x = (is_port ? ports_[row].offset : 0) + ratio_of(row) * workspace_.row_x[row];
    const double reach = kNear * h * std::fabs(ratio_of(row) * workspace_.row_v[row]);
    if (stop_at(row, x - reach).stiffness > 0 || stop_at(row, x + reach).stiffness > 0) return true;
  }
  return false;
}

MechanicsSubsystem::Stop MechanicsSubsystem::stop_at(std::size_t row, double x) const noexcept {
  if (row < ports_.size()) {
    const coupling::LineForceDef& def = ports_[row].law.def();
    const math::StopForce stop = math::stop_force(x, 0, def.stroke_min, def.stroke_max, def.stop_stiffness, 0);
    return {stop.force, -stop.d_x};
  }
  const multibody::JointLaw& law = model_.rows[row].law;
  if (!(law.limit_stiffness > 0)) return {};
  const math::StopForce stop = math::stop_force(x, 0, law.limit_min, law.limit_max, law.limit_stiffness, 0);
  return {stop.force, -stop.d_x};
}

// Energy f^2/2k of a stop's spring, as a speed of the row's mass 1/W. After a sub-step, evaluated at its end.
bool MechanicsSubsystem::strays_in_stop(double h) noexcept {
  const std::size_t rows = active_.size();
  for (std::size_t k = 0; k < rows; ++k) {
    const std::size_t row = active_[k];
    const double x = (row < ports_.size() ? ports_[row].offset : 0) + ratio_of(row) * workspace_.row_x[row];
    const Stop there = stop_at(row, x), expected = stop_at(row, dynamics_.x()[k]);
    const double stiffness = std::max(there.stiffness, expected.stiffness);
    if (!(stiffness > 0)) continue;
    const double speed =
        std::max({std::fabs(v_begin_[k]), std::fabs(dynamics_.v()[k]), h * std::fabs(dynamics_.a_free()[k])});
    if (std::fabs(x - dynamics_.x()[k]) > kMostStray * h * speed) return true;
    const double energy = std::fabs(there.force * there.force - expected.force * expected.force) / stiffness;
    if (dynamics_.W()[k * rows + k] * energy > kMostStray * kMostStray * speed * speed) return true;
  }
  return false;
}

void MechanicsSubsystem::take_substep(const StepContext& step, double h, bool is_first, std::size_t depth) noexcept {
  evaluate();
  const bool may_stray = !starts_.empty() && comes_near_stop(h);
  if (may_stray && depth < kDeepest) keep(depth);
  coupling::PortStep solved = advance(step.n, h, step.partner, is_first);
  if (may_stray && solved.meets_stop) {
    evaluate();
    if (strays_in_stop(h)) {
      if (depth < kDeepest) {
        go_back(depth);
        for (int part = 0; part < kParts; ++part) take_substep(step, h / kParts, false, depth + 1);
        // those of parts are over other times
        a_free_trends_.clear();
        return;
      }
      solved.has_converged = false;
    }
  }
  if (!solved.has_converged) step.report.raise(StepFlag::not_converged);
  step.report.iterations += static_cast<std::uint32_t>(solved.iterations + mechanism_.iterations());
  step.report.substeps += static_cast<std::uint32_t>(mechanism_.parts());
  if (!(solved.residual <= step.report.residual)) step.report.residual = solved.residual;  // NaN stays
  finish_substep(step.partner, step.sample);
}

}  // namespace slew::mechanics
