// SPDX-License-Identifier: Apache-2.0
#include "scene/sensors.h"

#include <fmt/format.h>

#include <algorithm>

#include "contact/find_named.h"
#include "coupling/samples.h"
#include "multibody/contacts/contact_conversion.h"
#include "multibody/model/topology.h"

namespace slew::scene {
namespace {

bool is_named(const std::vector<std::string>& names, const multibody::ShapeDef& shape) {
  return std::any_of(names.begin(), names.end(),
                     [&](const std::string& name) { return name == shape.name || name == shape.body; });
}

bool is_used(const std::vector<sensors::SensorDef>& all, const multibody::ShapeDef& shape) {
  return std::any_of(all.begin(), all.end(), [&](const sensors::SensorDef& sensor) {
    return sensor.zone == shape.name || is_named(sensor.of, shape) || is_named(sensor.to, shape) ||
           is_named(sensor.watch, shape);
  });
}

}  // namespace

sensors::SensorsDef sensors_of(const Scene& scene) {
  sensors::SensorsDef def;
  Problems known;  // of the tree, reported elsewhere
  const std::vector<int> carrier =
      multibody::merged_into(scene.mechanics, multibody::find_tree(scene.mechanics, known));
  const multibody::BodyNumbers number_of(scene.mechanics);
  def.frames.push_back({std::string(multibody::kGroundName), true});
  for (const multibody::ShapeDef& shape : scene.mechanics.shapes) {
    if (!is_used(scene.sensors, shape)) continue;
    def.shapes.push_back(multibody::contact_shape(shape));
    if (contact::find_named(def.frames, shape.body) != nullptr) continue;
    const int number = number_of(shape.body);
    const bool is_static =
        number != multibody::kNoBody && carrier[static_cast<std::size_t>(number)] == multibody::kGround;
    def.frames.push_back({shape.body, is_static});
  }
  def.sensors = scene.sensors;
  def.interval = static_cast<double>(scene.recording.every) * scene.session.step_duration().seconds();
  return def;
}

void check_sensors(const Scene& scene, Problems& problems) {
  if (scene.sensors.empty()) return;
  const sensors::SensorsDef def = sensors_of(scene);
  sensors::validate(def, problems);
  std::size_t most_events = 0;  // of one sample
  for (const sensors::SensorDef& sensor : scene.sensors) {
    most_events += std::max<std::size_t>(2, sensor.watch.size());
    if (most_events <= coupling::kMaxSensorEvents) continue;
    problems.push_back(
        {sensor.name, "up to here the sensors can have more events in one sample than a message holds",
         fmt::format("at most {}: two of a clearance or a collision, one of each watched name of a zone, "
                     "at least two of a zone",
                     coupling::kMaxSensorEvents),
         ""});
    break;
  }
  if (def.frames.size() > coupling::kMaxSensedBodies + 1) {
    problems.push_back({scene.sensors.front().name,
                        fmt::format("the sensors look at shapes of {} bodies", def.frames.size() - 1),
                        fmt::format("at most {}", coupling::kMaxSensedBodies), ""});
  }
}

}  // namespace slew::scene
