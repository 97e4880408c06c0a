// SPDX-License-Identifier: Apache-2.0
// The hard cases of a scene: the changes made to it, and the bounds of its results. Built from the scene's contents,
// never from its name.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/extremes/judge.h"
#include "core/time.h"
#include "scene/scene.h"
#include "scene/scene_options.h"

namespace slew::analysis {

enum class CaseGroup : std::uint8_t { machine, hydraulics, coupling, numbers };

// All inputs from this time on, as a share of full; they jump, without the dead zones and ramps of the scene.
struct InputPoint {
  double at = 0;  // s
  double raw = 0;
};

// A live parameter that takes this value within one step.
struct SuddenChange {
  double at = 0;  // s
  std::string path;
  double value = 0;  // SI
};

// Subject of the case; the table reports when it did not occur.
enum class Aim : std::uint8_t { none, limit, cavitation, relief };

struct ExtremeCase {
  std::string name{};  // unique
  CaseGroup group = CaseGroup::machine;
  std::string what{};                // for people
  std::string obstacle{};            // why it does not apply to this scene; empty: it does
  double duration = 3;               // s
  scene::Overrides overrides{};      // changes of the scene
  std::vector<InputPoint> inputs{};  // none: neutral
  bool alternates = false;           // inputs go from one end to the other at every step
  std::vector<SuddenChange> changes{};
  StepIndex delay = 0;        // steps that every sample comes late
  StepIndex lost = 0;         // samples lost in a row, of every kLossPeriod
  double hold_at = -1;        // s; from there no step is done for kHold of wall time; < 0: none
  std::int64_t begin_ns = 0;  // time of the first step
  double stiffness = 0;       // K H^2 W to be reached by the step, then by stiffer oil and hoses; 0: as it is
  bool penetrates = false;    // a shape is moved into its partner before the start
  Aim aim = Aim::none;
  ComparedWith compared_with = ComparedWith::none;
  Bounds bounds{};
  bool seeks_edge = true;  // the largest stable step is looked for
};

inline constexpr StepIndex kLossPeriod = 100;           // steps
inline constexpr SimDuration kHold = {10'000'000'000};  // wall time

// All cases in the order of the table, those that do not apply with their obstacle.
[[nodiscard]] std::vector<ExtremeCase> extreme_cases(const scene::Scene& scene);

// Why a case would change nothing of the scene that these options load: an obstacle; empty: it changes something. Loads
// the scene once more.
[[nodiscard]] std::string lack_of_effect(const ExtremeCase& one, const scene::SceneOptions& options,
                                         const scene::Scene& scene);

[[nodiscard]] std::string_view to_text(CaseGroup group) noexcept;

// The shape of a pair that is Ground's, when the other one is a body's; null otherwise.
[[nodiscard]] const multibody::ShapeDef* ground_shape(const scene::Scene& scene, const multibody::ContactPairDef& pair);

// Value of all inputs at t: that of the last point before it.
[[nodiscard]] double raw_at(std::span<const InputPoint> points, double t) noexcept;

// The scene's hoses with this content [m3] each, as overrides; none without hoses.
[[nodiscard]] scene::Overrides hoses_of(const scene::Scene& scene, double content);
// Oil and walls stiffer by a factor, without air.
[[nodiscard]] scene::Overrides stiffer_by(const scene::Scene& scene, double factor);

}  // namespace slew::analysis
