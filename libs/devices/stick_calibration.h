// SPDX-License-Identifier: Apache-2.0
// Calibration of a device's axes, step by step: at rest, to all ends, at rest again.
//
//   rest         counts while nothing is touched, for rest_time; begins again when an axis moves by more than rest_band
//   ends         the user moves every axis to its ends; end_of_ends() refuses axes that did not move, and goes on
//   rest_again   as rest, which shows where the axes come back to: within twice rest_band of the first rest
//   done
//
// Result of an axis: lowest and highest are the counts met, centre is the middle of all counts at rest, dead_zone
// covers them with a margin, 0.5 at most. An axis that rests in the outer quarter of the device's range and at an end
// of its travel is a pedal: its centre is that end. One that rests elsewhere must have moved to both sides.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/field.h"
#include "core/problem.h"
#include "devices/stick_axis.h"

namespace slew::devices {

struct CalibrationDef {
  double rest_time = 1;            // s
  double rest_band = 0.05;         // of the device's range: movement at rest that is accepted
  double least_travel = 0.25;      // of the device's range: less is refused; half of it to each side of the rest
  double dead_zone_margin = 0.02;  // of half the travel, beside the counts at rest
};
[[nodiscard]] std::span<const Field> calibration_fields() noexcept;

enum class CalibrationPhase : std::uint8_t { rest, ends, rest_again, done };

// What a device states of an axis (EVIOCGABS).
struct AxisRange {
  std::string code;
  std::int32_t minimum = 0, maximum = 0;
};

struct Calibration {
  CalibrationDef def;
  CalibrationPhase phase = CalibrationPhase::rest;
  double time = 0;             // s, of the present rest
  std::uint64_t restarts = 0;  // of a rest, since an axis moved
  struct Axis {
    AxisRange range;
    std::int64_t lowest = 0, highest = 0;            // counts met
    std::int64_t rest_lowest = 0, rest_highest = 0;  // at rest, both times
    std::int64_t now_lowest = 0, now_highest = 0;    // in the present rest
    bool has_counts = false, has_rest = false, has_now = false;
  };
  std::vector<Axis> axes;
};

// Appends a problem for each axis whose range is empty.
[[nodiscard]] Calibration begin_calibration(const CalibrationDef& def, const std::vector<AxisRange>& ranges,
                                            Problems& problems);

// Counts of all axes over the last dt [s]. Pre-condition: one for each axis.
void add_counts(Calibration& calibration, std::span<const std::int32_t> counts, double dt) noexcept;

// The user has moved all axes: on to rest_again, or a problem for each axis that did not move, and the phase stays.
// Pre-condition: phase ends.
void end_of_ends(Calibration& calibration, Problems& problems);

// Axes with lowest, centre, highest and dead_zone; channels count up. Pre-condition: phase done.
[[nodiscard]] std::vector<AxisDef> results(const Calibration& calibration);

}  // namespace slew::devices
