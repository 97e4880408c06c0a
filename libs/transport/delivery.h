// SPDX-License-Identifier: Apache-2.0
// How every middleware delivers the topics of a session, beside topics.h.
#pragma once

#include "core/time.h"
#include "transport/network.h"

namespace slew::transport {

inline constexpr SimDuration kMaxBlocking = milliseconds(20);  // of publish()
inline constexpr SimDuration kFarewell = milliseconds(250);    // for the last messages to arrive, at the end
// blocks of variables that a writer keeps, first of all for a controller that finds it after the first ticks of its
// loop's delay
inline constexpr std::int32_t kLastBlocks = 128;
inline constexpr std::size_t kInFlight = 64;  // messages received and not taken, or written and not sent
// variables: io, mechanics, hydraulics, flex, sensor; inputs: as many controllers
inline constexpr std::int32_t kWriters = 5;

// Messages that a writer keeps for late readers; 0: volatile.
[[nodiscard]] constexpr std::int32_t kept_by_writer(const TopicTraits& topic) {
  return topic.topic == wire::Topic::variables ? kLastBlocks : topic.kept;
}

// Without keys a reader's depth is that of all its writers together: step by step, at full rate.
[[nodiscard]] constexpr std::int32_t depth_of_reader(const TopicTraits& topic) {
  const bool has_several_writers =
      topic.topic == wire::Topic::variables || topic.topic == wire::Topic::controller_input;
  return has_several_writers ? kWriters * topic.depth : topic.depth;
}

// Whether an endpoint receives kept messages of earlier writers.
[[nodiscard]] inline bool receives_kept(const Endpoint& endpoint, const TopicTraits& topic) {
  if (topic.topic == wire::Topic::variables) return endpoint.receives_last_blocks;
  if (topic.topic == wire::Topic::controller_lease) return endpoint.receives_last_leases;
  return kept_by_writer(topic) > 0;
}

}  // namespace slew::transport
