#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "contact/contact_def.h"
#include "contact/kernels.h"

namespace slew::contact {
namespace {

using math::Vec3;

constexpr const char* kTypeNames[] = {"sphere", "box",          "cylinder",    "capsule",
                                      "plane",  "height_field", "convex_mesh", "triangle_mesh"};

// vertices of flat faces are printed with six digits and more: distance outside a face as a share of the mesh's size
constexpr double kConvexTolerance = 1e-6;

const char* name_of(ShapeType type) {
  return kTypeNames[static_cast<int>(type)];
}

bool must_not_move(ShapeType type) {
  return type == ShapeType::plane || type == ShapeType::height_field || type == ShapeType::triangle_mesh;
}

bool is_finite(const Triple& t) {
  return std::isfinite(t[0]) && std::isfinite(t[1]) && std::isfinite(t[2]);
}

template <typename Def>
const Def* find(const std::vector<Def>& defs, const std::string& name) {
  const auto found = std::find_if(defs.begin(), defs.end(), [&](const Def& def) { return def.name == name; });
  return found == defs.end() ? nullptr : &*found;
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
    const FrameDef* frame = find(def_.frames, shape.frame);
    if (frame == nullptr) {
      add(shape.name, "frame", fmt::format("there is no frame '{}'", shape.frame), "the name of a frame");
    } else if (must_not_move(shape.type) && !frame->is_static) {
      add(shape.name, "frame", fmt::format("a {} cannot move, and '{}' does", name_of(shape.type), frame->name),
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
        check_convex_mesh(shape);
        break;
      case ShapeType::height_field:
      case ShapeType::triangle_mesh:
        add(shape.name, "type", fmt::format("a {} is not in this version", name_of(shape.type)),
            "sphere, box, cylinder, capsule, plane or convex_mesh");
        break;
      case ShapeType::plane:
        break;
    }
  }

  bool check_mesh_numbers(const ShapeDef& shape) {
    const MeshDef& mesh = shape.mesh;
    if (mesh.vertices.size() < 4 || mesh.triangles.size() < 4) {
      add(shape.name, "mesh",
          fmt::format("{} vertices and {} triangles enclose nothing", mesh.vertices.size(), mesh.triangles.size()),
          "at least 4 of each");
      return false;
    }
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      if (is_finite(mesh.vertices[i])) continue;
      add(shape.name, "mesh", fmt::format("vertex {} is not finite", i), "finite vertices");
      return false;
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const auto& t = mesh.triangles[i];
      if (*std::max_element(t.begin(), t.end()) < mesh.vertices.size()) continue;
      add(shape.name, "mesh", fmt::format("triangle {} has a vertex that does not exist", i),
          fmt::format("indices below {}", mesh.vertices.size()));
      return false;
    }
    return true;
  }

  // every edge is there twice, once in each direction
  bool check_closed(const ShapeDef& shape) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const auto& t : shape.mesh.triangles) {
      for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    }
    for (const auto& [edge, count] : edges) {
      const auto back = edges.find({edge.second, edge.first});
      if (count == 1 && back != edges.end()) continue;
      const bool is_doubled = count > 1;
      add(shape.name, "mesh",
          fmt::format("it is not closed: the edge of vertices {} and {} {}", edge.first, edge.second,
                      is_doubled ? "is used twice in one direction (triangles that turn differently)"
                                 : "has a triangle on one side only"),
          "a closed mesh whose triangles all turn counter-clockwise seen from outside");
      return false;
    }
    return true;
  }

  void check_convex_mesh(const ShapeDef& shape) {
    if (!check_mesh_numbers(shape) || !check_closed(shape)) return;
    const MeshDef& mesh = shape.mesh;
    Vec3 low(mesh.vertices[0]), high(mesh.vertices[0]);
    for (const Triple& v : mesh.vertices) {
      for (std::size_t k = 0; k < 3; ++k) {
        const int lane = static_cast<int>(k);
        low.lanes[lane] = std::min(low[lane], v[k]);
        high.lanes[lane] = std::max(high[lane], v[k]);
      }
    }
    const double size = norm(high - low);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const auto& t = mesh.triangles[i];
      const Vec3 on(mesh.vertices[t[0]]);
      const Vec3 n = cross(Vec3(mesh.vertices[t[1]]) - on, Vec3(mesh.vertices[t[2]]) - on);
      if (!(norm(n) > kConvexTolerance * kConvexTolerance * size * size)) {
        add(shape.name, "mesh", fmt::format("triangle {} has no area", i), "triangles with three corners");
        return;
      }
      for (std::size_t k = 0; k < mesh.vertices.size(); ++k) {
        const double outside = dot(Vec3(mesh.vertices[k]) - on, n * (1 / norm(n)));
        if (outside <= kConvexTolerance * size) continue;
        add(shape.name, "mesh",
            fmt::format("it is not convex, or inside out: vertex {} is {:.3g} m outside of triangle {}", k, outside, i),
            "a convex mesh whose triangles turn counter-clockwise seen from outside; split others into convex parts");
        return;
      }
    }
  }

  void check_pair(const PairDef& pair) {
    check(pair.name, pair.normal, problems_);
    if (pair.friction) check(pair.name, *pair.friction, problems_);
    const ShapeDef* a = find_shape(pair, "shape_a", pair.shape_a);
    const ShapeDef* b = find_shape(pair, "shape_b", pair.shape_b);
    if (a == nullptr || b == nullptr) return;
    const FrameDef *frame_a = find(def_.frames, a->frame), *frame_b = find(def_.frames, b->frame);
    if (frame_a == nullptr || frame_b == nullptr) return;
    if (frame_a == frame_b) {
      add(pair.name, "shape_b", fmt::format("both shapes are fixed to '{}'", a->frame), "shapes of different frames");
    } else if (frame_a->is_static && frame_b->is_static) {
      add(pair.name, "shape_b", "neither shape can move", "a shape that moves");
    }
  }

  const ShapeDef* find_shape(const PairDef& pair, const char* key, const std::string& name) {
    const ShapeDef* shape = find(def_.shapes, name);
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
