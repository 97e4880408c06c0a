// SPDX-License-Identifier: Apache-2.0
// The topics of a session: name, message type and delivery. idl/README.md has the same table with rates and units.
//
// Every topic is reliable and keep-last. The depth is the number of messages that a writer keeps for slow or stopped
// readers and a reader keeps until taken; transient-local topics also give a late reader each writer's last `kept`
// ones.
#pragma once

#include <cstdint>
#include <initializer_list>

#include "transport/wire.h"

namespace slew::transport {

struct TopicTraits {
  wire::Topic topic;
  const char* name;       // DDS topic name
  const char* type_name;  // DDS type name, of idl/slewring.idl
  std::int32_t depth;     // messages, >= 4 windows for what a step waits for; the recorded ones bear a stop of 200 ms
  std::int32_t kept;      // messages of each writer for late readers; 0: volatile
};

[[nodiscard]] const TopicTraits& traits(wire::Topic topic) noexcept;

// A choice of topics.
class TopicSet {
 public:
  constexpr TopicSet() = default;
  constexpr TopicSet(std::initializer_list<wire::Topic> topics) {
    for (const wire::Topic topic : topics) insert(topic);
  }
  [[nodiscard]] static constexpr TopicSet all() {
    TopicSet set;
    set.bits_ = (1u << wire::kTopics) - 1;
    return set;
  }
  constexpr void insert(wire::Topic topic) { bits_ |= 1u << static_cast<unsigned>(topic); }
  constexpr void erase(wire::Topic topic) { bits_ &= ~(1u << static_cast<unsigned>(topic)); }
  [[nodiscard]] constexpr TopicSet operator|(TopicSet other) const {
    other.bits_ |= bits_;
    return other;
  }
  [[nodiscard]] constexpr bool is_empty() const { return bits_ == 0; }
  [[nodiscard]] constexpr bool contains(wire::Topic topic) const {
    return (bits_ & (1u << static_cast<unsigned>(topic))) != 0;
  }

 private:
  std::uint32_t bits_ = 0;
};

// The topic on which a message type travels.
template <typename M>
inline constexpr wire::Topic kTopicOf = wire::Topic::count;
template <>
inline constexpr wire::Topic kTopicOf<wire::SessionDescription> = wire::Topic::session;
template <>
inline constexpr wire::Topic kTopicOf<wire::NodeStatus> = wire::Topic::node_status;
template <>
inline constexpr wire::Topic kTopicOf<wire::Tick> = wire::Topic::tick;
template <>
inline constexpr wire::Topic kTopicOf<wire::MechanismMessage> = wire::Topic::mechanism;
template <>
inline constexpr wire::Topic kTopicOf<wire::ActuatorMessage> = wire::Topic::actuators;
template <>
inline constexpr wire::Topic kTopicOf<wire::FlexibleMessage> = wire::Topic::flexible;
template <>
inline constexpr wire::Topic kTopicOf<wire::ElasticMessage> = wire::Topic::elastic;
template <>
inline constexpr wire::Topic kTopicOf<wire::PoseMessage> = wire::Topic::poses;
template <>
inline constexpr wire::Topic kTopicOf<wire::SensorMessage> = wire::Topic::sensors;
template <>
inline constexpr wire::Topic kTopicOf<wire::VariableDirectory> = wire::Topic::variable_directory;
template <>
inline constexpr wire::Topic kTopicOf<wire::VariableBlock> = wire::Topic::variables;
template <>
inline constexpr wire::Topic kTopicOf<wire::ControllerInput> = wire::Topic::controller_input;
template <>
inline constexpr wire::Topic kTopicOf<wire::ControllerLease> = wire::Topic::controller_lease;
template <>
inline constexpr wire::Topic kTopicOf<wire::ControlRequest> = wire::Topic::control_request;
template <>
inline constexpr wire::Topic kTopicOf<wire::ControlReply> = wire::Topic::control_reply;
template <>
inline constexpr wire::Topic kTopicOf<wire::Health> = wire::Topic::health;
template <>
inline constexpr wire::Topic kTopicOf<wire::ResendRequest> = wire::Topic::resend;
// recordings have Topic::state; physics nodes publish their parts on Topic::checkpoint
template <>
inline constexpr wire::Topic kTopicOf<wire::StatePart> = wire::Topic::state;

}  // namespace slew::transport
