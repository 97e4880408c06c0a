// SPDX-License-Identifier: Apache-2.0
#include "analysis/description/eigenvalues.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "analysis/comparison/configuration.h"
#include "analysis/description/instant.h"
#include "core/display.h"
#include "core/failure.h"
#include "core/json.h"
#include "core/report_table.h"

namespace slew::analysis {
namespace {

using monolith::SceneMode;
using monolith::StateOwner;

// owners that are named: those with this part of the largest share
constexpr double kNamedShare = 0.25;
constexpr std::size_t kNamedOwners = 3;
// points on a period, or on a time constant's 2 pi, that resolve its course
constexpr double kPointsOnPeriod = 20;

double frequency(const SceneMode& mode) {
  return std::fabs(mode.value.imag()) / (2 * std::numbers::pi);
}

double damping_ratio(const SceneMode& mode) {
  return -mode.value.real() / std::abs(mode.value);
}

double step_to_follow(const SceneMode& mode) {
  return 2 * std::numbers::pi / std::abs(mode.value) / kPointsOnPeriod;
}

std::string owner_text(const StateOwner& owner) {
  switch (owner.kind) {
    case StateOwner::Kind::joint:
      return "joint " + owner.name;
    case StateOwner::Kind::volume:
      return "volume " + owner.name;
    case StateOwner::Kind::mode:
    case StateOwner::Kind::component:
    case StateOwner::Kind::port:
      break;
  }
  return owner.name;
}

std::string owners_text(const SceneMode& mode) {
  std::string text;
  const std::size_t most = std::max<std::size_t>(kNamedOwners, static_cast<std::size_t>(mode.count));
  for (std::size_t i = 0; i < std::min(most, mode.owners.size()); ++i) {
    if (mode.owners[i].share < kNamedShare * mode.owners[0].share) break;
    text += fmt::format("{}{} {:.0f} %", text.empty() ? "" : ", ", owner_text(mode.owners[i].owner),
                        100 * mode.owners[i].share);
  }
  return mode.count > 1 ? fmt::format("{} equal: {}", mode.count, text) : text;
}

std::string time_text(double seconds) {
  return std::isinf(seconds) ? "none" : duration_text(seconds);
}

std::vector<ReportCell> row(const SceneMode& mode) {
  const double decay = -1 / mode.value.real();
  const bool grows = mode.value.real() > 0;
  return {fmt::format("{:.4g}", std::abs(mode.value)),
          frequency(mode) > 0 ? fmt::format("{:.4g} Hz", frequency(mode)) : "-",
          frequency(mode) > 0 ? fmt::format("{:.3g}", damping_ratio(mode)) : "-",
          grows ? "grows in " + time_text(-decay) : time_text(decay),
          grows ? "-" : time_text(monolith::longest_runge_kutta_step(mode.value)),
          time_text(step_to_follow(mode)),
          owners_text(mode)};
}

std::string table_text(std::span<const SceneMode> modes, std::size_t width) {
  ReportTable table({"|lambda| [1/s]", "frequency", "damping", "time constant", "RK4 up to", "followed by", "owner"});
  for (const SceneMode& mode : modes) table.add(row(mode));
  return table.text("  ", width);
}

// the eigenvalues that limit each solver of the scene
std::string solvers_text(const Eigenvalues& found) {
  std::string text;
  if (found.substep > 0) {
    text += fmt::format("mechanics: {}, {}, sub-step {}; cylinders and friction and limits of joints are implicit. ",
                        found.formulation, found.integrator, duration_text(found.substep));
    if (found.explicit_part.modes.empty()) {
      text += "With their forces held nothing else moves by itself.\n";
    } else {
      const SceneMode& fastest = found.explicit_part.modes.front();
      const double limit = monolith::longest_runge_kutta_step(fastest.value);
      text += fmt::format("With their forces held the fastest is {:.4g} 1/s ({}): RK4 up to {}",
                          std::abs(fastest.value), owners_text(fastest), time_text(limit));
      text += limit < found.substep ? fmt::format(
                                          ", LESS than the sub-step: set mechanics.max_substep below it, or take "
                                          "an implicit mechanics.integrator\n")
                                    : "\n";
    }
  }
  if (!found.hydraulics_solver.empty()) {
    const bool has_limit = found.hydraulics_solver == "rk4";
    text += fmt::format("hydraulics: {}{}\n", found.hydraulics_solver,
                        has_limit ? ", sub-steps below the column 'RK4 up to' of volumes and components"
                                  : ", implicit: its sub-steps are chosen by error, no eigenvalue limits them");
  }
  text += fmt::format("communication: step {}; what is faster than {:.4g} 1/s happens within it\n",
                      duration_text(found.step), 2 * std::numbers::pi / (kPointsOnPeriod * found.step));
  return text;
}

Json to_json(const SceneMode& mode) {
  Json owners = Json::array();
  for (const monolith::OwnerShare& one : mode.owners) {
    owners.push_back({{"owner", owner_text(one.owner)}, {"share", one.share}});
  }
  Json json = {{"real", mode.value.real()},
               {"imaginary", mode.value.imag()},
               {"count", mode.count},
               {"frequency", frequency(mode)},
               {"damping_ratio", damping_ratio(mode)},
               {"step_to_follow", step_to_follow(mode)},
               {"owners", owners}};
  const double limit = monolith::longest_runge_kutta_step(mode.value);
  if (std::isfinite(limit)) json["largest_rk4_step"] = limit;
  return json;
}

}  // namespace

Eigenvalues find_eigenvalues(const scene::Scene& scene, double at, DryFriction friction) {
  PlayedScene played(scene);
  play_to(played, at);
  Eigenvalues found;
  found.at = played.time().seconds();
  found.friction = friction;
  found.step = scene.session.step;
  const mechanics_node::MechanicsSubsystem* mechanics = mechanics_of(played);
  const hydraulics_node::HydraulicsSubsystem* hydraulics = hydraulics_of(played);
  if (mechanics == nullptr) {
    throw Failure(ExitCode::bad_input, "the scene has no bodies; eigenvalues are those of a machine with mechanics");
  }
  monolith::SceneEquations equations(scene);
  std::vector<double> y(equations.size());
  if (hydraulics == nullptr) {
    equations.take(mechanics->model(), mechanics->state(), nullptr, {}, y);
  } else {
    equations.take(mechanics->model(), mechanics->state(), &hydraulics->circuit(), hydraulics->integrator().state(), y);
  }
  const std::vector<double> slopes(scene.inputs.size());
  equations.set_controls(found.at, played.controls(), slopes);
  if (friction == DryFriction::neglected) equations.neglect_dry_friction();
  require(find_modes(equations, found.at, y, monolith::Part::all, found.machine));
  require(find_modes(equations, found.at, y, monolith::Part::mechanics_with_held_rows, found.explicit_part));
  found.touching = equations.touching_pair();
  found.formulation = choice_of(scene, "formulation");
  found.integrator = choice_of(scene, "integrator");
  found.substep = found.step / multibody::substep_count(mechanics->model(), found.step);
  if (hydraulics != nullptr)
    found.hydraulics_solver = hydraulics::kSolverChoices[static_cast<std::size_t>(scene.hydraulics.solver)];
  return found;
}

std::string report_text(const Eigenvalues& found, std::size_t count, std::size_t width) {
  const std::vector<SceneMode>& modes = found.machine.modes;
  std::string text = fmt::format("eigenvalues at {} of {} free states{}; {} of them at rest (slower than {:g} 1/s)\n",
                                 duration_text(found.at), found.machine.states,
                                 found.friction == DryFriction::neglected ? ", dry friction neglected" : "",
                                 found.machine.at_rest, monolith::kSlowestRate);
  if (!found.touching.empty())
    text += fmt::format("{} touches: the bristles of its friction are held\n", found.touching);
  if (modes.size() <= 2 * count) {
    text += "\n" + table_text(modes, width);
  } else {
    text += fmt::format("\nfastest {} of {}\n", count, modes.size()) + table_text(std::span(modes).first(count), width);
    text += fmt::format("\nslowest {}\n", count) + table_text(std::span(modes).last(count), width);
  }
  return text + "\n" + solvers_text(found);
}

Json report_json(const Eigenvalues& found) {
  Json machine = Json::array(), explicit_part = Json::array();
  for (const SceneMode& mode : found.machine.modes) machine.push_back(to_json(mode));
  for (const SceneMode& mode : found.explicit_part.modes) explicit_part.push_back(to_json(mode));
  return {{"at", found.at},
          {"dry_friction", found.friction == DryFriction::kept},
          {"free_states", found.machine.states},
          {"at_rest", found.machine.at_rest},
          {"modes", machine},
          {"mechanics_with_held_rows", explicit_part},
          {"formulation", found.formulation},
          {"integrator", found.integrator},
          {"step", found.step},
          {"substep", found.substep},
          {"touching", found.touching}};
}

}  // namespace slew::analysis
