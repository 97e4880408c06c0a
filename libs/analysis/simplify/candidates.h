// SPDX-License-Identifier: Apache-2.0
// Candidates for a simpler scene: settings that leave out parts of it or coarsen them, from the scene's contents.
//
// Every candidate is a list of `--set` settings. The field tables have the keys of a part: a key that this version
// lacks is not proposed. The scene's own rules decide whether it can run with a setting.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"

namespace slew::analysis {

struct Candidate {
  std::string title;  // "contact pair Bag_Truck, which never touched"
  std::string group;  // at most one candidate of a group is taken
  scene::Overrides settings;
};

// Findings of the run of the unchanged scene.
struct RunFindings {
  std::vector<std::string> untouched_pairs;  // no contact at any step
  std::vector<std::string> still_joints;     // joints whose coordinate never changed by more than kStill
};

inline constexpr double kStill = 1e-6;  // rad or m

// Contact pairs that never touched, modes of flexible bodies, volumes as quasi-static, joints that did not move,
// tolerances and steps. Every factor of a communication step divides kStepsPerSample.
[[nodiscard]] std::vector<Candidate> candidates(const scene::Scene& scene, const RunFindings& found);

inline constexpr int kStepsPerSample = 10;

}  // namespace slew::analysis
