// SPDX-License-Identifier: Apache-2.0
#include "multibody/contacts/contact_conversion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slew::multibody {
namespace {

// an impossible index for invalid numbers; the check of the mesh reports it
constexpr std::uint32_t kNoVertex = std::numeric_limits<std::uint32_t>::max();

std::uint32_t vertex_index(double number) {
  const bool is_index = number >= 0 && number < kNoVertex && number == std::floor(number);
  return is_index ? static_cast<std::uint32_t>(number) : kNoVertex;
}

}  // namespace

contact::ShapeDef contact_shape(const ShapeDef& shape) {
  contact::ShapeDef def;
  def.name = shape.name;
  def.frame = shape.body;
  def.type = shape.type;
  def.position = shape.position;
  def.orientation = shape.orientation;
  def.radius = shape.radius;
  def.length = shape.length;
  def.size = shape.size;
  for (std::size_t i = 0; i + 2 < shape.vertices.size(); i += 3) {
    def.mesh.vertices.push_back({shape.vertices[i], shape.vertices[i + 1], shape.vertices[i + 2]});
  }
  for (std::size_t i = 0; i + 2 < shape.triangles.size(); i += 3) {
    def.mesh.triangles.push_back(
        {vertex_index(shape.triangles[i]), vertex_index(shape.triangles[i + 1]), vertex_index(shape.triangles[i + 2])});
  }
  def.height_field = {.columns = static_cast<std::size_t>(std::max<std::int64_t>(shape.columns, 0)),
                      .rows = static_cast<std::size_t>(std::max<std::int64_t>(shape.rows, 0)),
                      .spacing_x = shape.spacing_x,
                      .spacing_y = shape.spacing_y,
                      .heights = shape.heights};
  return def;
}

contact::PairDef contact_pair(const MechanicsDef& mechanics, const ContactPairDef& pair) {
  contact::PairDef def;
  def.name = pair.name;
  def.shape_a = pair.shape_a;
  def.shape_b = pair.shape_b;
  def.normal = pair.normal;
  for (const FrictionDef& friction : mechanics.frictions) {
    if (friction.name == pair.friction) def.friction = friction.law;
  }
  return def;
}

}  // namespace slew::multibody
