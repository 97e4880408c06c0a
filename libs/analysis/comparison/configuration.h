// SPDX-License-Identifier: Apache-2.0
// The runs of a comparison: formulations, integrators and steps of one scene.
//
// Names of formulations and integrators come from the field tables of the section `mechanics`; the scene's own rules
// decide whether it can run with them. A comparison depends on no formulation's name.
//
// A step h is the sub-step of the mechanics (mechanics.max_substep). The communication step H stays as the scene has
// it, so that input and coupling are the same in all runs; h must divide H. Only an h above H, a multiple of it,
// becomes the communication step too: then the input is sampled and the coupling exchanged once in h.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.h"
#include "scene/scene_options.h"

namespace slew::analysis {

struct Configuration {
  std::string formulation;
  std::string integrator;
  double step = 0;  // s
};

// The user's options; empty lists: all formulations, the scene's integrator, the whole, a half and a quarter of the
// scene's sub-step.
struct ComparisonOptions {
  scene::SceneOptions scene;  // duration: run time; empty: the scene's
  std::vector<std::string> formulations;
  std::vector<std::string> integrators;
  std::vector<std::string> steps;      // quantities
  std::vector<std::string> variables;  // patterns
  std::string reference_step;          // quantity; empty: an eighth of the smallest step
  int repeats = 5;                     // timed runs
};

// Valid names of mechanics.KEY; empty: there is no such key.
[[nodiscard]] std::vector<std::string> choices_of(std::string_view key);
// The scene's value of the key.
[[nodiscard]] std::string choice_of(const scene::Scene& scene, std::string_view key);

// Every combination, by formulation, integrator, step: `own` by the name of the formulation's rule, `all` for all
// integrators of the formulation. Throws Failure (bad_input) for invalid names and steps.
[[nodiscard]] std::vector<Configuration> configurations(const ComparisonOptions& options, const scene::Scene& scene);

// Formulation and integrator of a scene without a choice.
[[nodiscard]] Configuration default_configuration(double step);

// Sub-step of the reference: it divides H evenly into an even number of parts.
[[nodiscard]] double reference_step(const ComparisonOptions& options, const scene::Scene& scene, double smallest_step);

// The scene in this configuration, or the reason why its rules refuse it.
struct Configured {
  std::optional<scene::Scene> scene;
  std::string refusal;
};
[[nodiscard]] Configured load(const ComparisonOptions& options, const scene::Scene& base,
                              const Configuration& configuration);

// "0.25 ms"
[[nodiscard]] std::string step_text(double step);

}  // namespace slew::analysis
