// SPDX-License-Identifier: Apache-2.0
// Writers and readers of other participants, as they are discovered.
#pragma once

#include <fastdds/rtps/participant/RTPSParticipantListener.h>

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "transport/discovered_endpoint.h"
#include "transport/transport.h"

namespace slew::transport {

namespace rtps = eprosima::fastrtps::rtps;

class FastDiscovery final : public rtps::RTPSParticipantListener {
 public:
  [[nodiscard]] std::vector<std::string> writers(wire::Topic topic, const std::string& session) const;
  [[nodiscard]] WriterSight see_writer(wire::Topic topic, std::uint64_t writer) const;
  [[nodiscard]] std::vector<std::string> misfits(const Endpoint& endpoint) const;
  // How many of these readers our writer's messages reach.
  [[nodiscard]] std::size_t fitting(const std::vector<rtps::GUID_t>& readers, const Endpoint& endpoint) const;

 private:
  struct Entry {
    wire::Topic topic;
    Side side;
    DiscoveredEndpoint endpoint;
  };

  // why our endpoint on that topic does not match; empty: it does
  [[nodiscard]] static std::string problem_of(const Entry& entry, const Endpoint& own);

  // on threads of Fast DDS
  void onParticipantDiscovery(rtps::RTPSParticipant*, rtps::ParticipantDiscoveryInfo&& info) override;
  void onReaderDiscovery(rtps::RTPSParticipant*, rtps::ReaderDiscoveryInfo&& info) override;
  void onWriterDiscovery(rtps::RTPSParticipant*, rtps::WriterDiscoveryInfo&& info) override;
  template <typename Data>
  void note(const Data& data, Side side, bool has_left);

  mutable std::mutex mutex_;
  std::map<rtps::GUID_t, Entry> endpoints_;
};

}  // namespace slew::transport
