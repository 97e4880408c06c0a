// SPDX-License-Identifier: Apache-2.0
#include "transport/roles.h"

#include <algorithm>
#include <array>

#include "core/node_names.h"

namespace slew::transport {
namespace {

using wire::Role;
using wire::Topic;

constexpr TopicSet all_but(Topic topic) {
  TopicSet topics = TopicSet::all();
  topics.erase(topic);
  return topics;
}

constexpr std::array kRoles = {
    RoleTraits{Role::io,
               kNodeNames[0],
               Needed::always,
               false,
               kIoPriority,
               Topic::tick,
               {Topic::session, Topic::node_status, Topic::tick, Topic::variable_directory, Topic::variables,
                Topic::controller_lease, Topic::control_reply, Topic::health, Topic::resend, Topic::state},
               {Topic::session, Topic::node_status, Topic::mechanism, Topic::actuators, Topic::elastic,
                Topic::controller_input, Topic::control_request, Topic::health, Topic::resend, Topic::checkpoint,
                Topic::state, Topic::sensors},
               {}},
    RoleTraits{Role::mechanics,
               kNodeNames[1],
               Needed::with_mechanics,
               false,
               kPhysicsPriority,
               Topic::mechanism,
               {Topic::node_status, Topic::mechanism, Topic::flexible, Topic::variable_directory, Topic::variables,
                Topic::health, Topic::resend, Topic::checkpoint, Topic::poses},
               {Topic::session, Topic::node_status, Topic::tick, Topic::actuators, Topic::elastic, Topic::health,
                Topic::resend, Topic::state},
               {}},
    RoleTraits{
        Role::hydraulics,
        kNodeNames[2],
        Needed::with_hydraulics,
        false,
        kPhysicsPriority,
        Topic::actuators,
        {Topic::node_status, Topic::actuators, Topic::variable_directory, Topic::variables, Topic::health,
         Topic::resend, Topic::checkpoint},
        {Topic::session, Topic::node_status, Topic::tick, Topic::mechanism, Topic::health, Topic::resend, Topic::state},
        {}},
    RoleTraits{
        Role::flex,
        kNodeNames[3],
        Needed::with_modes,
        true,
        kPhysicsPriority,
        Topic::elastic,
        {Topic::node_status, Topic::elastic, Topic::variable_directory, Topic::variables, Topic::health, Topic::resend,
         Topic::checkpoint},
        {Topic::session, Topic::node_status, Topic::tick, Topic::flexible, Topic::health, Topic::resend, Topic::state},
        {}},
    RoleTraits{Role::recorder,
               kNodeNames[4],
               Needed::to_record,
               false,
               kRecorderPriority,
               Topic::node_status,
               {Topic::node_status, Topic::health, Topic::resend},
               all_but(Topic::checkpoint),
               {}},
    RoleTraits{Role::observer,
               "observer",
               Needed::never,
               false,
               0,
               Topic::node_status,
               {Topic::controller_input, Topic::control_request, Topic::state},
               {Topic::session, Topic::node_status, Topic::variable_directory, Topic::variables,
                Topic::controller_lease, Topic::control_reply, Topic::health, Topic::state},
               {Topic::mechanism, Topic::actuators, Topic::sensors}},
    RoleTraits{Role::controller,
               "controller",
               Needed::never,
               false,
               0,
               Topic::node_status,
               {Topic::controller_input, Topic::control_request},
               {Topic::session, Topic::node_status, Topic::variable_directory, Topic::variables,
                Topic::controller_lease, Topic::control_reply, Topic::health},
               {}},
    RoleTraits{
        Role::sensor,
        kNodeNames[5],
        Needed::with_sensors,
        true,
        0,
        Topic::sensors,
        {Topic::node_status, Topic::sensors, Topic::variable_directory, Topic::variables, Topic::health, Topic::resend,
         Topic::checkpoint},
        {Topic::session, Topic::node_status, Topic::tick, Topic::poses, Topic::health, Topic::resend, Topic::state},
        {}},
};

constexpr bool is_in_order() {
  for (std::size_t i = 0; i < kRoles.size(); ++i) {
    if (static_cast<std::size_t>(kRoles[i].role) != i) return false;
  }
  return true;
}
static_assert(is_in_order(), "the table is indexed by role");

// by need
constexpr std::array kNodes = [] {
  std::array<Role, static_cast<std::size_t>(Needed::never)> nodes{};
  for (const RoleTraits& row : kRoles) {
    if (row.needed != Needed::never) nodes[static_cast<std::size_t>(row.needed)] = row.role;
  }
  return nodes;
}();
static_assert(kNodes.front() == Role::io && kNodes.back() == Role::recorder, "between them are the physics nodes");

}  // namespace

std::span<const RoleTraits> roles() noexcept {
  return kRoles;
}

const RoleTraits& traits(Role role) noexcept {
  return kRoles[static_cast<std::size_t>(role)];
}

std::optional<Role> role_of(std::string_view name) noexcept {
  const auto found = std::find_if(kRoles.begin(), kRoles.end(), [&](const RoleTraits& r) { return r.name == name; });
  return found == kRoles.end() ? std::nullopt : std::optional(found->role);
}

std::span<const Role> node_roles() noexcept {
  return kNodes;
}

std::span<const Role> state_roles() noexcept {
  return node_roles().first(kNodes.size() - 1);
}

std::span<const Role> physics_roles() noexcept {
  return state_roles().subspan(1);
}

bool is_physics(Role role) noexcept {
  return std::ranges::find(physics_roles(), role) != physics_roles().end();
}

TopicSet topics_readable(Role role) noexcept {
  return traits(role).reads | traits(role).reads_on_request;
}

// needed for every received message
constexpr std::array kWriters = [] {
  std::array<std::uint32_t, wire::kTopics> writers{};
  for (std::size_t topic = 0; topic < wire::kTopics; ++topic) {
    for (const Role role : kNodes) {
      const RoleTraits& traits = kRoles[static_cast<std::size_t>(role)];
      if (traits.writes.contains(static_cast<Topic>(topic))) writers[topic] |= bit(role);
    }
  }
  return writers;
}();

std::uint32_t writers_of(Topic topic) noexcept {
  return kWriters[static_cast<std::size_t>(topic)];
}

std::uint32_t readers_of(Topic topic) noexcept {
  std::uint32_t bits = 0;
  for (const Role role : node_roles()) {
    if (traits(role).reads.contains(topic)) bits |= bit(role);
  }
  return bits;
}

bool is_sample(Topic topic) noexcept {
  return topic == Topic::mechanism || topic == Topic::actuators || topic == Topic::flexible ||
         topic == Topic::elastic || topic == Topic::poses || topic == Topic::sensors;
}

}  // namespace slew::transport
