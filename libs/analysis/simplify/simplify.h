// SPDX-License-Identifier: Apache-2.0
// `slewring simplify SCENE --error "Bag.position 1mm"`: the parts of a scene that can be left out while chosen
// variables change by less than a tolerance, and the saving.
//
// The base is the unchanged scene. Every candidate (candidates.h) is tried alone on the scene's own run in this
// process; candidates that hold and pay are then combined, the largest saving first, each tried with those taken
// before. The final set is run once more. A change is the largest difference from the base over all samples; the base
// itself is not judged: `slewring tradeoff` and `slewring compare` do that.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/simplify/candidates.h"
#include "core/json.h"
#include "scene/scene_options.h"

namespace slew::analysis {

// Smallest saving, as a part of the cost, that exceeds the scatter of a machine's timing.
inline constexpr double kLeastSaving = 0.01;

struct SimplifyOptions {
  scene::SceneOptions scene;  // duration: run time; empty: the scene's
  // "Bag.position 1mm", "Cyl_Lift.force 1%": of its range in the base; empty: 1 mm of each `payload` of the scene
  std::vector<std::string> errors;
  int repeats = 3;  // timed runs
};

struct Watched {
  std::string name, unit;  // SI unit
  double tolerance = 0;    // SI
  double range = 0;        // range in the base run
};

struct Trial {
  Candidate candidate{};
  std::string refusal{};          // why it cannot run, or how its run ended; empty: it ran
  std::vector<double> changes{};  // largest, SI, by watched variable
  double cost = 0;                // us per ms
  bool is_taken = false;
  bool was_interrupted = false;  // interrupted before it could be judged

  [[nodiscard]] bool has_run() const noexcept { return refusal.empty() && !was_interrupted; }
};

struct Simplification {
  std::string scene;
  double until = 0;  // s
  int repeats = 0;
  double base_cost = 0;  // us per ms
  std::vector<Watched> watched;
  std::vector<Trial> trials;  // each candidate alone
  Trial combined;             // all that are taken; its settings are the user's own and theirs
  scene::Overrides settings;  // settings that are taken, without the user's own
  bool is_interrupted = false;

  [[nodiscard]] bool helps() const noexcept { return !settings.empty() && !is_interrupted; }
};

// Index of the watched variable with the largest change over its tolerance.
[[nodiscard]] std::size_t worst_of(const std::vector<Watched>& watched, const Trial& trial);
[[nodiscard]] bool holds(const std::vector<Watched>& watched, const Trial& trial);

// Receives the present activity and the share of all work that is done; false ends it.
using SimplifyProgress = std::function<bool(std::string_view doing, double share)>;

// Cost of a number of steps of a scene, us per simulated ms.
using SimplifyCost = std::function<double(const scene::Scene& scene, StepIndex steps)>;

// cost: replaces the measurement. Throws LoadError for a wrong scene, Failure for options that cannot be met or a base
// that fails.
[[nodiscard]] Simplification simplify(const SimplifyOptions& options, const SimplifyProgress& progress,
                                      const SimplifyCost& cost = {});

// width [characters]: of the lines of a table; 0: no limit.
[[nodiscard]] std::string report_text(const Simplification& result, std::size_t width = 0);
[[nodiscard]] Json report_json(const Simplification& result);

}  // namespace slew::analysis
