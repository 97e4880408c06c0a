// SPDX-License-Identifier: Apache-2.0
// The transport over Cyclone DDS: one participant with one writer or reader per topic, QoS as in topics.h.
//
// Every endpoint is in the partition slewring/<session>. The participant does not receive its own messages. Cyclone's
// thread receives a message and rings a doorbell; the loop thread sleeps on that, without a thread of ours between.
// publish() copies the bytes, sends them on the calling thread and blocks at most kMaxBlocking. The destructor waits at
// most kFarewell until the last messages have arrived.
//
// Only the headers cyclone_*.h depend on Cyclone; none of the public ones includes its headers.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "transport/cyclone/cyclone_domain.h"
#include "transport/delivery.h"
#include "transport/doorbell.h"
#include "transport/topics.h"
#include "transport/transport.h"

struct ddsi_serdata;
struct ddsi_sertype;

namespace slew::transport {

// The receiving thread's arguments to ring for a topic.
struct TopicBell {
  Doorbell* doorbell = nullptr;
  std::uint32_t bit = 0;
};

class CycloneTransport final : public Transport {
 public:
  // Fills `transport`, or reports what is wrong. The first form makes a domain of its own.
  [[nodiscard]] static Status open(const Network& network, const Endpoint& options,
                                   std::unique_ptr<CycloneTransport>& transport);
  [[nodiscard]] static Status open(std::shared_ptr<CycloneDomain> domain, const Endpoint& options,
                                   std::unique_ptr<CycloneTransport>& transport);

  ~CycloneTransport() override;
  CycloneTransport(const CycloneTransport&) = delete;
  CycloneTransport& operator=(const CycloneTransport&) = delete;

  Status publish(wire::Topic topic, std::span<const std::byte> bytes) noexcept override;
  bool take(Received& message) override;
  [[nodiscard]] WriterSight see_writer(wire::Topic topic, std::uint64_t writer) override;
  void wait_until(std::int64_t monotonic_deadline_ns) override;
  // "mechanics on host crane2, pid 812, type slewring::Tick"; writers of all vendors, in this session's partition
  [[nodiscard]] std::vector<std::string> discovered_writers(wire::Topic topic) override;
  // Endpoints of all vendors: types by name, and by layout where it is published; QoS by reliability, durability,
  // representation, ownership, deadline, latency budget, liveliness, destination order and presentation.
  [[nodiscard]] std::vector<std::string> misfits() override;
  [[nodiscard]] std::size_t matched_readers(wire::Topic topic) const override;

 private:
  static constexpr std::size_t kBatch = 16;  // messages taken from a reader at once

  CycloneTransport(std::shared_ptr<CycloneDomain> domain, Endpoint options);
  [[nodiscard]] Status create();
  [[nodiscard]] Status create_endpoints(wire::Topic topic, std::int32_t publisher, std::int32_t subscriber);
  [[nodiscard]] bool refill();
  void look_at_the_clock() noexcept;
  [[nodiscard]] std::uint64_t writer_of(wire::Topic topic, std::uint64_t handle);

  std::shared_ptr<CycloneDomain> domain_;
  const Endpoint options_;
  std::int32_t participant_ = 0;
  std::array<std::int32_t, wire::kTopics> writers_{};
  std::array<std::int32_t, wire::kTopics> readers_{};
  std::array<const ddsi_sertype*, wire::kTopics> types_{};
  Doorbell doorbell_;
  std::array<TopicBell, wire::kTopics> bells_{};
  std::uint32_t pending_ = 0;  // topics to be read, a bit each
  std::int64_t next_look_ns_ = 0;
  std::int64_t wall_ahead_ns_ = INT64_MIN;  // lead of the wall clock over the monotonic one [ns]

  std::array<ddsi_serdata*, kBatch> batch_{};
  std::array<std::int64_t, kBatch> batch_source_ns_{};
  std::array<std::uint64_t, kBatch> batch_writer_{};
  // Cyclone's handle of a writer, which changes when the writer is lost and found again, and its number here
  struct KnownWriter {
    std::uint64_t handle = 0;
    std::uint64_t writer = 0;
  };
  std::array<KnownWriter, 32> known_writers_{};
  std::size_t next_known_ = 0;  // place of the next entry
  std::size_t batch_count_ = 0;
  std::size_t batch_next_ = 0;
  wire::Topic batch_topic_ = wire::Topic::session;
  ddsi_serdata* taken_ = nullptr;  // sample whose bytes the caller reads
};

}  // namespace slew::transport
