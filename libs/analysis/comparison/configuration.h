// What a comparison runs: formulations, integrators and steps of one scene.
//
// Names of formulations and integrators are those that the field tables of the section `mechanics` list; whether a
// scene can run with them is what the scene's own rules say. So a comparison knows no formulation by name.
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

// What the user asks for; empty lists: all formulations, the scene's integrator, the whole, a half and a quarter of the
// scene's sub-step.
struct ComparisonWish {
  scene::SceneOptions scene;  // duration: how long; as the scene says when empty
  std::vector<std::string> formulations;
  std::vector<std::string> integrators;
  std::vector<std::string> steps;      // quantities
  std::vector<std::string> variables;  // patterns
  std::string reference_step;          // quantity; empty: an eighth of the smallest step
  int repeats = 5;                     // timed runs
};

// Names that mechanics.KEY may have; empty: there is no such key.
[[nodiscard]] std::vector<std::string> choices_of(std::string_view key);
// The one that the scene has chosen.
[[nodiscard]] std::string choice_of(const scene::Scene& scene, std::string_view key);

// Every combination, by formulation, integrator, step: `own` by the name of the rule that the formulation has, `all`
// integrators those of the formulation. Throws Failure (bad_input) for names and steps that cannot be.
[[nodiscard]] std::vector<Configuration> configurations(const ComparisonWish& wish, const scene::Scene& scene);

// Formulation and integrator of a scene that does not choose.
[[nodiscard]] Configuration default_configuration(double step);

// Sub-step of the reference: it divides H evenly into an even number of parts.
[[nodiscard]] double reference_step(const ComparisonWish& wish, const scene::Scene& scene, double smallest_step);

// The scene in this configuration, or why its rules refuse it.
struct Configured {
  std::optional<scene::Scene> scene;
  std::string refusal;
};
[[nodiscard]] Configured load(const ComparisonWish& wish, const scene::Scene& base, const Configuration& configuration);

// "0.25 ms"
[[nodiscard]] std::string step_text(double step);

}  // namespace slew::analysis
