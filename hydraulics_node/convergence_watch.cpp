// SPDX-License-Identifier: Apache-2.0
#include "hydraulics_node/convergence_watch.h"

#include <fmt/format.h>

#include <algorithm>

namespace slew::hydraulics_node {
namespace {

using hydraulics::Solver;

bool is_unsolved(const StepReport& report) noexcept {
  return report.has(StepFlag::not_converged) || (report.has(StepFlag::step_budget) && report.residual > 1);
}

const char* remedy_of(Solver solver) noexcept {
  switch (solver) {
    case Solver::rk4:
      return "Use a shorter hydraulics.max_substep, or hydraulics.solver: rodas3";
    case Solver::implicit_euler:
      return "Use a shorter hydraulics.max_substep, a larger hydraulics.substep_budget, or hydraulics.solver: rodas3";
    case Solver::rodas3:
    case Solver::cvode:
      break;
  }
  return "Use a larger hydraulics.substep_budget or a shorter session.step, and look at the smallest volumes and "
         "widest openings beside it";
}

}  // namespace

template <typename... Values>
void ConvergenceWatch::write(const char* form, const Values&... values) noexcept {
  const auto written = fmt::format_to_n(text_.data(), text_.size(), fmt::runtime(form), values...);
  text_length_ = std::min(written.size, text_.size());
}

void ConvergenceWatch::write_out_of_barrel(std::string_view cylinder, const hydraulics::Barrel& barrel,
                                           double stroke) noexcept {
  write(
      "{}: its piston is at {:.4g} m, {:.3g} m out of its barrel, in which it goes from {:.4g} to {:.4g} m: its "
      "stop does not hold it. Give it an end_stiffness, or a larger one, or limit what presses it on",
      cylinder, stroke, barrel.beyond(stroke), barrel.begin, barrel.end);
}

bool ConvergenceWatch::ends_run(const StepReport& report, const hydraulics::CircuitIntegrator& integrator,
                                std::string_view offender, std::string_view beyond_waves) noexcept {
  if (integrator.last_report().is_impossible) {
    write(
        "{}: no sub-step solves it within the budget: the last one tried has an error above 1 % of its size, or leaves "
        "more room without oil than oil has flowed out; the state before the step is kept. {}",
        offender, remedy_of(solver_));
    return true;
  }
  if (integrator.beyond_waves() >= 0) {
    write(
        "{}: its chamber of level tlm closed a space of vapour or soft oil within one step, and its waves cannot "
        "follow that: the pressure would be that of the step, not of the machine. Use coupling: two for its cylinder, "
        "or a "
        "shorter session.step",
        beyond_waves);
    return true;
  }
  unsolved_ = std::clamp(unsolved_ + (is_unsolved(report) ? 1 : -1), 0, kMostUnsolved);
  if (unsolved_ < kMostUnsolved) return false;
  if (solver_ != Solver::rk4 && integrator.overdrawn() >= 0) {
    write(
        "{}: more oil was drawn from it than it holds, for more than half of the last steps: what flows out of it is "
        "no oil. Give it a supply (an anti-cavitation valve, a larger inlet), or stop what draws from it",
        offender);
  } else if (solver_ == Solver::rk4) {
    write(
        "{}: of late more sub-steps of rk4 were too long for the circuit than were not, and the pressures are wrong. "
        "{}",
        offender, remedy_of(solver_));
  } else {
    write("{}: of late more steps were accepted with their error than were solved, and the pressures are wrong. {}",
          offender, remedy_of(solver_));
  }
  return true;
}

}  // namespace slew::hydraulics_node
