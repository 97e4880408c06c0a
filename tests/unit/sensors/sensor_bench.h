// SPDX-License-Identifier: Apache-2.0
// Frames A and B with shapes, and one sensor that looks at them.
#pragma once

#include <utility>
#include <vector>

#include "sensors/sensors.h"
#include "tests/support/contact_shapes.h"

namespace slew::sensors::testing {

using contact::ShapeDef;
using math::Vec3;

inline ShapeDef in_frame(ShapeDef shape, const char* name, const char* frame) {
  shape.name = name;
  shape.frame = frame;
  return shape;
}

// The shape a in frame A, b in frame B, and c on the ground.
inline SensorsDef pair(const ShapeDef& a, const ShapeDef& b, SensorDef sensor) {
  SensorsDef def;
  def.frames = {{"Ground", true}, {"A", false}, {"B", false}};
  def.shapes = {in_frame(a, "a", "A"), in_frame(b, "b", b.type == contact::ShapeType::plane ? "Ground" : "B")};
  if (sensor.name.empty()) sensor.name = "S";
  def.sensors = {std::move(sensor)};
  return def;
}

inline SensorDef clearance() {
  return {.name = "S", .type = SensorType::clearance, .of = {"A"}, .to = {"b"}};
}

// Motions of Ground, A and B.
inline std::vector<FrameMotion> at(const FrameMotion& a, const FrameMotion& b = {}) {
  return {{}, a, b};
}

inline std::vector<double> values(const Sensors& sensors) {
  std::vector<double> values(sensors.variables().size());
  sensors.read_variables(values);
  return values;
}

inline double value(const Sensors& sensors, const std::string& name) {
  for (std::size_t i = 0; i < sensors.variables().size(); ++i) {
    if (sensors.variables()[i].name == name) return values(sensors)[i];
  }
  ADD_FAILURE() << "no variable " << name;
  return 0;
}

inline Vec3 point(const Sensors& sensors, const std::string& name) {
  return {value(sensors, name + ".x"), value(sensors, name + ".y"), value(sensors, name + ".z")};
}

}  // namespace slew::sensors::testing
