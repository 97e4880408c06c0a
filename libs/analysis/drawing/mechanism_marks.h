// SPDX-License-Identifier: Apache-2.0
// Signs of a mechanism's picture: joints by type, cylinders, springs, ropes, tyres, centres of mass, frames.
#pragma once

#include <string>

#include "analysis/drawing/camera.h"
#include "analysis/drawing/machine_at_start.h"
#include "multibody/model/defs.h"

namespace slew::analysis {

// A joint's sign at its point. axis: z of its frame 1, unit, in Ground.
[[nodiscard]] std::string joint_sign(multibody::JointType type, math::Vec3 at, math::Vec3 axis, const Camera& camera);

// Tube from a and rod from b; or a spring with its damper.
[[nodiscard]] std::string cylinder_sign(Point a, Point b);
[[nodiscard]] std::string spring_sign(Point a, Point b);

// A point that Ground carries.
[[nodiscard]] std::string support_sign(Point at);

// Circle of four quarters.
[[nodiscard]] std::string mass_sign(Point at);

// Axes of a body: x red, y green, z blue.
[[nodiscard]] std::string frame_sign(const BodyAtStart& body, const Camera& camera);

// The joint's type in words: "revolute".
[[nodiscard]] std::string_view joint_word(multibody::JointType type) noexcept;

}  // namespace slew::analysis
