// SPDX-License-Identifier: Apache-2.0
#include "scene/shape_inertia.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "core/suggestion.h"
#include "math/rotation.h"
#include "scene/shape_fields.h"
#include "scene/solid_inertia.h"

namespace slew::scene {
namespace {

using enum Dimension;
using contact::MassProperties;
using contact::PlacedSolid;
using contact::SolidDef;
using contact::SolidType;
using math::Mat3;
using math::Vec3;

constexpr std::size_t kMaxParts = 256;
// z of a shape of revolution along the named axis
Mat3 rotation_to(AxisOfShape axis) {
  const Vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  switch (axis) {
    case AxisOfShape::x:
      return {y, z, x};
    case AxisOfShape::y:
      return {z, x, y};
    case AxisOfShape::z:
      break;
  }
  return Mat3::identity();
}

class ShapeBodyReader {
 public:
  ShapeBodyReader(const Node::Entry& element, const ReadContext& context) : element_(element), context_(context) {}

  void read(std::span<const Field> body_fields, multibody::BodyDef& body, Scene& scene) {
    const std::size_t problems = context_.report.size();
    const bool has_parts = has_inertia_word(element_.value, kFromParts);
    refuse_derived_keys(element_, has_parts ? "the parts" : "the shape", has_parts ? kFromParts : kFromShape, context_);
    if (has_parts) {
      read_parts(body_fields, body);
    } else {
      read_one(body_fields, body);
    }
    if (context_.report.size() > problems) return;
    spread_mass();
    for (const Part& part : parts_) check_plausible(part, scene);
    check_overlaps(scene);
    if (context_.report.size() > problems) return;
    put(body, scene);
  }

 private:
  struct Part {
    PartDef def;
    PlacedSolid placed;
    std::string path;
    Mark mark;
  };

  // inertia: from_shape
  void read_one(std::span<const Field> body_fields, multibody::BodyDef& body) {
    const ShapeWord* word = word_of(element_.value, element_.key, element_.mark);
    Part& part = add_part(element_.key, element_.mark, word);
    const std::string_view more[] = {kShapeKey};
    const std::vector<std::string_view> all = keys_of_shapes();
    // without the word no key is known to be wrong
    const std::span<const std::string_view> more_keys = word == nullptr ? std::span(all) : std::span(more);
    const std::vector<Field> none;
    read_beside_solid(element_, body_fields, body, word == nullptr ? none : word->body_fields, &part.def, more_keys,
                      context_);
    check_density_or_mass(element_.value, element_.key, element_.mark, "the shape", context_);
    if (word != nullptr) complete(part, element_.value);
  }

  // inertia: from_parts
  void read_parts(std::span<const Field> body_fields, multibody::BodyDef& body) {
    const std::string_view more[] = {kPartsKey};
    read_beside_solid(element_, body_fields, body, parts_fields(), &all_, more, context_);
    const Node::Entry* entry = element_.value.find(kPartsKey);
    const std::string path = fmt::format("{}.{}", element_.key, kPartsKey);
    if (entry == nullptr) {
      context_.report.add(element_.mark, element_.key, {"the key 'parts' is missing", "a list of shapes", ""});
      return;
    }
    context_.places.add(path, entry->value.mark);
    const bool is_list = entry->value.kind == Node::Kind::sequence;
    if (!is_list || entry->value.items.empty() || entry->value.items.size() > kMaxParts) {
      const std::string found =
          is_list ? fmt::format("has {} entries", entry->value.items.size()) : "is " + describe(entry->value);
      context_.report.add(entry->value.mark, path, {found, fmt::format("a list of 1 to {} maps", kMaxParts), ""});
      return;
    }
    const std::size_t problems = context_.report.size();
    for (std::size_t i = 0; i < entry->value.items.size(); ++i) {
      read_part(entry->value.items[i], fmt::format("{}[{}]", path, i));
    }
    if (context_.report.size() == problems) check_sources();
  }

  void read_part(const Node& item, const std::string& path) {
    if (item.kind != Node::Kind::map) {
      context_.report.add(item.mark, path, {"is " + describe(item), "a map", ""});
      return;
    }
    const ShapeWord* word = word_of(item, path, item.mark);
    if (word == nullptr) return;
    Part& part = add_part(path, item.mark, word);
    const std::string_view more[] = {kShapeKey};
    read_fields(item, word->part_fields, &part.def, path, item.mark, more, context_);
    if (item.find(kDensityKey) != nullptr && item.find(kMassKey) != nullptr) {
      check_density_or_mass(item, path, item.mark, "the part", context_);
    }
    complete(part, item);
  }

  // density and mass of the parts, and those of the body for all
  void check_sources() {
    const Node::Entry* of_body = element_.value.find(kDensityKey);
    if (element_.value.find(kMassKey) != nullptr) {
      if (of_body != nullptr) return check_density_or_mass(element_.value, element_.key, element_.mark, "", context_);
      for (const Part& part : parts_) {
        if (!has_own(part.def)) continue;
        context_.report.add(part.mark, part.path,
                            {"has a density or mass of its own, and the body a mass for all parts",
                             "one of them; the body's density is for parts without their own", ""});
      }
      return;
    }
    bool is_used = false;
    for (const Part& part : parts_) {
      if (has_own(part.def)) continue;
      is_used = true;
      if (of_body == nullptr) {
        context_.report.add(part.mark, part.path,
                            {"neither density nor mass is given", "one of them here, or one beside parts", ""});
      }
    }
    if (of_body != nullptr && !is_used) {
      context_.report.add(of_body->mark, fmt::format("{}.{}", element_.key, kDensityKey),
                          {"every part has a density or mass of its own", "no density beside parts", ""});
    }
  }

  static bool has_own(const PartDef& def) { return std::isfinite(def.density) || std::isfinite(def.mass); }

  // The row of the map's key `shape`; null after a reported problem.
  const ShapeWord* word_of(const Node& map, const std::string& path, const Mark& place) {
    std::vector<std::string_view> names;
    for (const ShapeWord& word : shape_words()) names.push_back(word.name);
    const Node::Entry* entry = map.find(kShapeKey);
    if (entry == nullptr) {
      context_.report.add(place, path, {"the key 'shape' is missing", choice_list(names), ""});
      return nullptr;
    }
    const bool is_word = entry->value.kind == Node::Kind::scalar;
    for (const ShapeWord& word : shape_words()) {
      if (is_word && entry->value.text == word.name) return &word;
    }
    context_.report.add(
        entry->value.mark, fmt::format("{}.{}", path, kShapeKey),
        {"is " + describe(entry->value), choice_list(names), is_word ? closest(entry->value.text, names) : ""});
    return nullptr;
  }

  Part& add_part(const std::string& path, const Mark& mark, const ShapeWord* word) {
    context_.places.add(path, mark);
    Part& part = parts_.emplace_back();
    part.path = path;
    part.mark = mark;
    if (word != nullptr) part.def.solid.type = static_cast<SolidType>(word - shape_words().data());
    return part;
  }

  // defaults that follow from other sizes, walls, and the pose
  void complete(Part& part, const Node& map) {
    SolidDef& solid = part.def.solid;
    if (solid.type == SolidType::tube) {
      const bool has_wall = map.find("wall") != nullptr, has_inner = map.find("inner_diameter") != nullptr;
      if (has_wall == has_inner) {
        context_.report.add(part.mark, part.path,
                            {has_wall ? "inner_diameter and wall are both given" : "the tube has no wall",
                             "one of inner_diameter and wall", ""});
      } else if (has_wall && check_wall(part, map, "wall", solid.wall, "diameter", solid.diameter)) {
        solid.inner_diameter = solid.diameter - 2 * solid.wall;
      } else if (has_inner && leaves_nothing(solid.inner_diameter, solid.diameter)) {
        report_size(part, map, "inner_diameter",
                    fmt::format("the inner diameter of {:g} m leaves no wall", solid.inner_diameter),
                    fmt::format("less than diameter, {:g} m", solid.diameter));
      }
    }
    if (solid.type == SolidType::hollow_box) {
      const bool has_flange = map.find("flange") != nullptr;
      if (!has_flange) solid.flange = solid.wall;
      (void)check_wall(part, map, "wall", solid.wall, "width", solid.width);
      (void)check_wall(part, map, has_flange ? "flange" : "wall", solid.flange, "height", solid.height);
    }
    part.placed.def = solid;
    part.placed.p_BS = Vec3(part.def.position);
    part.placed.R_BS = math::rotation_zxz(part.def.orientation) * rotation_to(part.def.axis);
  }

  // Sizes that their fields refused are still 0 or infinite.
  static bool leaves_nothing(double hollow, double outside) {
    return outside > 0 && std::isfinite(hollow) && hollow >= outside;
  }

  // Two walls of this thickness leave a hollow in the size.
  bool check_wall(const Part& part, const Node& map, std::string_view key, double thickness, std::string_view size_key,
                  double size) {
    if (!leaves_nothing(2 * thickness, size)) return true;
    report_size(part, map, key, fmt::format("two walls of {:g} m leave no hollow", thickness),
                fmt::format("less than half of {}, {:g} m", size_key, size / 2));
    return false;
  }

  void report_size(const Part& part, const Node& map, std::string_view key, std::string what, std::string expected) {
    const Node::Entry* entry = map.find(key);
    context_.report.add(entry == nullptr ? part.mark : entry->value.mark, fmt::format("{}.{}", part.path, key),
                        {std::move(what), std::move(expected), ""});
  }

  // densities from masses; holes are negative
  void spread_mass() {
    double volume = 0;
    for (const Part& part : parts_) {
      const double own = contact::shape_properties(part.placed.def).volume;
      volume += part.def.hole ? -own : own;
    }
    for (Part& part : parts_) {
      const double own = contact::shape_properties(part.placed.def).volume;
      double density = all_.density;
      if (std::isfinite(part.def.density)) density = part.def.density;
      if (std::isfinite(part.def.mass)) density = part.def.mass / own;
      // without a volume the sum is refused below
      if (std::isfinite(all_.mass)) density = volume > 0 ? all_.mass / volume : 1;
      part.placed.density = part.def.hole ? -density : density;
    }
  }

  void check_plausible(const Part& part, Scene& scene) {
    const Vec3 half = contact::half_extent(part.placed.def);
    const double density = std::abs(part.placed.density);
    const double volume = contact::shape_properties(part.placed.def).volume;
    const double size = 2 * std::max({half.x(), half.y(), half.z()});
    const Plausibility plausibility = plausibility_of(size, volume, density);
    if (plausibility == Plausibility::likely) return;
    ValueProblem problem{fmt::format("the shape is {:.3g} x {:.3g} x {:.3g} m, {:.4g} m3, {:.4g} kg at {:.4g} kg/m3",
                                     2 * half.x(), 2 * half.y(), 2 * half.z(), volume, volume * density, density),
                         "sizes, density and mass with their units, such as 120 mm and 7850 kg/m3", ""};
    if (plausibility == Plausibility::impossible) {
      context_.report.add(part.mark, part.path, std::move(problem));
    } else {
      scene.warnings.push_back(context_.report.at(part.mark, part.path, std::move(problem)).text());
    }
  }

  void check_overlaps(Scene& scene) {
    std::vector<PlacedSolid> placed;
    for (const Part& part : parts_) placed.push_back(part.placed);
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (!parts_[i].def.hole) {
        warn_of_overlap(parts_[i], contact::share_counted_twice(placed, i), scene);
        continue;
      }
      const double share = contact::share_without_material(placed, i);
      if (share == 0) continue;
      context_.report.add(
          parts_[i].mark, parts_[i].path,
          {fmt::format("about {:.2g} % of the hole lies where the parts have no material, or less than it takes away",
                       100 * share),
           "a hole within the parts, of their density, that no other hole meets", ""});
    }
  }

  void warn_of_overlap(const Part& part, double share, Scene& scene) {
    if (share == 0) return;
    const Diagnostic warning =
        context_.report.at(part.mark, part.path,
                           {fmt::format("about {:.2g} % of the part lies in other parts and counts twice", 100 * share),
                            "parts that only touch, or a hole for what they share", ""});
    scene.warnings.push_back(warning.text());
  }

  void put(multibody::BodyDef& body, Scene& scene) {
    std::vector<PlacedSolid> placed;
    for (const Part& part : parts_) placed.push_back(part.placed);
    const MassProperties sum = contact::sum_of(placed);
    if (!(sum.mass > 0) || !(sum.volume > 0)) {
      context_.report.add(element_.mark, element_.key,
                          {fmt::format("the parts sum up to {:.4g} m3 and {:.4g} kg", sum.volume, sum.mass),
                           "parts that are larger than their holes", ""});
      return;
    }
    put_inertia(sum.centre, sum.inertia, body);
    const bool has_parts = has_inertia_word(element_.value, kFromParts);
    // a stated mass stays to the bit
    const double stated = has_parts ? all_.mass : parts_[0].def.mass;
    body.mass = std::isfinite(stated) ? stated : sum.mass;
    const std::string shapes =
        has_parts ? fmt::format("{} part{}", parts_.size(), parts_.size() == 1 ? "" : "s")
                  : std::string(shape_words()[static_cast<std::size_t>(parts_[0].def.solid.type)].name);
    scene.solid_inertias.push_back({element_.key, "", shapes, sum.volume, body.mass / sum.volume});
  }

  const Node::Entry& element_;
  const ReadContext& context_;
  PartsDef all_;
  std::vector<Part> parts_;
};

}  // namespace

bool takes_from_shapes(const Node& body) {
  return has_inertia_word(body, kFromShape) || has_inertia_word(body, kFromParts);
}

void read_shape_body(const Node::Entry& element, std::span<const Field> body_fields, multibody::BodyDef& body,
                     Scene& scene, const ReadContext& context) {
  ShapeBodyReader(element, context).read(body_fields, body, scene);
}

}  // namespace slew::scene
