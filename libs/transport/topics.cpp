// SPDX-License-Identifier: Apache-2.0
#include "transport/topics.h"

#include <array>

namespace slew::transport {
namespace {

constexpr std::int32_t kStepDepth = 1024;     // 200 ms at 5 kHz
constexpr std::int32_t kDialogueDepth = 256;  // requests and replies of a few partners

constexpr std::array<TopicTraits, wire::kTopics> kTraits = {{
    {wire::Topic::session, "slewring/session", "slewring::SessionDescription", 4, 1},
    {wire::Topic::node_status, "slewring/node_status", "slewring::NodeStatus", kDialogueDepth, 1},
    {wire::Topic::tick, "slewring/tick", "slewring::Tick", kStepDepth, 0},
    {wire::Topic::mechanism, "slewring/mechanism", "slewring::MechanismMessage", kStepDepth, 0},
    {wire::Topic::actuators, "slewring/actuators", "slewring::ActuatorMessage", kStepDepth, 0},
    {wire::Topic::flexible, "slewring/flexible", "slewring::FlexibleMessage", kStepDepth, 0},
    {wire::Topic::elastic, "slewring/elastic", "slewring::ElasticMessage", kStepDepth, 0},
    {wire::Topic::variable_directory, "slewring/variable_directory", "slewring::VariableDirectory", kDialogueDepth, 64},
    {wire::Topic::variables, "slewring/variables", "slewring::VariableBlock", kStepDepth, 0},
    {wire::Topic::controller_input, "slewring/controller_input", "slewring::ControllerInput", kStepDepth, 0},
    {wire::Topic::controller_lease, "slewring/controller_lease", "slewring::ControllerLease", kDialogueDepth, 64},
    {wire::Topic::control_request, "slewring/control_request", "slewring::ControlRequest", kDialogueDepth, 0},
    {wire::Topic::control_reply, "slewring/control_reply", "slewring::ControlReply", kDialogueDepth, 0},
    {wire::Topic::health, "slewring/health", "slewring::Health", kDialogueDepth, 0},
    {wire::Topic::resend, "slewring/resend", "slewring::ResendRequest", kDialogueDepth, 0},
    {wire::Topic::checkpoint, "slewring/checkpoint", "slewring::StatePart", kStepDepth, 0},
    {wire::Topic::state, "slewring/state", "slewring::StatePart", kStepDepth, 0},
    {wire::Topic::poses, "slewring/poses", "slewring::PoseMessage", kStepDepth, 0},
    {wire::Topic::sensors, "slewring/sensors", "slewring::SensorMessage", kStepDepth, 0},
}};

constexpr bool topics_are_in_order() {
  for (std::size_t i = 0; i < kTraits.size(); ++i) {
    if (static_cast<std::size_t>(kTraits[i].topic) != i) return false;
  }
  return true;
}
static_assert(topics_are_in_order(), "the table is indexed by topic");

}  // namespace

const TopicTraits& traits(wire::Topic topic) noexcept {
  return kTraits[static_cast<std::size_t>(topic)];
}

}  // namespace slew::transport
