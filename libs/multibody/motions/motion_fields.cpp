// SPDX-License-Identifier: Apache-2.0
#include "multibody/motions/motion_fields.h"

#include <array>

namespace slew::multibody {
namespace {

using enum Dimension;

constexpr std::array<std::string_view, 3> kEnds = {"hold", "continued", "refused"};
constexpr Range kAxis{.min = 1, .max = 2, .min_is_open = false, .max_is_open = false};

constexpr Field kJoint = field<&MotionDef::joint>(
    "joint", {.presence = Presence::required, .reference = "joint", .doc = "joint whose coordinate it drives"});
constexpr Field kUniversalAxis =
    field<&MotionDef::axis>("axis", {.range = kAxis, .doc = "axis of a universal joint: z of frame 1 or of frame 2"});

constexpr Field points_row(Dimension value) {
  return field<&MotionDef::points>("points", {.dimension = Dimension::time,
                                              .value_dimension = value,
                                              .presence = Presence::required,
                                              .doc = "position over the session's time, a cubic spline"});
}
constexpr Field kPositionEnds = field<&MotionDef::ends>(
    "ends", {.choices = kEnds,
             .doc = "outside of the times: held (slope 0 at the ends), continued with the end's speed, refused"});
constexpr ReadBy kReadByPoints[] = {read_by_set<&MotionDef::points>("points", "points")};
constexpr Field kSpeedEnds = field<&MotionDef::ends>(
    "ends", {.choices = kEnds,
             .read_by = kReadByPoints,
             .doc = "outside of the times: the speed is held, continued with the end's acceleration, refused"});
constexpr Field offset_row(Dimension position) {
  return field<&MotionDef::offset>("offset",
                                   {.dimension = position, .doc = "mean position; none: fits the start position"});
}
constexpr Field amplitude_row(Dimension position) {
  return field<&MotionDef::amplitude>("amplitude",
                                      {.dimension = position, .presence = Presence::required, .doc = "of the sine"});
}
constexpr Field kFrequency = field<&MotionDef::frequency>(
    "frequency",
    {.dimension = frequency, .range = kNotNegative, .presence = Presence::required, .doc = "periods per time"});
constexpr Field kPhase =
    field<&MotionDef::phase>("phase", {.dimension = angle, .doc = "phase of the sine at the start"});
constexpr Field from_row(Dimension position) {
  return field<&MotionDef::from>("from",
                                 {.dimension = position, .doc = "position before the ramp; none: the start position"});
}
constexpr Field to_row(Dimension position) {
  return field<&MotionDef::to>("to", {.dimension = position, .presence = Presence::required, .doc = "after the ramp"});
}
constexpr Field kStart =
    field<&MotionDef::start>("start", {.dimension = Dimension::time, .doc = "time at which the ramp begins"});
constexpr Field kDuration = field<&MotionDef::duration>(
    "duration",
    {.dimension = Dimension::time, .range = kPositive, .presence = Presence::required, .doc = "of the ramp"});
constexpr Field speed_row(Dimension rate) {
  return field<&MotionDef::speed>("speed", {.dimension = rate, .doc = "constant speed, from the start position on"});
}
constexpr Field speed_points_row(Dimension rate) {
  return field<&MotionDef::points>("points",
                                   {.dimension = Dimension::time,
                                    .value_dimension = rate,
                                    .doc = "speed over the session's time, added to `speed`: a cubic spline"});
}

constexpr Field kRotationTable[] = {kJoint, kUniversalAxis, points_row(angle), kPositionEnds};
constexpr Field kRotationHarmonic[] = {kJoint,     kUniversalAxis, offset_row(angle), amplitude_row(angle),
                                       kFrequency, kPhase};
constexpr Field kRotationRamp[] = {kJoint, kUniversalAxis, from_row(angle), to_row(angle), kStart, kDuration};
constexpr Field kRotationSpeed[] = {kJoint, kUniversalAxis, speed_row(angular_velocity),
                                    speed_points_row(angular_velocity), kSpeedEnds};
constexpr Field kTranslationTable[] = {kJoint, points_row(length), kPositionEnds};
constexpr Field kTranslationHarmonic[] = {kJoint, offset_row(length), amplitude_row(length), kFrequency, kPhase};
constexpr Field kTranslationRamp[] = {kJoint, from_row(length), to_row(length), kStart, kDuration};
constexpr Field kTranslationSpeed[] = {kJoint, speed_row(velocity), speed_points_row(velocity), kSpeedEnds};

template <MotionKind Kind, MotionShape Shape>
void* append(MechanicsDef& mechanics, std::string_view element) {
  MotionDef& def = mechanics.motions.emplace_back();
  def.name = element;
  def.kind = Kind;
  def.shape = Shape;
  return &def;
}

using enum MotionKind;
using enum MotionShape;

constexpr ElementType kTypes[] = {
    {"rotation_table", "motion", "angle of a joint by a table over time", kRotationTable, append<rotation, table>},
    {"rotation_harmonic", "motion", "angle of a joint as a sine of time", kRotationHarmonic,
     append<rotation, harmonic>},
    {"rotation_ramp", "motion", "angle of a joint from one value smoothly to another", kRotationRamp,
     append<rotation, ramp>},
    {"rotation_speed", "motion", "angular speed of a joint", kRotationSpeed, append<rotation, MotionShape::speed>},
    {"translation_table", "motion", "displacement of a joint by a table over time", kTranslationTable,
     append<translation, table>},
    {"translation_harmonic", "motion", "displacement of a joint as a sine of time", kTranslationHarmonic,
     append<translation, harmonic>},
    {"translation_ramp", "motion", "displacement of a joint from one value smoothly to another", kTranslationRamp,
     append<translation, ramp>},
    {"translation_speed", "motion", "speed of a joint's displacement", kTranslationSpeed,
     append<translation, MotionShape::speed>},
};
static_assert(std::size(kTypes) == 2 * kMotionShapes);

}  // namespace

std::span<const ElementType> motion_types() noexcept {
  return kTypes;
}

}  // namespace slew::multibody
