// SPDX-License-Identifier: Apache-2.0
// A mechanism whose force elements have constant slopes, each the steepest of its own law, for the check of explicit
// integrators (element_speeds.h). Internal to the library.
//
//   table of a spring or damper   its steepest slope, wherever that is
//   end damper                    k_e and d_e beside spring and damper, on both sides (Ends::touched), or none
//   rope                          taut, with k and d
//   tyre                          on the ground: k and c, and the slip about rest under the normal force of the start
// Force and pose at the start stay as they are, so that the pull of preloads across their lines is right. Left out:
// gravity, contacts of shapes, loads. Not covered: the normal force of a tyre that starts above the ground.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "multibody/model/model.h"

namespace slew::multibody {

// slack: springs of tables, ropes and tyres do not act, since a damper that is too fast alone may be followed beside
// them. alone: touched ends, ropes and tyres without any other force.
enum class Ends { slack, free, touched, alone };

[[nodiscard]] Model with_steepest_laws(const Model& given, Ends ends);
// Whether an end damper can be touched.
[[nodiscard]] bool has_ends(const Model& model);
// Whether a force acts on one side only: such an end damper, a rope or a tyre.
[[nodiscard]] bool has_one_sided(const Model& model);

// The same masses without any of the scene's elements; those between the segments of a body stay.
[[nodiscard]] Model without_elements(const Model& given);

// An element of the scene and what puts it back into without_elements().
struct ElementPlace {
  std::string name;
  std::function<void(Model& alone, const Model& from)> put;
};
[[nodiscard]] std::vector<ElementPlace> element_places(const Model& model);

}  // namespace slew::multibody
