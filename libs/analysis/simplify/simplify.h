// `slewring simplify SCENE --error "Bag.position 1mm"`: what of a scene can be left out while chosen variables change
// by less than a tolerance, and what that saves.
//
// Base is the scene as it is. Every candidate (candidates.h) is tried alone on the scene's own run in this process;
// those that hold and pay are then taken together, the largest saving first, each tried with those taken before. The
// set that is left is run once more. A change is the largest difference from the base over all samples; the base itself
// is not judged: `slewring tradeoff` and `slewring compare` do that.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/simplify/candidates.h"
#include "core/json.h"
#include "scene/scene_options.h"

namespace slew::analysis {

// A saving below this part of the cost is not told from how much a machine's time varies.
inline constexpr double kLeastSaving = 0.01;

struct SimplifyWish {
  scene::SceneOptions scene;        // duration: how long; as the scene says when empty
  std::vector<std::string> errors;  // "Bag.position 1mm", "Cyl_Lift.force 1%": of its range in the base
  int repeats = 3;                  // timed runs
};

struct Watched {
  std::string name, unit;  // SI unit
  double tolerance = 0;    // SI
  double range = 0;        // of the base run
};

struct Trial {
  Candidate candidate{};
  std::string refusal{};          // why it cannot run, or how its run ended; empty: it ran
  std::vector<double> changes{};  // largest, SI, by watched variable
  double cost = 0;                // us per ms
  bool is_taken = false;
  bool was_interrupted = false;  // before it could be judged

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
  scene::Overrides settings;  // that are taken, without the user's own
  bool is_interrupted = false;

  [[nodiscard]] bool helps() const noexcept { return !settings.empty() && !is_interrupted; }
};

// Index of the watched variable with the largest change over its tolerance.
[[nodiscard]] std::size_t worst_of(const std::vector<Watched>& watched, const Trial& trial);
[[nodiscard]] bool holds(const std::vector<Watched>& watched, const Trial& trial);

// Told what is under way and which share of all is done; false ends it.
using SimplifyProgress = std::function<bool(std::string_view doing, double share)>;

// What so many steps of a scene cost, us per simulated ms.
using SimplifyCost = std::function<double(const scene::Scene& scene, StepIndex steps)>;

// cost: where it is not to be measured. Throws LoadError for a scene that is wrong, Failure for a wish that cannot be
// met or a base that fails.
[[nodiscard]] Simplification simplify(const SimplifyWish& wish, const SimplifyProgress& progress,
                                      const SimplifyCost& cost = {});

// width [characters]: of the lines of a table; 0: no limit.
[[nodiscard]] std::string report_text(const Simplification& result, std::size_t width = 0);
[[nodiscard]] Json report_json(const Simplification& result);

}  // namespace slew::analysis
