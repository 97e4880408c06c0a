// SPDX-License-Identifier: Apache-2.0
// Parts of a scene without effect: legal, and probably a mistake.
#pragma once

#include <string>
#include <vector>

#include "core/problem.h"
#include "scene/scene.h"

namespace slew::scene {

// Warnings about inputs, loads, springs, curves and keys without effect. Pre-condition: all names are resolved, the
// tables of files read.
void find_without_effect(Scene& scene, Problems& warnings);

// Warnings about points of the scene's script behind the end of its run [s] that change their input.
void find_points_behind_the_end(const Scene& scene, double end, Problems& warnings);

// Warnings about inputs that change in the table of an input file, but have no second point before the end of the run
// [s]. file: as in messages. A table may be longer than the run.
[[nodiscard]] std::vector<std::string> find_unplayed_inputs(const Scene& scene, const std::string& file, double end);

}  // namespace slew::scene
