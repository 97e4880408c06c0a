// SPDX-License-Identifier: Apache-2.0
// The generated C type that belongs to each of our messages.
#pragma once

#include <slewring.h>

#include "transport/wire.h"

namespace slew::testing {

template <typename M, typename G, const dds_topic_descriptor_t* D>
struct Pair {
  using Message = M;
  using Generated = G;
  static constexpr const dds_topic_descriptor_t* kDescriptor = D;
};

using SessionDescriptionPair =
    Pair<wire::SessionDescription, slewring_SessionDescription, &slewring_SessionDescription_desc>;
using NodeStatusPair = Pair<wire::NodeStatus, slewring_NodeStatus, &slewring_NodeStatus_desc>;
using TickPair = Pair<wire::Tick, slewring_Tick, &slewring_Tick_desc>;
using MechanismPair = Pair<wire::MechanismMessage, slewring_MechanismMessage, &slewring_MechanismMessage_desc>;
using ActuatorPair = Pair<wire::ActuatorMessage, slewring_ActuatorMessage, &slewring_ActuatorMessage_desc>;
using FlexiblePair = Pair<wire::FlexibleMessage, slewring_FlexibleMessage, &slewring_FlexibleMessage_desc>;
using ElasticPair = Pair<wire::ElasticMessage, slewring_ElasticMessage, &slewring_ElasticMessage_desc>;
using PosePair = Pair<wire::PoseMessage, slewring_PoseMessage, &slewring_PoseMessage_desc>;
using SensorPair = Pair<wire::SensorMessage, slewring_SensorMessage, &slewring_SensorMessage_desc>;
using DirectoryPair = Pair<wire::VariableDirectory, slewring_VariableDirectory, &slewring_VariableDirectory_desc>;
using BlockPair = Pair<wire::VariableBlock, slewring_VariableBlock, &slewring_VariableBlock_desc>;
using InputPair = Pair<wire::ControllerInput, slewring_ControllerInput, &slewring_ControllerInput_desc>;
using LeasePair = Pair<wire::ControllerLease, slewring_ControllerLease, &slewring_ControllerLease_desc>;
using RequestPair = Pair<wire::ControlRequest, slewring_ControlRequest, &slewring_ControlRequest_desc>;
using ReplyPair = Pair<wire::ControlReply, slewring_ControlReply, &slewring_ControlReply_desc>;
using HealthPair = Pair<wire::Health, slewring_Health, &slewring_Health_desc>;
using ResendPair = Pair<wire::ResendRequest, slewring_ResendRequest, &slewring_ResendRequest_desc>;
using StatePair = Pair<wire::StatePart, slewring_StatePart, &slewring_StatePart_desc>;

}  // namespace slew::testing
