// SPDX-License-Identifier: Apache-2.0
// The types of instruments and their keys.
#include <array>

#include "measurement/instruments.h"

namespace slew::measurement {
namespace {

using enum Dimension;
using I = InstrumentDef;
using C = ChannelParameters;
using S = SamplingParameters;

constexpr double kLongestDelay = 10;  // s, bounds the samples that are on their way

// Keys of how samples are taken and sent, of all types.
constexpr std::array kSampling = {
    field<&I::sampling, &S::sample_time>(
        "sample_time",
        {.dimension = time, .range = kNotNegative, .doc = "time between two samples, whole steps; 0: every step"}),
    field<&I::sampling, &S::delay>(
        "delay", {.dimension = time,
                  .range = {.min = 0, .max = kLongestDelay, .min_is_open = false, .max_is_open = false},
                  .doc = "delay of the measured value, whole steps"}),
    field<&I::sampling, &S::seed>(
        "seed", {.range = kNotNegative, .doc = "seed of the random numbers, which also differ by the sensor's name"}),
    field<&I::sampling, &S::frozen>("frozen",
                                    {.range = kFraction,
                                     .change = Change::live,
                                     .doc = "fault: probability that a sample repeats the one before unnoticed"}),
    field<&I::sampling, &S::dropout>("dropout", {.range = kFraction,
                                                 .change = Change::live,
                                                 .doc = "fault: probability that a sample is lost; the last value "
                                                        "stays with is_valid 0"}),
};

// D: dimension of the value; Difference: that of its errors, which have no zero of their own.
template <Dimension D, Dimension Difference = D>
constexpr std::array kTransducer = {
    field<&I::variable>("variable",
                        {.presence = Presence::required,
                         .doc = "measured variable of the mechanics or hydraulics, as Vol_MainPump.pressure"}),
    field<&I::value, &C::lowest>("lowest",
                                 {.dimension = D, .presence = Presence::required, .doc = "lower end of the range"}),
    field<&I::value, &C::highest>("highest",
                                  {.dimension = D, .presence = Presence::required, .doc = "upper end of the range"}),
    field<&I::value, &C::gain>("gain", {.change = Change::live, .doc = "measured change over true change"}),
    field<&I::value, &C::offset>("offset",
                                 {.dimension = Difference, .change = Change::live, .doc = "added to the value"}),
    field<&I::value, &C::noise>("noise", {.dimension = Difference,
                                          .range = kNotNegative,
                                          .change = Change::live,
                                          .doc = "standard deviation of white noise"}),
    field<&I::value, &C::drift>(
        "drift",
        {.dimension = Difference, .change = Change::live, .doc = "growth of the offset in drift_time; 0: it stays"}),
    field<&I::value, &C::drift_time>("drift_time", {.dimension = time, .range = kPositive, .doc = "time of the drift"}),
    field<&I::value, &C::resolution>(
        "resolution", {.dimension = Difference, .range = kNotNegative, .doc = "quantisation step; 0: none"}),
    kSampling[0],
    kSampling[1],
    kSampling[2],
    kSampling[3],
    kSampling[4],
};

constexpr std::array kImu = {
    field<&I::body>("body", {.presence = Presence::required, .reference = "body", .doc = "body that carries it"}),
    field<&I::point>("point", {.dimension = length, .doc = "its place in the body's frame, whose axes it measures"}),
    field<&I::value, &C::highest>("acceleration_range",
                                  {.dimension = acceleration,
                                   .range = kPositive,
                                   .presence = Presence::required,
                                   .doc = "largest component of the specific force, either sign"}),
    field<&I::acceleration_offset>(
        "acceleration_offset",
        {.dimension = acceleration, .change = Change::live, .doc = "added to the components of the specific force"}),
    field<&I::value, &C::gain>("acceleration_gain",
                               {.change = Change::live, .doc = "measured change over true change"}),
    field<&I::value, &C::noise>("acceleration_noise", {.dimension = acceleration,
                                                       .range = kNotNegative,
                                                       .change = Change::live,
                                                       .doc = "standard deviation of white noise"}),
    field<&I::value, &C::drift>(
        "acceleration_drift",
        {.dimension = acceleration, .change = Change::live, .doc = "growth of the offset in drift_time"}),
    field<&I::value, &C::resolution>(
        "acceleration_resolution",
        {.dimension = acceleration, .range = kNotNegative, .doc = "quantisation step; 0: none"}),
    field<&I::rate, &C::highest>("rate_range", {.dimension = angular_velocity,
                                                .range = kPositive,
                                                .presence = Presence::required,
                                                .doc = "largest component of the rates, either sign"}),
    field<&I::rate_offset>(
        "rate_offset",
        {.dimension = angular_velocity, .change = Change::live, .doc = "added to the components of the rates"}),
    field<&I::rate, &C::gain>("rate_gain", {.change = Change::live, .doc = "measured change over true change"}),
    field<&I::rate, &C::noise>("rate_noise", {.dimension = angular_velocity,
                                              .range = kNotNegative,
                                              .change = Change::live,
                                              .doc = "standard deviation of white noise"}),
    field<&I::rate, &C::drift>(
        "rate_drift",
        {.dimension = angular_velocity, .change = Change::live, .doc = "growth of the offset in drift_time"}),
    field<&I::rate, &C::resolution>(
        "rate_resolution", {.dimension = angular_velocity, .range = kNotNegative, .doc = "quantisation step; 0: none"}),
    field<&I::value, &C::drift_time>("drift_time", {.dimension = time, .range = kPositive, .doc = "time of the drift"}),
    kSampling[0],
    kSampling[1],
    kSampling[2],
    kSampling[3],
    kSampling[4],
};

constexpr InstrumentTypeRow kTypes[] = {
    {"pressure", "pressure transducer", kTransducer<pressure>, pressure},
    {"flow", "flow meter", kTransducer<volume_flow>, volume_flow},
    {"position", "position or length transducer", kTransducer<length>, length},
    {"angle", "angle encoder", kTransducer<angle>, angle},
    {"speed", "speed transducer", kTransducer<velocity>, velocity},
    {"angular_speed", "tachometer", kTransducer<angular_velocity>, angular_velocity},
    {"force", "load cell", kTransducer<force>, force},
    {"torque", "torque transducer", kTransducer<torque>, torque},
    {"temperature", "thermometer", kTransducer<temperature, temperature_difference>, temperature},
    {"imu", "inertial measurement unit: specific force and rates at a point of a body", kImu, none},
};

}  // namespace

std::span<const InstrumentTypeRow> instrument_types() noexcept {
  return kTypes;
}

}  // namespace slew::measurement
