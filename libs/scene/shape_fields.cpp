// SPDX-License-Identifier: Apache-2.0
#include "scene/shape_fields.h"

namespace slew::scene {
namespace {

using enum Dimension;
using contact::SolidDef;

constexpr std::string_view kAxes[] = {"x", "y", "z"};

template <auto Member>
constexpr Field size_row(std::string_view key, std::string_view doc, Presence presence = Presence::required) {
  return field<&PartDef::solid, Member>(key,
                                        {.dimension = length, .range = kPositive, .presence = presence, .doc = doc});
}

constexpr Field kAxis =
    field<&PartDef::axis>("axis", {.choices = kAxes, .doc = "axis of the shape, before the orientation turns it"});
constexpr Field kRadius = size_row<&SolidDef::radius>("radius", "radius");
constexpr Field kLength = size_row<&SolidDef::length>("length", "length along its axis, about the origin");

constexpr Field kBoxFields[] = {size_row<&SolidDef::size>("size", "edges along x, y, z, about the origin")};
constexpr Field kHollowBoxFields[] = {
    size_row<&SolidDef::length>("length", "length along x, open at both ends, about the origin"),
    size_row<&SolidDef::width>("width", "along y, outside"), size_row<&SolidDef::height>("height", "along z, outside"),
    size_row<&SolidDef::wall>("wall", "thickness of the walls normal to y"),
    size_row<&SolidDef::flange>("flange", "thickness of the walls normal to z; default: wall", Presence::optional)};
constexpr Field kSphereFields[] = {kRadius};
constexpr Field kCylinderFields[] = {kRadius, kLength, kAxis};
constexpr Field kTubeFields[] = {
    size_row<&SolidDef::diameter>("diameter", "outer diameter"),
    size_row<&SolidDef::inner_diameter>("inner_diameter", "inner diameter; either this or wall", Presence::optional),
    size_row<&SolidDef::wall>("wall", "wall thickness; either this or inner_diameter", Presence::optional), kLength,
    kAxis};
constexpr Field kConeFields[] = {
    size_row<&SolidDef::radius>("radius", "radius of the base, at the lower end of its axis"),
    field<&PartDef::solid, &SolidDef::top_radius>(
        "top_radius", {.dimension = length, .range = kNotNegative, .doc = "radius at the upper end; 0: a point"}),
    size_row<&SolidDef::length>("length", "height along its axis, about the origin"), kAxis};
constexpr Field kCapsuleFields[] = {
    kRadius, size_row<&SolidDef::length>("length", "between the centres of its round ends, along its axis"), kAxis};

constexpr Field kPartRows[] = {
    field<&PartDef::position>("position", {.dimension = length, .doc = "the shape's origin, body frame"}),
    field<&PartDef::orientation>("orientation",
                                 {.dimension = angle, .doc = "the shape's axes: Euler rotations z, x', z''"}),
    field<&PartDef::density>(
        "density",
        {.dimension = density, .range = kPositive, .doc = "density; either this or mass; default: the body's"}),
    field<&PartDef::mass>("mass", {.dimension = mass, .range = kPositive, .doc = "mass; either this or density"}),
    field<&PartDef::hole>("hole", {.doc = "the shape is taken away from the other parts"}),
};
constexpr Field kBodyRows[] = {
    field<&PartDef::position>("shape_position", {.dimension = length, .doc = "the shape's origin, body frame"}),
    field<&PartDef::orientation>("shape_orientation",
                                 {.dimension = angle, .doc = "the shape's axes: Euler rotations z, x', z''"}),
    field<&PartDef::density>("density",
                             {.dimension = density, .range = kPositive, .doc = "density; either this or mass"}),
    field<&PartDef::mass>("mass", {.dimension = mass,
                                   .range = kPositive,
                                   .change = Change::live,
                                   .doc = "mass, spread evenly; either this or density"}),
};
constexpr Field kPartsFields[] = {
    field<&PartsDef::density>(
        "density",
        {.dimension = density, .range = kPositive, .doc = "density of the parts that have neither density nor mass"}),
    field<&PartsDef::mass>("mass", {.dimension = mass,
                                    .range = kPositive,
                                    .change = Change::live,
                                    .doc = "mass of all parts, spread evenly; no part then has its own"}),
};

ShapeWord shape_word(std::string_view name, std::string_view doc, std::span<const Field> rows) {
  ShapeWord word{.name = name, .doc = doc, .body_fields = {rows.begin(), rows.end()}, .part_fields = {}};
  word.part_fields = word.body_fields;
  word.body_fields.insert(word.body_fields.end(), std::begin(kBodyRows), std::end(kBodyRows));
  word.part_fields.insert(word.part_fields.end(), std::begin(kPartRows), std::end(kPartRows));
  return word;
}

}  // namespace

std::span<const ShapeWord> shape_words() {
  static const std::vector<ShapeWord> words = {
      shape_word("box", "box about the origin", kBoxFields),
      shape_word("hollow_box", "rectangular hollow section along x", kHollowBoxFields),
      shape_word("sphere", "ball about the origin", kSphereFields),
      shape_word("cylinder", "cylinder along its axis", kCylinderFields),
      shape_word("tube", "hollow cylinder along its axis", kTubeFields),
      shape_word("cone", "cone or frustum along its axis", kConeFields),
      shape_word("capsule", "cylinder along its axis with round ends", kCapsuleFields),
  };
  return words;
}

std::span<const Field> parts_fields() noexcept {
  return kPartsFields;
}

std::span<const Field> part_rows() noexcept {
  return kPartRows;
}

std::vector<std::string_view> keys_of_shapes() {
  std::vector<std::string_view> keys = {kShapeKey, kPartsKey};
  for (const ShapeWord& word : shape_words()) {
    for (const Field& row : word.body_fields) keys.push_back(row.key);
  }
  return keys;
}

}  // namespace slew::scene
