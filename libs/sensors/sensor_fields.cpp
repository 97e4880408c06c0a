// SPDX-License-Identifier: Apache-2.0
// The types of sensors and their keys.
#include "sensors/sensors.h"

namespace slew::sensors {
namespace {

using enum Dimension;

constexpr std::string_view kShapes = "body or shape";

constexpr Field kOf =
    field<&SensorDef::of>("of", {.presence = Presence::required,
                                 .reference = kShapes,
                                 .doc = "first group: shapes, or bodies with all of theirs but zones"});
constexpr Field kTo = field<&SensorDef::to>("to", {.presence = Presence::required,
                                                   .reference = kShapes,
                                                   .doc = "second group; Ground: all shapes on the ground but zones"});

constexpr ReadBy kReadWithLimit[] = {{"limit", "limit above 0 m", [](const void* def) noexcept {
                                        return static_cast<const SensorDef*>(def)->limit > 0;
                                      }}};

constexpr Field kClearanceFields[] = {
    kOf,
    kTo,
    field<&SensorDef::limit>(
        "limit",
        {.dimension = length, .range = kNotNegative, .doc = "event when the distance falls below it; 0: none"}),
    field<&SensorDef::hysteresis>("hysteresis",
                                  {.dimension = length,
                                   .range = kNotNegative,
                                   .read_by = kReadWithLimit,
                                   .doc = "distance above the limit at which the sensor is no longer close"}),
};

constexpr Field kZoneFields[] = {
    field<&SensorDef::zone>(
        "zone", {.presence = Presence::required, .reference = "shape", .doc = "solid shape; its body may move"}),
    field<&SensorDef::watch>(
        "watch", {.presence = Presence::required, .reference = kShapes, .doc = "bodies or shapes that may enter"}),
    field<&SensorDef::stay>("stay",
                            {.dimension = time, .range = kNotNegative, .doc = "event after so long inside; 0: none"}),
};

constexpr Field kCollisionFields[] = {
    kOf,
    kTo,
    field<&SensorDef::is_continuous>("continuous", {.doc = "search between two samples too, for thin or fast things"}),
};

constexpr SensorTypeRow kTypes[] = {
    {"clearance", "distance, nearest points and closing speed of two groups of shapes", kClearanceFields},
    {"zone", "bodies that enter, leave or stay in a shape", kZoneFields},
    {"collision", "hits of two groups of shapes: pair, speed and place", kCollisionFields},
};

}  // namespace

std::span<const SensorTypeRow> sensor_types() noexcept {
  return kTypes;
}

}  // namespace slew::sensors
