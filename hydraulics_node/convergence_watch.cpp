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

// Sound steps that take back what this one counts.
int weight_of(const StepReport& report, double accepted_error) noexcept {
  if (!is_unsolved(report)) return -1;
  const double share = accepted_error / kMostError;
  return share < 1 ? 1 + static_cast<int>(share * kMostUnsolved) : kMostUnsolved;
}

constexpr const char* kOverdrawn =
    "{}: more oil was drawn from it than it holds, for more than half of the last steps: what flows out of it is no "
    "oil. Give it a supply (an anti-cavitation valve, a larger inlet), or stop what draws from it";

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
  return "Use a larger hydraulics.substep_budget or relative_tolerance, or a shorter session.step, and look at the "
         "smallest volumes and widest openings beside it";
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
  const double accepted = integrator.last_report().accepted_error;
  if (!count(weight_of(report, accepted))) return false;
  const std::string_view name = hydraulics::kSolverChoices[static_cast<std::size_t>(solver_)];
  if (!(accepted < kMostError)) {
    write(
        "{}: sub-steps of {} were accepted with errors that add up to {:.2g} % of its size in one step, and the "
        "pressures are wrong. {}",
        offender, name, 100 * accepted, remedy_of(solver_));
  } else if (solver_ == Solver::rk4) {
    write(
        "{}: of late more sub-steps of rk4 were too long for the circuit than were not, and the pressures are wrong. "
        "{}",
        offender, remedy_of(solver_));
  } else if (integrator.overdrawn() >= 0) {
    write(kOverdrawn, offender);
  } else {
    write(
        "{}: of late more steps of {} were accepted with an error above hydraulics.relative_tolerance than were "
        "solved. {}",
        offender, name, remedy_of(solver_));
  }
  return true;
}

bool ConvergenceWatch::ends_followed_run(bool is_overdrawn, std::string_view volume) noexcept {
  if (!count(is_overdrawn ? 1 : -1)) return false;
  write(kOverdrawn, volume);
  return true;
}

bool ConvergenceWatch::count(int weight) noexcept {
  unsolved_ = std::clamp(unsolved_ + weight, 0, kMostUnsolved);
  return unsolved_ == kMostUnsolved;
}

}  // namespace slew::hydraulics_node
