// SPDX-License-Identifier: Apache-2.0
// The roles of a session, one row each. A new role is an enumerator in idl/slewring.idl and wire.h, its row here, and
// the folder of its program.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "transport/topics.h"
#include "transport/wire.h"

namespace slew::transport {

inline constexpr int kIoPriority = 30;  // the clock goes before the nodes that wait for it
inline constexpr int kPhysicsPriority = 20;
inline constexpr int kRecorderPriority = 10;  // in `real` pace no node waits for it: it compresses behind the physics

// What a session must have so that a role is required, one for each node: io, the physics nodes, the recorder.
enum class Needed : std::uint8_t {
  always,
  with_mechanics,
  with_hydraulics,
  with_modes,
  with_sensors,
  to_record,
  never
};

struct RoleTraits {
  wire::Role role;
  std::string_view name;  // in options, messages and certificates
  Needed needed;
  bool is_follower;    // publishes samples every k-th step, for which no other node waits in the step itself
  int priority;        // SCHED_FIFO priority with --rt; 0: none
  wire::Topic sample;  // the topic by which other nodes notice the role: its sample, else its status
  TopicSet writes;
  TopicSet reads;
  TopicSet reads_on_request;  // additional topics that a program may subscribe to; keys allow it
};

// All roles in the order of wire::Role.
[[nodiscard]] std::span<const RoleTraits> roles() noexcept;
[[nodiscard]] const RoleTraits& traits(wire::Role role) noexcept;
[[nodiscard]] std::optional<wire::Role> role_of(std::string_view name) noexcept;
// The nodes, in the order of Needed; those with a state; those with a subsystem.
[[nodiscard]] std::span<const wire::Role> node_roles() noexcept;
[[nodiscard]] std::span<const wire::Role> state_roles() noexcept;
[[nodiscard]] std::span<const wire::Role> physics_roles() noexcept;
[[nodiscard]] bool is_physics(wire::Role role) noexcept;
// Topics that keys let a role read.
[[nodiscard]] TopicSet topics_readable(wire::Role role) noexcept;
// One bit for each node that writes a topic.
[[nodiscard]] std::uint32_t writers_of(wire::Topic topic) noexcept;
// One bit for each node that reads a topic.
[[nodiscard]] std::uint32_t readers_of(wire::Topic topic) noexcept;
// A physics node has the samples of its partners among the topics that it reads.
[[nodiscard]] bool is_sample(wire::Topic topic) noexcept;

}  // namespace slew::transport
