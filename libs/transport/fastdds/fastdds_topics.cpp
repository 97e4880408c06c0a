// SPDX-License-Identifier: Apache-2.0
#include "transport/fastdds/fastdds_topics.h"

#include <fastdds/rtps/attributes/HistoryAttributes.h>
#include <fastdds/rtps/attributes/ReaderAttributes.h>
#include <fastdds/rtps/attributes/WriterAttributes.h>
#include <fastdds/rtps/participant/RTPSParticipant.h>
#include <fastrtps/attributes/TopicAttributes.h>

#include <chrono>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "transport/discovered_endpoint.h"

namespace slew::transport {
namespace {

using eprosima::fastrtps::Duration_t;

constexpr std::int32_t kChanges = 64;  // entries of a reader's history from the first message on; it grows

[[nodiscard]] Duration_t duration(SimDuration value) {
  return {static_cast<std::int32_t>(value.ns / 1'000'000'000), static_cast<std::uint32_t>(value.ns % 1'000'000'000)};
}

// The memory of messages is ours; this concerns the entries of a history alone.
[[nodiscard]] rtps::HistoryAttributes history_of(std::int32_t entries) {
  return {rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE, 0, entries, 0};
}

[[nodiscard]] eprosima::fastrtps::TopicAttributes attributes_of(const TopicTraits& topic) {
  eprosima::fastrtps::TopicAttributes attributes(topic.name, topic.type_name);
  // Cyclone drops endpoints with the type information of Fast DDS
  attributes.auto_fill_type_object = false;
  attributes.auto_fill_type_information = false;
  return attributes;
}

template <typename Qos>
void set_qos(Qos& qos, const Endpoint& endpoint, bool is_kept) {
  qos.m_reliability.kind = eprosima::fastrtps::RELIABLE_RELIABILITY_QOS;
  qos.m_reliability.max_blocking_time = duration(kMaxBlocking);
  qos.m_durability.kind =
      is_kept ? eprosima::fastrtps::TRANSIENT_LOCAL_DURABILITY_QOS : eprosima::fastrtps::VOLATILE_DURABILITY_QOS;
  qos.m_partition.push_back(partition_of(endpoint.session).c_str());
}

void set_delivery(rtps::EndpointAttributes& attributes, const TopicTraits& topic, const Endpoint& endpoint,
                  bool is_kept) {
  attributes.topicKind = rtps::NO_KEY;
  attributes.reliabilityKind = rtps::RELIABLE;
  attributes.durabilityKind = is_kept ? rtps::TRANSIENT_LOCAL : rtps::VOLATILE;
  // what the permissions of keys are about
  attributes.properties.properties().emplace_back("topic_name", topic.name);
  attributes.properties.properties().emplace_back("partitions", partition_of(endpoint.session));
}

}  // namespace

std::uint64_t number_of(const rtps::GUID_t& guid) noexcept {
  unsigned char bytes[16];
  static_assert(sizeof guid.guidPrefix.value + sizeof guid.entityId.value == sizeof bytes);
  std::memcpy(bytes, guid.guidPrefix.value, sizeof guid.guidPrefix.value);
  std::memcpy(bytes + sizeof guid.guidPrefix.value, guid.entityId.value, sizeof guid.entityId.value);
  return writer_number(bytes);
}

bool PayloadPool::get_payload(std::uint32_t size, rtps::CacheChange_t& change) {
  change.serializedPayload.data = static_cast<rtps::octet*>(samples_->take(size));
  change.serializedPayload.max_size = size;
  change.payload_owner(this);
  return true;
}

bool PayloadPool::get_payload(rtps::SerializedPayload_t& data, rtps::IPayloadPool*&, rtps::CacheChange_t& change) {
  return get_payload(data.length, change) && change.serializedPayload.copy(&data, true);
}

bool PayloadPool::release_payload(rtps::CacheChange_t& change) {
  if (void* memory = take_out(change); memory != nullptr) SamplePool::give_back(memory);
  change.payload_owner(nullptr);
  return true;
}

void* PayloadPool::take_out(rtps::CacheChange_t& change) noexcept {
  change.serializedPayload.length = 0;
  change.serializedPayload.max_size = 0;
  change.serializedPayload.pos = 0;
  return std::exchange(change.serializedPayload.data, nullptr);
}

TopicWriter::TopicWriter(rtps::RTPSParticipant& participant, const TopicTraits& topic, const Endpoint& endpoint,
                         const RepairTimes& times)
    : history_(history_of(topic.depth)),
      depth_(static_cast<std::size_t>(topic.depth)),
      kept_(static_cast<std::size_t>(kept_by_writer(topic))),
      own_(participant.getGuid().guidPrefix) {
  rtps::WriterAttributes attributes;
  set_delivery(attributes.endpoint, topic, endpoint, kept_ > 0);
  attributes.mode = rtps::SYNCHRONOUS_WRITER;
  attributes.times.initialHeartbeatDelay = duration(times.acknowledgement);
  attributes.times.heartbeatPeriod = duration(times.heartbeat);
  attributes.times.nackResponseDelay = duration({0});
  attributes.times.nackSupressionDuration = duration({0});
  writer_ = rtps::RTPSDomain::createRTPSWriter(&participant, attributes,
                                               std::make_shared<PayloadPool>(depth_ + kInFlight), &history_, this);
  eprosima::fastrtps::WriterQos qos;
  set_qos(qos, endpoint, kept_ > 0);
  const std::string user_data = own_user_data(endpoint.role);
  qos.m_userData.assign(user_data.begin(), user_data.end());
  if (writer_ == nullptr || !participant.registerWriter(writer_, attributes_of(topic), qos)) {
    if (writer_ != nullptr) rtps::RTPSDomain::removeRTPSWriter(writer_);
    throw std::runtime_error(std::string("writer of ") + topic.name);
  }
}

void TopicWriter::onWriterMatched(rtps::RTPSWriter*, rtps::MatchingInfo& info) {
  if (info.remoteEndpointGuid.guidPrefix == own_) return;
  const std::lock_guard lock(mutex_);
  std::erase(matched_, info.remoteEndpointGuid);
  if (info.status == rtps::MATCHED_MATCHING) matched_.push_back(info.remoteEndpointGuid);
}

std::vector<rtps::GUID_t> TopicWriter::matched_readers() const {
  const std::lock_guard lock(mutex_);
  return matched_;
}

// Drops the oldest message of a full history, and those that every reader has and no late one receives.
void TopicWriter::make_room() {
  const auto size = [this] { return static_cast<std::size_t>(history_.changesEnd() - history_.changesBegin()); };
  while (size() >= depth_) history_.remove_min_change();
  while (size() > 0 && size() >= kept_ && writer_->is_acked_by_all(*history_.changesBegin())) {
    history_.remove_min_change();
  }
}

bool TopicWriter::write(std::span<const std::byte> bytes) {
  const std::lock_guard lock(*history_.getMutex());
  make_room();
  const auto size = static_cast<std::uint32_t>(bytes.size());
  rtps::CacheChange_t* change = writer_->new_change([size] { return size; }, rtps::ALIVE);
  if (change == nullptr) return false;
  std::memcpy(change->serializedPayload.data, bytes.data(), size);
  change->serializedPayload.length = size;
  rtps::WriteParams parameters;
  if (history_.add_change_(change, parameters,
                           std::chrono::steady_clock::now() + std::chrono::nanoseconds(kMaxBlocking.ns))) {
    return true;
  }
  writer_->release_change(change);
  return false;
}

void TopicWriter::wait_for_acknowledgements(SimDuration longest) {
  writer_->wait_for_all_acked(duration(longest));
}

TopicReader::TopicReader(rtps::RTPSParticipant& participant, const TopicTraits& topic, const Endpoint& endpoint,
                         const RepairTimes& times, Doorbell& bell, std::uint32_t bit)
    : history_(history_of(kChanges)),
      own_(participant.getGuid().guidPrefix),
      bell_(bell),
      bit_(bit),
      ring_(static_cast<std::size_t>(depth_of_reader(topic))) {
  const bool is_kept = receives_kept(endpoint, topic);
  rtps::ReaderAttributes attributes;
  set_delivery(attributes.endpoint, topic, endpoint, is_kept);
  attributes.times.heartbeatResponseDelay = duration({0});
  attributes.times.initialAcknackDelay = duration(times.acknowledgement);
  rtps::RTPSReader* reader = rtps::RTPSDomain::createRTPSReader(
      &participant, attributes, std::make_shared<PayloadPool>(kInFlight), &history_, this);
  eprosima::fastrtps::ReaderQos qos;
  set_qos(qos, endpoint, is_kept);
  if (reader == nullptr || !participant.registerReader(reader, attributes_of(topic), qos)) {
    if (reader != nullptr) rtps::RTPSDomain::removeRTPSReader(reader);
    throw std::runtime_error(std::string("reader of ") + topic.name);
  }
}

TopicReader::~TopicReader() {
  ReceivedSample sample;
  while (take(sample)) SamplePool::give_back(sample.bytes);
}

// on a thread of Fast DDS, in the order of the writer
void TopicReader::onNewCacheChangeAdded(rtps::RTPSReader* reader, const rtps::CacheChange_t* change) {
  auto* const own_change = const_cast<rtps::CacheChange_t*>(change);
  if (change->kind == rtps::ALIVE && change->writerGUID.guidPrefix != own_) {
    ReceivedSample sample{nullptr, change->serializedPayload.length, change->sourceTimestamp.to_ns(),
                          number_of(change->writerGUID)};
    sample.bytes = static_cast<std::byte*>(PayloadPool::take_out(*own_change));
    std::byte* dropped = nullptr;
    {
      const std::lock_guard lock(mutex_);
      if (count_ == ring_.size()) {
        dropped = ring_[first_].bytes;
        first_ = (first_ + 1) % ring_.size();
        --count_;
      }
      ring_[(first_ + count_) % ring_.size()] = sample;
      ++count_;
    }
    if (dropped != nullptr) SamplePool::give_back(dropped);
    bell_.ring(bit_);
  }
  reader->getHistory()->remove_change(own_change);
}

bool TopicReader::take(ReceivedSample& sample) {
  const std::lock_guard lock(mutex_);
  if (count_ == 0) return false;
  sample = ring_[first_];
  first_ = (first_ + 1) % ring_.size();
  --count_;
  return true;
}

}  // namespace slew::transport
