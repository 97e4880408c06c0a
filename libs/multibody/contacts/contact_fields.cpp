// SPDX-License-Identifier: Apache-2.0
#include "multibody/contacts/contact_fields.h"

#include <algorithm>
#include <type_traits>
#include <vector>

#include "contact/manifold.h"

namespace slew::multibody {
namespace {

using enum Dimension;

// the laws' own tables bind to the first member
static_assert(std::is_standard_layout_v<ContactPairDef> && std::is_standard_layout_v<FrictionDef>);

constexpr Range kPointSlots{
    .min = 0, .max = static_cast<double>(contact::kMaxPointsPerPair), .min_is_open = false, .max_is_open = false};
constexpr Range kGrid{.min = 2, .max = 1e4, .min_is_open = false, .max_is_open = false};

constexpr Field kBody = field<&ShapeDef::body>("body", {.reference = "body", .doc = "body that the shape belongs to"});
constexpr Field kShapePosition =
    field<&ShapeDef::position>("position", {.dimension = length, .doc = "shape's origin in the body's frame"});
constexpr Field kShapeOrientation = field<&ShapeDef::orientation>(
    "orientation", {.dimension = angle, .doc = "shape's axes in the body: Euler rotations z, x', z''"});
constexpr Field kRadius = field<&ShapeDef::radius>(
    "radius", {.dimension = length, .range = kPositive, .presence = Presence::required, .doc = "radius"});

constexpr Field kSphereFields[] = {kBody, kShapePosition, kShapeOrientation, kRadius};
constexpr Field kBoxFields[] = {kBody, kShapePosition, kShapeOrientation,
                                field<&ShapeDef::size>("size", {.dimension = length,
                                                                .range = kPositive,
                                                                .presence = Presence::required,
                                                                .doc = "edges along x, y, z, about the origin"})};
constexpr Field kCylinderFields[] = {kBody, kShapePosition, kShapeOrientation, kRadius,
                                     field<&ShapeDef::length>("length", {.dimension = length,
                                                                         .range = kPositive,
                                                                         .presence = Presence::required,
                                                                         .doc = "length along z, about the origin"})};
constexpr Field kCapsuleFields[] = {
    kBody, kShapePosition, kShapeOrientation, kRadius,
    field<&ShapeDef::length>("length", {.dimension = length,
                                        .range = kPositive,
                                        .presence = Presence::required,
                                        .doc = "between the centres of its round ends, along z"})};
constexpr Field kPlaneFields[] = {kBody, kShapePosition, kShapeOrientation};
constexpr Field kHeightFieldFields[] = {
    kBody,
    kShapePosition,
    kShapeOrientation,
    field<&ShapeDef::columns>("columns", {.range = kGrid, .presence = Presence::required, .doc = "points along x"}),
    field<&ShapeDef::rows>("rows", {.range = kGrid, .presence = Presence::required, .doc = "points along y"}),
    field<&ShapeDef::spacing_x>(
        "spacing_x",
        {.dimension = length, .range = kPositive, .presence = Presence::required, .doc = "their distance along x"}),
    field<&ShapeDef::spacing_y>(
        "spacing_y",
        {.dimension = length, .range = kPositive, .presence = Presence::required, .doc = "their distance along y"}),
    field<&ShapeDef::heights>("heights", {.dimension = length,
                                          .presence = Presence::required,
                                          .doc = "heights along z, row by row from the origin; solid below"})};
constexpr Field kMeshFields[] = {
    kBody,
    kShapePosition,
    kShapeOrientation,
    field<&ShapeDef::file>("file", {.doc = "mesh beside the scene: .stl, .obj, .dae, .3ds, .glb or .fbx"}),
    field<&ShapeDef::file_unit>(
        "unit",
        {.dimension = length, .range = kPositive, .doc = "length of a unit of the file, as 1 mm; required with file"}),
    field<&ShapeDef::file_up>(
        "up", {.doc = "upward axis of the file, y or z, that becomes y of the shape; required with file"}),
    field<&ShapeDef::vertices>("vertices", {.dimension = length, .doc = "x, y, z of each vertex, instead of a file"}),
    field<&ShapeDef::triangles>(
        "triangles", {.range = kNotNegative,
                      .doc = "three numbers of vertices, from 0, a triangle; counter-clockwise seen from outside"})};

constexpr Field kPairFields[] = {
    field<&ContactPairDef::shape_a>("shape_a",
                                    {.presence = Presence::required, .reference = "shape", .doc = "first shape"}),
    field<&ContactPairDef::shape_b>("shape_b",
                                    {.presence = Presence::required, .reference = "shape", .doc = "second shape"}),
    field<&ContactPairDef::friction>("friction",
                                     {.reference = "friction", .doc = "friction between them; without it none"}),
    field<&ContactPairDef::point_variables>("point_variables",
                                            {.range = kPointSlots, .doc = "contact points with variables"}),
    field<&ContactPairDef::tested>("tested", {.doc = "false: the pair keeps its name and is never searched"}),
};

// the pair's own rows, then those of its normal law
std::span<const Field> pair_fields() {
  static const std::vector<Field> rows = [] {
    std::vector<Field> all(std::begin(kPairFields), std::end(kPairFields));
    const std::span<const Field> law = contact::normal_law_fields();
    all.insert(all.end(), law.begin(), law.end());
    return all;
  }();
  return rows;
}

template <contact::ShapeType Type>
void* append_shape(MechanicsDef& mechanics, std::string_view element) {
  ShapeDef& def = mechanics.shapes.emplace_back();
  def.name = element;
  def.type = Type;
  return &def;
}

template <auto List>
void* append_contact(MechanicsDef& mechanics, std::string_view element) {
  auto& def = (mechanics.*List).emplace_back();
  def.name = element;
  return &def;
}

using contact::ShapeType;

constexpr ElementType kShapeTypes[] = {
    {"sphere", "shape", "ball about the origin", kSphereFields, append_shape<ShapeType::sphere>},
    {"box", "shape", "box about the origin", kBoxFields, append_shape<ShapeType::box>},
    {"cylinder", "shape", "cylinder along z", kCylinderFields, append_shape<ShapeType::cylinder>},
    {"capsule", "shape", "cylinder along z with round ends", kCapsuleFields, append_shape<ShapeType::capsule>},
    {"plane", "shape", "half space below z = 0, on a body that does not move", kPlaneFields,
     append_shape<ShapeType::plane>},
    {"height_field", "shape", "ground of points in a grid, on a body that does not move", kHeightFieldFields,
     append_shape<ShapeType::height_field>},
    {"convex_mesh", "shape", "closed surface of triangles without dents", kMeshFields,
     append_shape<ShapeType::convex_mesh>},
    {"triangle_mesh", "shape", "surface of triangles; on a body that moves for sensors only, not in contact",
     kMeshFields, append_shape<ShapeType::triangle_mesh>},
};

}  // namespace

std::span<const ElementType> shape_types() noexcept {
  return kShapeTypes;
}

std::span<const ElementType> contact_types() noexcept {
  static const ElementType type{"", "contact", "pair of shapes that is tested, and its laws", pair_fields(),
                                append_contact<&MechanicsDef::contacts>};
  return {&type, 1};
}

std::span<const ElementType> friction_types() noexcept {
  static const ElementType type{"", "friction", "friction of contacts: bristles that bend, hold and slip",
                                contact::friction_law_fields(), append_contact<&MechanicsDef::frictions>};
  return {&type, 1};
}

}  // namespace slew::multibody
