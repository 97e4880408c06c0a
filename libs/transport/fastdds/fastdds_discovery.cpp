// SPDX-License-Identifier: Apache-2.0
#include "transport/fastdds/fastdds_discovery.h"

#include <fastdds/rtps/participant/RTPSParticipant.h>

#include <algorithm>

#include "transport/delivery.h"
#include "transport/fastdds/fastdds_topics.h"

namespace slew::transport {
namespace {

[[nodiscard]] std::int64_t ns_of(const eprosima::fastrtps::Duration_t& duration) {
  return duration.is_infinite() ? INT64_MAX : duration.to_ns();
}

template <typename Qos>
EndpointQos endpoint_qos_of(const Qos& qos) {
  EndpointQos found;
  found.is_reliable = qos.m_reliability.kind == eprosima::fastrtps::RELIABLE_RELIABILITY_QOS;
  found.durability = qos.m_durability.kind;
  found.representation.assign(qos.representation.m_value.begin(), qos.representation.m_value.end());
  found.ownership = qos.m_ownership.kind;
  found.liveliness = qos.m_liveliness.kind;
  found.lease = ns_of(qos.m_liveliness.lease_duration);
  found.deadline = ns_of(qos.m_deadline.period);
  found.latency_budget = ns_of(qos.m_latencyBudget.duration);
  found.destination_order = qos.m_destinationOrder.kind;
  found.access_scope = qos.m_presentation.access_scope;
  found.is_coherent = qos.m_presentation.coherent_access;
  found.is_ordered = qos.m_presentation.ordered_access;
  return found;
}

template <typename Data>
DiscoveredEndpoint discovered(const Data& data) {
  DiscoveredEndpoint endpoint;
  endpoint.topic = data.topicName().to_string();
  endpoint.type = data.typeName().to_string();
  endpoint.partitions = data.m_qos.m_partition.getNames();
  if (endpoint.partitions.empty()) endpoint.partitions.emplace_back();
  endpoint.user_data.assign(data.m_qos.m_userData.begin(), data.m_qos.m_userData.end());
  endpoint.qos = endpoint_qos_of(data.m_qos);
  return endpoint;
}

}  // namespace

template <typename Data>
void FastDiscovery::note(const Data& data, Side side, bool has_left) {
  const std::lock_guard lock(mutex_);
  if (has_left) {
    endpoints_.erase(data.guid());
    return;
  }
  for (std::size_t i = 0; i < wire::kTopics; ++i) {
    const auto topic = static_cast<wire::Topic>(i);
    if (data.topicName() != traits(topic).name) continue;
    endpoints_.insert_or_assign(data.guid(), Entry{topic, side, discovered(data)});
  }
}

void FastDiscovery::onParticipantDiscovery(rtps::RTPSParticipant*, rtps::ParticipantDiscoveryInfo&& info) {
  using Info = rtps::ParticipantDiscoveryInfo;
  if (info.status != Info::REMOVED_PARTICIPANT && info.status != Info::DROPPED_PARTICIPANT) return;
  const std::lock_guard lock(mutex_);
  std::erase_if(endpoints_, [&](const auto& entry) { return entry.first.guidPrefix == info.info.m_guid.guidPrefix; });
}

void FastDiscovery::onReaderDiscovery(rtps::RTPSParticipant* participant, rtps::ReaderDiscoveryInfo&& info) {
  if (info.info.guid().guidPrefix == participant->getGuid().guidPrefix) return;
  note(info.info, Side::reader, info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER);
}

void FastDiscovery::onWriterDiscovery(rtps::RTPSParticipant* participant, rtps::WriterDiscoveryInfo&& info) {
  if (info.info.guid().guidPrefix == participant->getGuid().guidPrefix) return;
  note(info.info, Side::writer, info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER);
}

std::vector<std::string> FastDiscovery::writers(wire::Topic topic, const std::string& session) const {
  std::vector<std::string> found;
  const std::lock_guard lock(mutex_);
  for (const auto& [guid, entry] : endpoints_) {
    if (entry.topic != topic || entry.side != Side::writer || !is_in_session(entry.endpoint, session)) continue;
    found.push_back(writer_text(entry.endpoint));
  }
  std::ranges::sort(found);
  return found;
}

WriterSight FastDiscovery::see_writer(wire::Topic topic, std::uint64_t writer) const {
  if (writer == 0) return {};
  const std::lock_guard lock(mutex_);
  for (const auto& [guid, entry] : endpoints_) {
    if (entry.topic != topic || entry.side != Side::writer || number_of(guid) != writer) continue;
    return {false, process_of(entry.endpoint.user_data)};
  }
  return {true, {}};
}

std::string FastDiscovery::problem_of(const Entry& entry, const Endpoint& own) {
  const TopicTraits& topic = traits(entry.topic);
  EndpointQos qos;
  qos.durability = (entry.side == Side::writer ? receives_kept(own, topic) : kept_by_writer(topic) > 0) ? 1 : 0;
  return misfit(entry.endpoint, entry.side, topic, qos, own.session);
}

std::vector<std::string> FastDiscovery::misfits(const Endpoint& endpoint) const {
  std::vector<std::string> found;
  const std::lock_guard lock(mutex_);
  for (const auto& [guid, entry] : endpoints_) {
    if (!(entry.side == Side::writer ? endpoint.reads : endpoint.writes).contains(entry.topic)) continue;
    std::string problem = problem_of(entry, endpoint);
    if (!problem.empty()) found.push_back(std::move(problem));
  }
  std::ranges::sort(found);
  return found;
}

std::size_t FastDiscovery::fitting(const std::vector<rtps::GUID_t>& readers, const Endpoint& endpoint) const {
  const std::lock_guard lock(mutex_);
  return static_cast<std::size_t>(std::ranges::count_if(readers, [&](const rtps::GUID_t& reader) {
    const auto entry = endpoints_.find(reader);
    return entry != endpoints_.end() && problem_of(entry->second, endpoint).empty();
  }));
}

}  // namespace slew::transport
