// SPDX-License-Identifier: Apache-2.0
// A recorded motion as a page with a time slider, or as a picture of some instants: side view and top view of the
// machine's lines.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "analysis/animation/machine_drawing.h"
#include "math/rotation.h"
#include "math/vector3.h"

namespace slew::analysis {

struct Pose {
  math::Vec3 position{};           // m, in Ground
  math::Quaternion orientation{};  // orientation of the body in Ground
};

// A time without recorded poses.
struct Gap {
  double from = 0, to = 0;  // s
};

struct Motion {
  std::string title, subtitle;
  std::vector<double> time;              // s
  std::vector<std::vector<Pose>> poses;  // by body of the drawing without Ground, then by instant
  std::vector<Gap> gaps{};               // ascending
};

// At most `instants` instants, evenly spaced, the first and the last among them.
[[nodiscard]] Motion thinned(const Motion& motion, std::size_t instants);

// The smallest n for which every n-th instant and the last one are at most so many. Pre-condition: at least 2.
[[nodiscard]] std::size_t stride_for(const Motion& motion, std::size_t most);
[[nodiscard]] Motion every_nth(const Motion& motion, std::size_t n);

// One file without external resources: play, slider, speed, direction of the side view.
[[nodiscard]] std::string animation_html(const MachineDrawing& machine, const Motion& motion);

// All instants of the motion over each other, the last one darkest. Pre-condition: at least one.
[[nodiscard]] std::string animation_svg(const MachineDrawing& machine, const Motion& motion);

}  // namespace slew::analysis
