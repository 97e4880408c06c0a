// SPDX-License-Identifier: Apache-2.0
#include "monolith/monolith.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/check.h"
#include "multibody/motions/drive.h"
#include "multibody/motions/motion_pieces.h"

namespace slew::monolith {
namespace {

// interval for closing loops in the solver's values: the violation grows with the square of the time
constexpr SimDuration kWindow = {50'000'000};

std::vector<double> tolerances(const SceneEquations& equations, double factor) {
  std::vector<double> absolute = equations.absolute_scales();
  for (double& a : absolute) a *= factor;
  return absolute;
}

}  // namespace

Monolith::Monolith(const scene::Scene& scene, MonolithOptions options)
    : equations_(scene),
      solver_(*this, tolerances(equations_, options.absolute_tolerance), options.relative_tolerance),
      slope_(scene.inputs.size()),
      control_end_(scene.inputs.size()),
      slope_now_(scene.inputs.size()),
      y_(equations_.size()),
      values_(equations_.variables().size()) {}

Status Monolith::start() {
  const Status status = equations_.start(y_);
  if (!status.is_ok()) return status;
  std::fill(control_end_.begin(), control_end_.end(), 0.0);
  std::fill(slope_now_.begin(), slope_now_.end(), 0.0);
  time_ = closed_at_ = {};
  solver_.restart(0, y_);
  must_restart_ = true;
  equations_.observe(0, y_.data());
  return Status::ok();
}

void Monolith::restart_with(std::span<const double> controls, std::span<const double> slopes) {
  equations_.set_controls(time_.seconds(), controls, slopes);
  const std::span<const double> now = solver_.y();
  std::copy(now.begin(), now.end(), y_.begin());
  equations_.normalize(y_);
  solver_.restart(time_.seconds(), y_);
  slope_now_.assign(slopes.begin(), slopes.end());
  must_restart_ = false;
}

// To t_end, with the accelerations of prescribed motions before a jump there, from those behind one at the start.
std::string Monolith::advance_piece(double t_end) {
  if (multibody::is_jump_at(equations_.model().drives, solver_.time())) {
    const std::span<const double> now = solver_.y();
    std::copy(now.begin(), now.end(), y_.begin());
    solver_.restart(solver_.time(), y_);
  }
  equations_.set_until(t_end);
  std::string failure = solver_.advance(t_end);
  equations_.set_until(multibody::kNever);
  return failure;
}

// Stops within prescribed motions that are over between two of the solver's own steps: it would step across a ramp from
// rest to rest. Stops where the acceleration of one jumps: the solver's polynomials do not hold across.
std::string Monolith::advance_solver(double t_end) {
  const std::vector<multibody::Drive>& drives = equations_.model().drives;
  const double start = solver_.time(), h = t_end - start;
  if (multibody::is_motion_fast(drives, multibody::kResolutionOfRungeKutta, start, h)) {
    for (double done = 0; done < h;) {
      const double rest = h - done;
      const double piece = multibody::motion_piece(drives, multibody::kResolutionOfRungeKutta, start + done, rest, h);
      if (piece >= rest) break;
      done += piece;
      if (std::string failure = advance_piece(start + done); !failure.empty()) return failure;
    }
  }
  return advance_piece(t_end);
}

// window by window, with the loops closed in the solver's own values at the end of each
std::string Monolith::advance_closed(SimTime t) {
  SimTime now = time_;
  while (now < t) {
    const SimTime end = closed_at_ + kWindow;
    now = std::min(t, end);
    if (std::string failure = advance_solver(now.seconds()); !failure.empty()) return failure;
    if (now < end) continue;
    const std::span<const double> values = solver_.y();
    std::copy(values.begin(), values.end(), y_.begin());
    if (!equations_.close(now.seconds(), y_)) return "the loops cannot be closed";
    closed_at_ = now;
    solver_.restart(now.seconds(), y_);
  }
  return {};
}

Status Monolith::advance_to(SimTime t, std::span<const double> controls) {
  return advance_to(t, controls, controls);
}

Status Monolith::advance_to(SimTime t, std::span<const double> controls_begin, std::span<const double> controls_end) {
  SLEW_CHECK(t > time_ && controls_begin.size() == slope_.size() && controls_end.size() == slope_.size());
  const double duration = (t - time_).seconds();
  bool has_kink = must_restart_;
  for (std::size_t i = 0; i < slope_.size(); ++i) {
    slope_[i] = (controls_end[i] - controls_begin[i]) / duration;
    // a continued ramp may differ by rounding
    const double rounding = 1e-9 * std::max(std::fabs(slope_[i]), std::fabs(slope_now_[i]));
    has_kink = has_kink || controls_begin[i] != control_end_[i] || std::fabs(slope_[i] - slope_now_[i]) > rounding;
    control_end_[i] = controls_end[i];
  }
  if (has_kink) restart_with(controls_begin, slope_);
  const std::string failure = equations_.has_loops() ? advance_closed(t) : advance_solver(t.seconds());
  const std::span<const double> y = solver_.y();
  time_ = t;
  equations_.observe(solver_.time(), y.data());
  if (const std::string pair = equations_.touching_pair(); !pair.empty()) {
    return Status::error(ExitCode::failed, "the shapes of " + pair + " touch at " + std::to_string(solver_.time()) +
                                               " s: a monolithic solution does not follow contacts; leave the pair "
                                               "out of the scene, or run it split");
  }
  if (failure.empty()) return Status::ok();
  return Status::error(ExitCode::diverged,
                       "the reference integration ended at " + std::to_string(solver_.time()) + " s (" + failure +
                           "); it could not follow " + equations_.state_name(solver_.worst_state()) +
                           "; check the scene at that time, or set another tolerance" +
                           (equations_.has_loops() ? "; a loop whose links lie in one line there (a change point, a "
                                                     "dead centre of its drive) has no unique motion"
                                                   : ""));
}

Status Monolith::set_parameter(std::string_view path, double value) {
  must_restart_ = true;
  return equations_.set_parameter(path, value);
}

double Monolith::variable(std::string_view name) {
  const std::span<const ElementVariable> all = variables();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].name != name) continue;
    read_variables(values_);
    return values_[i];
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace slew::monolith
