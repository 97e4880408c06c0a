// SPDX-License-Identifier: Apache-2.0
#include "devices/stick_calibration.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/check.h"

namespace slew::devices {
namespace {

constexpr Field kCalibrationFields[] = {
    field<&CalibrationDef::rest_time>("rest_time", {.dimension = Dimension::time,
                                                    .range = {.min = 0, .max = 60, .max_is_open = false},
                                                    .doc = "time of a measurement at rest"}),
    field<&CalibrationDef::rest_band>(
        "rest_band", {.range = kFractionAboveZero, .doc = "movement at rest that is accepted, of the device's range"}),
    field<&CalibrationDef::least_travel>(
        "least_travel", {.range = kFractionAboveZero, .doc = "travel below which an axis is refused, of the range"}),
    field<&CalibrationDef::dead_zone_margin>("dead_zone_margin",
                                             {.range = {.min = 0, .max = 0.5, .min_is_open = false},
                                              .doc = "part of the dead zone beside the counts met at rest"}),
};

constexpr double kOuterQuarter = 0.25;  // of the device's range: a pedal rests there
constexpr double kAtEnd = 0.05;         // of the travel: distance from its end at which an axis rests at the end
constexpr double kMostDeadZone = 0.5;   // a larger one hides half of the stick

double width(const AxisRange& range) {
  return static_cast<double>(range.maximum) - static_cast<double>(range.minimum);
}

bool is_pedal(const Calibration::Axis& axis) {
  const double travel = static_cast<double>(axis.highest - axis.lowest);
  const double outer = kOuterQuarter * width(axis.range), end = kAtEnd * travel;
  const bool rests_low = static_cast<double>(axis.rest_lowest - axis.lowest) <= end &&
                         static_cast<double>(axis.rest_lowest) <= axis.range.minimum + outer;
  const bool rests_high = static_cast<double>(axis.highest - axis.rest_highest) <= end &&
                          static_cast<double>(axis.rest_highest) >= axis.range.maximum - outer;
  return rests_low || rests_high;
}

// "ABS_Y moved by 12 of 1023 counts"; empty: far enough
std::string travel_fault(const Calibration::Axis& axis, const CalibrationDef& def) {
  const double travel = static_cast<double>(axis.highest - axis.lowest), least = def.least_travel * width(axis.range);
  if (travel < least) {
    return fmt::format("{} moved by {} of {:.0f} counts", axis.range.code, axis.highest - axis.lowest,
                       width(axis.range));
  }
  if (is_pedal(axis)) return "";
  const double below = static_cast<double>(axis.rest_lowest - axis.lowest);
  const double above = static_cast<double>(axis.highest - axis.rest_highest);
  if (std::min(below, above) < least / 2) {
    return fmt::format("{} moved to one side only, by {:.0f} counts down and {:.0f} up", axis.range.code, below, above);
  }
  return "";
}

void take_rest(Calibration::Axis& axis) {
  axis.rest_lowest = axis.has_rest ? std::min(axis.rest_lowest, axis.now_lowest) : axis.now_lowest;
  axis.rest_highest = axis.has_rest ? std::max(axis.rest_highest, axis.now_highest) : axis.now_highest;
  axis.has_rest = true;
}

void begin_rest(Calibration& calibration) {
  calibration.time = 0;
  for (Calibration::Axis& axis : calibration.axes) axis.has_now = false;
}

void count_rest(Calibration& calibration, std::span<const std::int32_t> counts, double dt) {
  bool has_moved = false;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    Calibration::Axis& axis = calibration.axes[i];
    axis.now_lowest = axis.has_now ? std::min<std::int64_t>(axis.now_lowest, counts[i]) : counts[i];
    axis.now_highest = axis.has_now ? std::max<std::int64_t>(axis.now_highest, counts[i]) : counts[i];
    axis.has_now = true;
    const double band = calibration.def.rest_band * width(axis.range);
    has_moved = has_moved || static_cast<double>(axis.now_highest - axis.now_lowest) > band;
    // it comes back to where it was, but for friction
    const std::int64_t apart = std::max(axis.now_highest - axis.rest_lowest, axis.rest_highest - axis.now_lowest);
    has_moved = has_moved || (axis.has_rest && static_cast<double>(apart) > 2 * band);
  }
  if (has_moved) {
    ++calibration.restarts;
    begin_rest(calibration);
    return;
  }
  calibration.time += dt;
  if (calibration.time < calibration.def.rest_time) return;
  for (Calibration::Axis& axis : calibration.axes) take_rest(axis);
  calibration.phase = calibration.phase == CalibrationPhase::rest ? CalibrationPhase::ends : CalibrationPhase::done;
  begin_rest(calibration);
}

}  // namespace

std::span<const Field> calibration_fields() noexcept {
  return kCalibrationFields;
}

Calibration begin_calibration(const CalibrationDef& def, const std::vector<AxisRange>& ranges, Problems& problems) {
  Calibration calibration;
  calibration.def = def;
  for (const AxisRange& range : ranges) {
    if (range.minimum >= range.maximum) {
      problems.push_back({range.code, fmt::format("the device states the range {} to {}", range.minimum, range.maximum),
                          "a range that is not empty; enter lowest, centre and highest by hand", ""});
    }
    Calibration::Axis axis;
    axis.range = range;
    calibration.axes.push_back(axis);
  }
  if (ranges.empty()) problems.push_back({"axes", "the device has no axis", "a device with axes", ""});
  return calibration;
}

void add_counts(Calibration& calibration, std::span<const std::int32_t> counts, double dt) noexcept {
  SLEW_CHECK(counts.size() == calibration.axes.size());
  if (calibration.phase == CalibrationPhase::done) return;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    Calibration::Axis& axis = calibration.axes[i];
    axis.lowest = axis.has_counts ? std::min<std::int64_t>(axis.lowest, counts[i]) : counts[i];
    axis.highest = axis.has_counts ? std::max<std::int64_t>(axis.highest, counts[i]) : counts[i];
    axis.has_counts = true;
  }
  if (calibration.phase != CalibrationPhase::ends) count_rest(calibration, counts, dt);
}

void end_of_ends(Calibration& calibration, Problems& problems) {
  SLEW_CHECK(calibration.phase == CalibrationPhase::ends);
  bool is_refused = false;
  for (const Calibration::Axis& axis : calibration.axes) {
    const std::string fault = travel_fault(axis, calibration.def);
    if (fault.empty()) continue;
    is_refused = true;
    problems.push_back({axis.range.code, fault, "every axis at both of its ends once", ""});
  }
  if (!is_refused) calibration.phase = CalibrationPhase::rest_again;
}

std::vector<AxisDef> results(const Calibration& calibration) {
  SLEW_CHECK(calibration.phase == CalibrationPhase::done);
  std::vector<AxisDef> axes;
  for (const Calibration::Axis& axis : calibration.axes) {
    AxisDef def;
    def.code = axis.range.code;
    def.channel = static_cast<std::int64_t>(axes.size());
    def.lowest = axis.lowest;
    def.highest = axis.highest;
    def.centre = (axis.rest_lowest + axis.rest_highest) / 2;
    if (is_pedal(axis)) {
      def.centre = axis.rest_highest - axis.lowest < axis.highest - axis.rest_lowest ? axis.lowest : axis.highest;
    }
    const std::int64_t below = def.centre - def.lowest, above = def.highest - def.centre;
    const std::int64_t half = std::min(below, above) > 0 ? std::min(below, above) : std::max(below, above);
    const std::int64_t rest = std::max(def.centre - axis.rest_lowest, axis.rest_highest - def.centre);
    def.dead_zone = std::min(static_cast<double>(rest) / static_cast<double>(half) + calibration.def.dead_zone_margin,
                             kMostDeadZone);
    axes.push_back(def);
  }
  return axes;
}

}  // namespace slew::devices
