// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "contact/contact_def.h"
#include "contact/find_named.h"
#include "contact/mesh_check.h"

namespace slew::contact {
namespace {

constexpr const char* kTypeNames[] = {"sphere", "box",          "cylinder",    "capsule",
                                      "plane",  "height_field", "convex_mesh", "triangle_mesh"};

const char* name_of(ShapeType type) {
  return kTypeNames[static_cast<int>(type)];
}

bool must_not_move(ShapeType type) {
  return type == ShapeType::plane || type == ShapeType::height_field || type == ShapeType::triangle_mesh;
}

bool is_finite(const Triple& t) {
  return std::isfinite(t[0]) && std::isfinite(t[1]) && std::isfinite(t[2]);
}

class Validator {
 public:
  Validator(const ContactDef& def, Problems& problems) : def_(def), problems_(problems) {}

  void run() {
    check_names(def_.frames, "frame");
    check_names(def_.shapes, "shape");
    check_names(def_.pairs, "pair");
    for (const ShapeDef& shape : def_.shapes) check_shape(shape);
    for (const PairDef& pair : def_.pairs) check_pair(pair);
  }

 private:
  void add(const std::string& owner, std::string_view key, std::string what, std::string expected) {
    problems_.push_back({fmt::format("{}.{}", owner, key), std::move(what), std::move(expected), {}});
  }

  template <typename Def>
  void check_names(const std::vector<Def>& defs, const char* kind) {
    std::set<std::string> seen;
    for (const Def& def : defs) {
      if (def.name.empty()) add(def.name, "name", fmt::format("a {} has no name", kind), "a name");
      if (!seen.insert(def.name).second) {
        add(def.name, "name", fmt::format("a second {} has this name", kind), "a name of its own");
      }
    }
  }

  void check_positive(const ShapeDef& shape, std::string_view key, double value) {
    if (std::isfinite(value) && value > 0) return;
    add(shape.name, key, fmt::format("{} m is out of range", value), "a number > 0 m");
  }

  void check_shape(const ShapeDef& shape) {
    const FrameDef* frame = find_named(def_.frames, shape.frame);
    if (frame == nullptr) {
      add(shape.name, "frame", fmt::format("there is no frame '{}'", shape.frame), "the name of a frame");
    } else if (shape.type == ShapeType::plane && !frame->is_static) {
      add(shape.name, "frame", fmt::format("a plane cannot move, and '{}' does", frame->name),
          "a frame that does not move, or a convex shape");
    }
    if (!is_finite(shape.position)) add(shape.name, "position", "it is not finite", "three numbers in m");
    if (!is_finite(shape.orientation)) add(shape.name, "orientation", "it is not finite", "three numbers in rad");
    switch (shape.type) {
      case ShapeType::sphere:
        check_positive(shape, "radius", shape.radius);
        break;
      case ShapeType::cylinder:
      case ShapeType::capsule:
        check_positive(shape, "radius", shape.radius);
        check_positive(shape, "length", shape.length);
        break;
      case ShapeType::box:
        for (const double edge : shape.size) check_positive(shape, "size", edge);
        break;
      case ShapeType::convex_mesh:
        check_surface(shape, "mesh", find_convex_fault(shape.mesh));
        break;
      case ShapeType::triangle_mesh:
        check_surface(shape, "mesh", find_touched_fault(shape.mesh));
        break;
      case ShapeType::height_field:
        check_surface(shape, "height_field", find_field_fault(shape.height_field));
        break;
      case ShapeType::plane:
        break;
    }
  }

  void check_surface(const ShapeDef& shape, std::string_view key, const std::optional<MeshFault>& fault) {
    if (fault) add(shape.name, key, fault->what, fault->expected);
  }

  void check_pair(const PairDef& pair) {
    check(pair.name, pair.normal, problems_);
    if (pair.friction) check(pair.name, *pair.friction, problems_);
    const ShapeDef* a = find_shape(pair, "shape_a", pair.shape_a);
    const ShapeDef* b = find_shape(pair, "shape_b", pair.shape_b);
    if (a == nullptr || b == nullptr) return;
    const FrameDef *frame_a = find_named(def_.frames, a->frame), *frame_b = find_named(def_.frames, b->frame);
    if (frame_a == nullptr || frame_b == nullptr) return;
    for (const auto& [shape, frame] : {std::pair(a, frame_a), std::pair(b, frame_b)}) {
      if (!must_not_move(shape->type) || frame->is_static) continue;
      add(shape->name, "frame",
          fmt::format("a {} in contact cannot move, and '{}' does", name_of(shape->type), frame->name),
          "a frame that does not move, or convex shapes in its place: a mesh is not cut into convex parts; sensors "
          "take "
          "it as it is");
      return;
    }
    if (frame_a == frame_b) {
      add(pair.name, "shape_b", fmt::format("both shapes are fixed to '{}'", a->frame), "shapes of different frames");
    } else if (frame_a->is_static && frame_b->is_static) {
      add(pair.name, "shape_b", "neither shape can move", "a shape that moves");
    }
  }

  const ShapeDef* find_shape(const PairDef& pair, const char* key, const std::string& name) {
    const ShapeDef* shape = find_named(def_.shapes, name);
    if (shape == nullptr) add(pair.name, key, fmt::format("there is no shape '{}'", name), "the name of a shape");
    return shape;
  }

  const ContactDef& def_;
  Problems& problems_;
};

}  // namespace

void validate(const ContactDef& def, Problems& problems) {
  Validator(def, problems).run();
}

}  // namespace slew::contact
