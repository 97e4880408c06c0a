// What of a scene may be left out or taken more coarsely: settings to try, from what the scene contains.
//
// Every candidate is a list of `--set` settings. Which keys a part has is asked of the field tables: what this version
// does not know is not proposed. Whether a scene can run with a setting is what its own rules say.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"

namespace slew::analysis {

struct Candidate {
  std::string title;  // "contact pair Bag_Truck, which never touched"
  std::string group;  // of those with the same group one at most is taken
  scene::Overrides settings;
};

// What the run of the scene as it is has shown.
struct RunFindings {
  std::vector<std::string> untouched_pairs;  // no contact at any step
  std::vector<std::string> still_joints;     // whose coordinate never changed by more than kStill
};

inline constexpr double kStill = 1e-6;  // rad or m

// Contact pairs that never touched, modes of flexible bodies, volumes as quasi-static, joints that did not move,
// tolerances and steps. Every factor of a communication step divides kStepsPerSample.
[[nodiscard]] std::vector<Candidate> candidates(const scene::Scene& scene, const RunFindings& found);

inline constexpr int kStepsPerSample = 10;

}  // namespace slew::analysis
