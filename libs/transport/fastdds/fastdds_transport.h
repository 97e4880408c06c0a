// SPDX-License-Identifier: Apache-2.0
// The transport over Fast DDS: one participant with one writer or reader per topic, QoS as in topics.h.
//
// Every endpoint is in the partition slewring/<session>. A thread of Fast DDS receives a message and rings a doorbell;
// the loop thread sleeps on that. publish() copies the bytes, sends them on the calling thread and blocks at most
// kMaxBlocking. The destructor waits at most kFarewell until the last messages have arrived.
#pragma once

#include <array>
#include <memory>

#include "transport/fastdds/fastdds_participant.h"
#include "transport/transport.h"

namespace slew::transport {

class FastTransport final : public Transport {
 public:
  explicit FastTransport(Endpoint endpoint) : endpoint_(std::move(endpoint)) {}
  // Creates the participant and its endpoints, or reports what is wrong.
  [[nodiscard]] Status open(const Network& network);
  ~FastTransport() override;

  Status publish(wire::Topic topic, std::span<const std::byte> bytes) noexcept override;
  bool take(Received& message) override;
  [[nodiscard]] WriterSight see_writer(wire::Topic topic, std::uint64_t writer) override;
  void wait_until(std::int64_t monotonic_deadline_ns) override;
  [[nodiscard]] std::vector<std::string> discovered_writers(wire::Topic topic) override;
  // Types are compared by name: Fast DDS 2.9 publishes and reads no layouts.
  [[nodiscard]] std::vector<std::string> misfits() override;
  [[nodiscard]] std::size_t matched_readers(wire::Topic topic) const override;

 private:
  const Endpoint endpoint_;
  Doorbell doorbell_;
  std::uint32_t pending_ = 0;   // topics to be read, a bit each
  std::byte* taken_ = nullptr;  // message whose bytes the caller reads
  FastDiscovery discovery_;
  std::array<std::unique_ptr<TopicWriter>, wire::kTopics> writers_;
  std::array<std::unique_ptr<TopicReader>, wire::kTopics> readers_;
  Participant participant_;  // last: it goes before its histories and listeners
};

}  // namespace slew::transport
