// SPDX-License-Identifier: Apache-2.0
// Which samples a physics role uses, and how old they are: at the start of a session and in each step. Pure functions
// that the nodes, the session in one process and the replay share.
//
//   start   mechanics and flex publish INIT; hydraulics starts from the INIT of mechanics and publishes sample 0;
//           mechanics starts from that and from the INIT of flex, flex and sensors from the sample 0 of mechanics
//   step n  mechanics and hydraulics use the sample of each other that holds at the last exchange, flex the mechanics'
//           sample of the instant that it computes forces for, sensors that of their instant
#pragma once

#include <algorithm>
#include <iterator>

#include "core/time.h"
#include "coupling/samples.h"
#include "scene/scene.h"
#include "transport/wire.h"

namespace slew::node {

// The sample that a role starts from.
enum class StartSample : std::uint8_t { init, first };

struct Reading {
  wire::Role reader;
  wire::Role writer;
  wire::Topic sample;
  StartSample start;
};

inline constexpr Reading kReadings[] = {
    {wire::Role::hydraulics, wire::Role::mechanics, wire::Topic::mechanism, StartSample::init},
    {wire::Role::mechanics, wire::Role::hydraulics, wire::Topic::actuators, StartSample::first},
    {wire::Role::mechanics, wire::Role::flex, wire::Topic::elastic, StartSample::init},
    {wire::Role::flex, wire::Role::mechanics, wire::Topic::flexible, StartSample::first},
    {wire::Role::sensor, wire::Role::mechanics, wire::Topic::poses, StartSample::first},
};

// Every sample but that of sensors has one reader among the physics roles.
[[nodiscard]] constexpr const Reading& reading_of(wire::Topic sample) noexcept {
  return *std::find_if(std::begin(kReadings), std::end(kReadings),
                       [sample](const Reading& reading) { return reading.sample == sample; });
}

// Each starts from samples of those before it.
inline constexpr wire::Role kStartOrder[] = {wire::Role::hydraulics, wire::Role::mechanics, wire::Role::flex,
                                             wire::Role::sensor};

// How often samples are exchanged, from the session's settings.
struct ExchangeRules {
  StepIndex port_every = 1;      // steps between two exchanges of mechanics and hydraulics
  StepIndex flexible_every = 1;  // steps between two samples to and from flexible bodies, Scene::flexible_every()
  StepIndex sensor_every = 1;    // steps between two samples to and from sensors
  coupling::ElasticExchange elastic = coupling::ElasticExchange::once;

  // Steps from one sample of the topic to the next one that its reader uses.
  [[nodiscard]] constexpr StepIndex every(wire::Topic sample) const noexcept {
    if (is_of_ports(sample)) return port_every;
    return sample == wire::Topic::poses || sample == wire::Topic::sensors ? sensor_every : flexible_every;
  }
  // A role publishes the samples of its ports at every step, although its partner does not use each.
  [[nodiscard]] constexpr bool is_published_at(wire::Topic sample, StepIndex step) const noexcept {
    return is_of_ports(sample) || step % every(sample) == 0;
  }
  // Elastic forces that are published once are used at the start only.
  [[nodiscard]] constexpr bool is_used_in_steps(wire::Topic sample) const noexcept {
    return sample != wire::Topic::elastic || elastic != coupling::ElasticExchange::once;
  }
  // Age, in step n, of the sample that its reader uses [steps].
  [[nodiscard]] constexpr StepIndex age(wire::Topic sample, StepIndex n) const noexcept { return n % every(sample); }

 private:
  [[nodiscard]] static constexpr bool is_of_ports(wire::Topic sample) noexcept {
    return sample == wire::Topic::mechanism || sample == wire::Topic::actuators;
  }
};

[[nodiscard]] inline ExchangeRules exchange_rules(const scene::Scene& scene) noexcept {
  return {scene.session.exchange_every, scene.flexible_every(), scene.recording.every, scene.session.flexible};
}

}  // namespace slew::node
