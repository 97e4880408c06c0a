// SPDX-License-Identifier: Apache-2.0
// `slewring describe SCENE --cost`: what each part of a scene costs, in microseconds of this machine per simulated
// millisecond.
//
// Three ways of measuring; every line names its own:
//   steps    the scene's own run in this process, timed step by step; of each step the fastest of kRuns runs
//   calls    a function called alone on states of that run, the fastest of kCalls calls, as often as a step calls it
//   removal  the same calls for the mechanism without the part, on the same states; the difference is the part's
//   rest     what is left of the line above
// Nothing is timed inside the physics. Calls find warm caches: their sum is a lower bound, and the rest an upper one.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/json.h"
#include "scene/scene.h"

namespace slew::analysis {

inline constexpr int kRuns = 3, kCalls = 5;

enum class Measured { steps, calls, removal, rest };

struct CostLine {
  int level = 0;  // 0: a part of the whole; 1, 2: a part of the last line of the level above
  std::string part;
  double cost = 0;  // us per ms
  Measured measured = Measured::steps;
};

struct CostByPart {
  double until = 0;  // s of the scene's run
  int runs = kRuns, states = 0;
  double step = 0;   // s
  double whole = 0;  // us per ms: all physics and the exchange of samples
  std::vector<CostLine> lines;
  std::vector<std::string> notes;
};

// file and overrides: those of the scene, from which the variants without a part are read. until: s, > 0. Throws
// Failure.
[[nodiscard]] CostByPart measure_cost(const scene::Scene& scene, const std::string& file,
                                      const scene::Overrides& overrides, double until);

// not_paid: features that the scene leaves out, for a line each. width [characters]: of the lines of a table; 0: no
// limit.
[[nodiscard]] std::string report_text(const CostByPart& cost, std::span<const std::string> not_paid,
                                      std::size_t width = 0);
[[nodiscard]] Json report_json(const CostByPart& cost, std::span<const std::string> not_paid);

}  // namespace slew::analysis
