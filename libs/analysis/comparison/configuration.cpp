// SPDX-License-Identifier: Apache-2.0
#include "analysis/comparison/configuration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "multibody/formulations/integrators.h"
#include "multibody/model/field_tables.h"
#include "scene/units.h"

namespace slew::analysis {
namespace {

constexpr std::string_view kFormulation = "formulation", kIntegrator = "integrator", kSubstep = "max_substep",
                           kOwnIntegrator = "own";
constexpr double kSameRatio = 1e-9;    // relative rounding error of a ratio of steps that counts as whole
constexpr double kReferenceRatio = 8;  // ratio of the smallest step to the reference's: RK4 is then 4096 times better
constexpr double kDefaultRatios[] = {1, 0.5, 0.25};  // shares of the scene's sub-step

const Field* find_field(std::string_view key) {
  for (const Field& field : multibody::mechanics_fields()) {
    if (field.key == key) return &field;
  }
  return nullptr;
}

[[noreturn]] void refuse(const std::string& text) {
  throw Failure(ExitCode::bad_input, text + "; nothing was run");
}

// the selected names in their order, none twice
std::vector<std::string> select(const char* option, const std::vector<std::string>& wanted,
                                const std::vector<std::string>& available) {
  std::vector<std::string> chosen;
  const auto add = [&chosen](const std::string& name) {
    if (std::find(chosen.begin(), chosen.end(), name) == chosen.end()) chosen.push_back(name);
  };
  for (const std::string& name : wanted) {
    if (name == "all") {
      for (const std::string& each : available) add(each);
    } else if (std::find(available.begin(), available.end(), name) != available.end()) {
      add(name);
    } else {
      refuse(fmt::format("{}: there is no '{}' in this version; expected all, or some of {}", option, name,
                         fmt::join(available, ", ")));
    }
  }
  return chosen;
}

// Integrators of a formulation: what is wanted, with its own rule by its name and with all that it has for "all".
std::vector<std::string> integrators_for(const std::string& formulation, const std::vector<std::string>& wanted) {
  const std::vector<std::string> formulations = choices_of(kFormulation);
  const auto index = std::find(formulations.begin(), formulations.end(), formulation) - formulations.begin();
  const auto which = static_cast<multibody::Formulation>(index);
  std::vector<std::string> chosen;
  const auto add = [&chosen](std::string_view name) {
    if (std::find(chosen.begin(), chosen.end(), name) == chosen.end()) chosen.emplace_back(name);
  };
  for (const std::string& name : wanted) {
    if (name == "all") {
      for (const multibody::Integrator each : multibody::integrators_of(which)) add(multibody::key_of(each));
    } else {
      add(name == kOwnIntegrator ? multibody::key_of(multibody::own_integrator(which)) : name);
    }
  }
  return chosen;
}

bool is_whole(double ratio) {
  return std::fabs(ratio - std::round(ratio)) <= kSameRatio * ratio && ratio > 0.5;
}

double read_step(const char* option, const std::string& text) {
  scene::UnitSystem units;
  const scene::QuantityResult read = scene::read_quantity(text, scene::Writing::plain, Dimension::time, units);
  if (!read.value) refuse(fmt::format("{}: {}", option, read.problem.text()));
  const double step = *read.value;
  const Range range = find_field(kSubstep)->range;
  if (!range.contains(step)) {
    refuse(fmt::format("{}: {} is out of range; expected {} to {}", option, step_text(step), step_text(range.min),
                       step_text(range.max)));
  }
  return step;
}

std::vector<double> select_steps(const ComparisonOptions& options, const scene::Scene& scene) {
  const double H = scene.session.step;
  std::vector<double> steps;
  const auto add = [&steps](double step) {
    if (std::find(steps.begin(), steps.end(), step) == steps.end()) steps.push_back(step);
  };
  for (const std::string& text : options.steps) {
    const double step = read_step("--steps", text);
    if (!is_whole(H / step) && !is_whole(step / H)) {
      refuse(fmt::format("--steps: {} neither divides the communication step {} nor is a multiple of it",
                         step_text(step), step_text(H)));
    }
    add(step);
  }
  if (!steps.empty()) return steps;
  // the actual sub-step of the scene
  const double whole = H / std::ceil(H / scene.mechanics.max_substep * (1 - kSameRatio));
  for (const double ratio : kDefaultRatios) {
    if (find_field(kSubstep)->range.contains(ratio * whole)) add(ratio * whole);
  }
  return steps;
}

}  // namespace

std::vector<std::string> choices_of(std::string_view key) {
  std::vector<std::string> names;
  if (const Field* field = find_field(key)) names.assign(field->choices.begin(), field->choices.end());
  return names;
}

std::string choice_of(const scene::Scene& scene, std::string_view key) {
  const Field* field = find_field(key);
  if (field == nullptr) return {};
  return std::string(field->choices[static_cast<std::size_t>(field->get_choice(&scene.mechanics))]);
}

std::vector<Configuration> configurations(const ComparisonOptions& options, const scene::Scene& scene) {
  const std::vector<std::string> all = {"all"}, scenes_own = {choice_of(scene, kIntegrator)};
  const auto formulations =
      select("--formulations", options.formulations.empty() ? all : options.formulations, choices_of(kFormulation));
  const std::vector<std::string>& wanted = options.integrators.empty() ? scenes_own : options.integrators;
  // wrong names are refused here
  static_cast<void>(select("--integrators", wanted, choices_of(kIntegrator)));
  std::vector<Configuration> result;
  for (const std::string& formulation : formulations) {
    for (const std::string& integrator : integrators_for(formulation, wanted)) {
      for (const double step : select_steps(options, scene)) result.push_back({formulation, integrator, step});
    }
  }
  return result;
}

Configuration default_configuration(double step) {
  const scene::Scene scene;
  const std::string formulation = choice_of(scene, kFormulation);
  return {formulation, integrators_for(formulation, {choice_of(scene, kIntegrator)}).front(), step};
}

double reference_step(const ComparisonOptions& options, const scene::Scene& scene, double smallest_step) {
  const double H = scene.session.step;
  const double wanted = options.reference_step.empty() ? smallest_step / kReferenceRatio
                                                       : read_step("--reference", options.reference_step);
  const double shortest = find_field(kSubstep)->range.min;
  const double parts = 2 * std::ceil(H / (2 * std::max(wanted, shortest)) * (1 - kSameRatio));
  // rounding must not make it shorter than a scene allows
  return H / parts < shortest ? H / (parts - 2) : H / parts;
}

Configured load(const ComparisonOptions& options, const scene::Scene& base, const Configuration& configuration) {
  scene::SceneOptions scene_options = options.scene;
  const auto set = [&scene_options](std::string_view path, const std::string& value) {
    scene_options.overrides.push_back(fmt::format("{}={}", path, value));
  };
  set("mechanics.formulation", configuration.formulation);
  set("mechanics.integrator", configuration.integrator);
  set("mechanics.max_substep", fmt::format("{:.17g}", configuration.step));
  if (configuration.step > base.session.step) set("session.step", fmt::format("{:.17g}", configuration.step));
  try {
    return {scene::load_scene(scene_options), ""};
  } catch (const scene::LoadError& error) {
    return {std::nullopt, error.first_reason()};
  }
}

std::string step_text(double step) {
  return fmt::format("{:.6g} ms", step * 1e3);
}

}  // namespace slew::analysis
