// SPDX-License-Identifier: Apache-2.0
// One topic's writer and reader of a Fast DDS participant, for messages of bytes.
//
// They stand on the RTPS layer of Fast DDS, which the layer of DDS above it uses in the same way: there the histories
// and the memory of the samples are ours. A steady session then takes nothing from the heap for its samples, and a late
// reader receives each writer's last messages and no more (topics.h, `kept`); the layer of DDS would send it the whole
// history.
#pragma once

#include <fastdds/rtps/RTPSDomain.h>
#include <fastdds/rtps/history/IPayloadPool.h>
#include <fastdds/rtps/history/ReaderHistory.h>
#include <fastdds/rtps/history/WriterHistory.h>
#include <fastdds/rtps/reader/RTPSReader.h>
#include <fastdds/rtps/reader/ReaderListener.h>
#include <fastdds/rtps/writer/RTPSWriter.h>
#include <fastdds/rtps/writer/WriterListener.h>

#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "core/status.h"
#include "transport/delivery.h"
#include "transport/doorbell.h"
#include "transport/sample_pool.h"

namespace slew::transport {

namespace rtps = eprosima::fastrtps::rtps;

// What depends on the network: on loopback only a reader without room loses messages (loopback timers).
struct RepairTimes {
  SimDuration heartbeat;        // of a writer with unacknowledged messages
  SimDuration acknowledgement;  // of a reader, after a heartbeat
};

// Memory of the messages of one topic.
class PayloadPool final : public rtps::IPayloadPool {
 public:
  explicit PayloadPool(std::size_t room) : samples_(SamplePool::create(room)) {}
  ~PayloadPool() override { samples_->close(); }

  bool get_payload(std::uint32_t size, rtps::CacheChange_t& change) override;
  bool get_payload(rtps::SerializedPayload_t& data, rtps::IPayloadPool*& owner, rtps::CacheChange_t& change) override;
  bool release_payload(rtps::CacheChange_t& change) override;
  // Takes the memory out of a change; the caller gives it back to the SamplePool.
  [[nodiscard]] static void* take_out(rtps::CacheChange_t& change) noexcept;

 private:
  SamplePool* samples_;
};

class TopicWriter final : rtps::WriterListener {
 public:
  // Throws std::runtime_error when Fast DDS refuses the writer.
  TopicWriter(rtps::RTPSParticipant& participant, const TopicTraits& topic, const Endpoint& endpoint,
              const RepairTimes& times);

  // Keeps the message for slow and late readers and sends it on this thread. Thread-safe.
  [[nodiscard]] bool write(std::span<const std::byte> bytes);
  // Readers of other participants. Fast DDS compares fewer policies than its partners may: discovery decides which of
  // them receive messages.
  [[nodiscard]] std::vector<rtps::GUID_t> matched_readers() const;
  // Returns when all readers have acknowledged every message, or after that time.
  void wait_for_acknowledgements(SimDuration longest);

 private:
  class History : public rtps::WriterHistory {
   public:
    using rtps::WriterHistory::add_change_;
    using rtps::WriterHistory::WriterHistory;
  };
  void onWriterMatched(rtps::RTPSWriter*, rtps::MatchingInfo& info) override;
  using rtps::WriterListener::onWriterMatched;
  void make_room();

  History history_;
  std::size_t depth_, kept_;
  rtps::GuidPrefix_t own_;
  mutable std::mutex mutex_;
  std::vector<rtps::GUID_t> matched_;
  rtps::RTPSWriter* writer_;  // of the participant, which deletes it
};

struct ReceivedSample {
  std::byte* bytes = nullptr;  // of a SamplePool
  std::size_t size = 0;
  std::int64_t source_ns = 0;
  std::uint64_t writer = 0;
};

// Received messages wait here until they are taken; the oldest are dropped beyond the depth.
class TopicReader final : rtps::ReaderListener {
 public:
  // Rings the bell with that bit for each message. Throws std::runtime_error when Fast DDS refuses the reader.
  TopicReader(rtps::RTPSParticipant& participant, const TopicTraits& topic, const Endpoint& endpoint,
              const RepairTimes& times, Doorbell& bell, std::uint32_t bit);
  ~TopicReader() override;

  // The oldest message; false when there is none. The caller gives its memory back.
  [[nodiscard]] bool take(ReceivedSample& sample);

 private:
  void onNewCacheChangeAdded(rtps::RTPSReader* reader, const rtps::CacheChange_t* change) override;

  rtps::ReaderHistory history_;
  rtps::GuidPrefix_t own_;
  Doorbell& bell_;
  std::uint32_t bit_;
  std::mutex mutex_;
  std::vector<ReceivedSample> ring_;  // depth of the topic
  std::size_t first_ = 0, count_ = 0;
};

[[nodiscard]] std::uint64_t number_of(const rtps::GUID_t& guid) noexcept;

}  // namespace slew::transport
