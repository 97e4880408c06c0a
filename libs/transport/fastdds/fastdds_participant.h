// SPDX-License-Identifier: Apache-2.0
// A participant of Fast DDS: the one place that configures it.
//
// Unicast only, on one interface: sockets receive and send on its address alone, so that on loopback nothing reaches or
// leaves this machine. Shared memory only by `fastdds-shm`. No file of profiles and no FASTRTPS_ variable is
// consulted. UDP ports as those of Cyclone (cyclone_domain.h).
#pragma once

#include <fastdds/rtps/participant/RTPSParticipant.h>

#include <memory>

#include "core/status.h"
#include "transport/fastdds/fastdds_discovery.h"
#include "transport/fastdds/fastdds_topics.h"
#include "transport/network.h"

namespace slew::transport {

struct ParticipantDeleter {
  void operator()(rtps::RTPSParticipant* participant) const { rtps::RTPSDomain::removeRTPSParticipant(participant); }
};
using Participant = std::unique_ptr<rtps::RTPSParticipant, ParticipantDeleter>;

// Fills `participant`, or reports what is wrong.
[[nodiscard]] Status open_participant(const Network& network, const std::string& name, FastDiscovery& discovery,
                                      Participant& participant);

[[nodiscard]] RepairTimes repair_times(const Network& network);

// "; " and the last message of Fast DDS, if there is one.
[[nodiscard]] std::string last_message();

}  // namespace slew::transport
