// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "contact/find_named.h"
#include "sensors/sensors.h"
#include "sensors/shape_search.h"

namespace slew::sensors {

using contact::ShapeDef;
using contact::ShapeType;

namespace {

class Validator {
 public:
  Validator(const SensorsDef& def, Problems& problems) : def_(def), problems_(problems) {}

  void check(const SensorDef& sensor) {
    if (sensor.type == SensorType::zone) {
      check_zone(sensor);
    } else {
      check_groups(sensor, "to", group(sensor, "of", sensor.of), group(sensor, "to", sensor.to));
    }
  }

 private:
  void add(const SensorDef& sensor, const char* key, std::string what, std::string expected) {
    problems_.push_back({sensor.name + "." + key, std::move(what), std::move(expected), {}});
  }

  std::vector<std::size_t> group(const SensorDef& sensor, const char* key, const std::vector<std::string>& names) {
    for (const std::string& name : names) {
      if (shapes_of(def_, {name}).empty()) {
        add(sensor, key, fmt::format("'{}' has no shape", name), "a shape, or a body with a shape that is no zone");
      }
    }
    if (names.empty()) add(sensor, key, "the list is empty", "names of shapes or bodies");
    std::vector<std::size_t> shapes = shapes_of(def_, names);
    for (const std::size_t i : shapes) {
      const ShapeDef& shape = def_.shapes[i];
      const contact::FrameDef* frame = contact::find_named(def_.frames, shape.frame);
      if (shape.type == ShapeType::plane && frame != nullptr && !frame->is_static) {
        add(sensor, key, fmt::format("the plane '{}' is fixed to '{}', which moves", shape.name, shape.frame),
            "a plane on Ground, or a box");
      }
    }
    return shapes;
  }

  // At least one pair of shapes of two frames, and no two planes.
  void check_groups(const SensorDef& sensor, const char* key, const std::vector<std::size_t>& a,
                    const std::vector<std::size_t>& b) {
    if (a.empty() || b.empty()) return;
    bool has_pair = false;
    for (const std::size_t i : a) {
      for (const std::size_t j : b) {
        const ShapeDef &x = def_.shapes[i], &y = def_.shapes[j];
        if (x.frame == y.frame) continue;
        has_pair = true;
        if (x.type == ShapeType::plane && y.type == ShapeType::plane) {
          return add(sensor, key, fmt::format("'{}' and '{}' are both planes", x.name, y.name),
                     "a plane in one group only");
        }
      }
    }
    if (!has_pair) add(sensor, key, "no shape can move relative to one of the other group", "shapes of two bodies");
  }

  void check_zone(const SensorDef& sensor) {
    const ShapeDef* zone = contact::find_named(def_.shapes, sensor.zone);
    if (zone == nullptr) {
      add(sensor, "zone", fmt::format("there is no shape '{}'", sensor.zone), "the name of a shape");
    } else if (zone->type == ShapeType::triangle_mesh || zone->type == ShapeType::height_field) {
      add(sensor, "zone", fmt::format("'{}' is a surface of triangles and has no inside", sensor.zone),
          "a sphere, box, cylinder, capsule, plane or convex mesh");
    }
    std::vector<std::string> seen;
    for (const std::string& name : sensor.watch) {
      if (std::find(seen.begin(), seen.end(), name) != seen.end()) {
        add(sensor, "watch", fmt::format("'{}' is named twice", name), "each name once");
      }
      seen.push_back(name);
    }
    group(sensor, "watch", sensor.watch);
    if (zone == nullptr) return;
    for (const std::string& name : sensor.watch) {
      check_groups(sensor, "watch", shapes_of(def_, {sensor.zone}), shapes_of(def_, {name}));
    }
  }

  const SensorsDef& def_;
  Problems& problems_;
};

}  // namespace

void validate(const SensorsDef& def, Problems& problems) {
  Validator validator(def, problems);
  for (const SensorDef& sensor : def.sensors) validator.check(sensor);
}

}  // namespace slew::sensors
