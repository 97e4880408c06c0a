// SPDX-License-Identifier: Apache-2.0
// Shapes of bodies as primitives of foxglove.SceneUpdate.
#pragma once

#include <array>
#include <span>
#include <string>

#include "core/json.h"
#include "math/rotation.h"
#include "math/vector3.h"
#include "multibody/contacts/contact_defs.h"

namespace slew::gateway {

using Color = std::array<double, 3>;  // red, green, blue, 0 .. 1

[[nodiscard]] Json vector_json(math::Vec3 v);
[[nodiscard]] Json pose_json(math::Vec3 position, const math::Quaternion& orientation);

// Adds a contact shape to the lists of primitives of its body: cubes, spheres, cylinders or triangles.
void add_shape(const multibody::ShapeDef& shape, const Color& color, Json& primitives);

// Adds a cylinder about the z axis, its middle at z [m].
void add_cylinder(double radius, double length, double z, const Color& color, Json& primitives);

// Adds a mesh in a binary glTF file, in the axes that the pose places. Foxglove takes y of such a file for up and turns
// it into z, a quarter turn about x, which the pose of the primitive undoes.
void add_model(const std::string& uri, math::Vec3 position, const math::Quaternion& orientation, Json& primitives);

// Adds lines from the hub to the points [m], in the body's frame.
void add_star(math::Vec3 hub, std::span<const math::Vec3> points, double thickness, const Color& color,
              Json& primitives);

}  // namespace slew::gateway
