// SPDX-License-Identifier: Apache-2.0
// A scene's mechanism where it begins, as a picture: bodies, joints by type, cylinders and other forces along lines,
// ropes, tyres, centres of mass, frames of the bodies, with the names in both margins.
//
// A body has its meshes for the eye, if their files are there, else its contact shapes, else bars from the joint that
// carries it to the points at which joints and forces act. Nearer faces hide farther ones (painter's algorithm: faces
// that pass through each other may be in the wrong order). Contact planes and bending are not drawn.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"

namespace slew::analysis {

enum class ViewFrom : int { side, top, front };

struct MechanismPicture {
  std::string group{};                  // SVG elements without <svg> and style
  double width = 0, height = 0;         // px
  std::vector<std::string> left_out{};  // a sentence for each mesh that cannot be read
};

// folder: of the scene's files. Pre-condition: the scene has bodies, and its models can be built.
[[nodiscard]] MechanismPicture draw_mechanism(const scene::Scene& scene, const std::string& folder, ViewFrom view);

}  // namespace slew::analysis
