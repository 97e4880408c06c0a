// SPDX-License-Identifier: Apache-2.0
// The transport of one process: endpoints of one bus hand each other copies of the encoded bytes or, on topics that a
// reader takes as objects, the messages themselves (message_object.h), which then are encoded for the other readers
// only.
//
// Messages of all writers reach every endpoint in the order in which they were published; an endpoint does not receive
// its own. A late endpoint first gets the kept messages of the transient-local topics, as with DDS. Endpoints may be
// polled one after the other on one thread (take() until false, never wait_until) or run a thread each.
//
// An inbox holds kInboxLimit messages; above it the oldest is dropped and counted. No allocation once the inboxes have
// grown to what the session needs; a message above kSlotBytes may allocate.
// publish() does not block beyond the bus's mutex.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "transport/topics.h"
#include "transport/transport.h"

namespace slew::transport {

class InProcessBus;

struct InProcessOptions {
  std::string role;  // how discovered_writers() names this endpoint, "mechanics"
  TopicSet writes;   // publish() of another topic is refused
  TopicSet reads;
  TopicSet objects{};  // of those read: taken as objects where the writer publishes one; on the writers' thread only
};

// One node's place at a bus; the bus must outlive it.
class InProcessEndpoint final : public Transport {
 public:
  InProcessEndpoint(InProcessBus& bus, InProcessOptions options);
  ~InProcessEndpoint() override;
  InProcessEndpoint(const InProcessEndpoint&) = delete;
  InProcessEndpoint& operator=(const InProcessEndpoint&) = delete;

  Status publish(wire::Topic topic, std::span<const std::byte> bytes) noexcept override;
  Status publish_object(const MessageObject& object, std::vector<std::byte>& buffer) noexcept override;
  [[nodiscard]] bool needs_bytes(wire::Topic topic) const noexcept override;
  [[nodiscard]] bool is_network() const noexcept override { return false; }
  bool take(Received& message) override;
  [[nodiscard]] WriterSight see_writer(wire::Topic topic, std::uint64_t writer) override;
  void wait_until(std::int64_t monotonic_deadline_ns) override;
  [[nodiscard]] std::vector<std::string> discovered_writers(wire::Topic topic) override;
  [[nodiscard]] std::vector<std::string> misfits() override { return {}; }  // there are none on a bus
  [[nodiscard]] std::size_t matched_readers(wire::Topic topic) const override;

  // Messages lost because they were not taken in time.
  [[nodiscard]] std::uint64_t dropped() const;

 private:
  friend class InProcessBus;
  struct Message {
    wire::Topic topic = wire::Topic::session;
    std::int64_t source_ns = 0;
    std::vector<std::byte> bytes;
    std::uint64_t writer = 0;
    std::shared_ptr<const void> object{};  // in place of the bytes
    const wire::Header* header = nullptr;
  };

  [[nodiscard]] Status check_written(wire::Topic topic) const;
  [[nodiscard]] bool is_read_as_bytes(wire::Topic topic) const noexcept;
  void receive(wire::Topic topic, std::span<const std::byte> bytes, std::int64_t source_ns, std::uint64_t writer);
  void receive(const MessageObject& object, std::int64_t source_ns);
  [[nodiscard]] Message& add_message(wire::Topic topic, std::int64_t source_ns);
  void grow();
  void keep(wire::Topic topic, std::span<const std::byte> bytes, std::int64_t source_ns);

  InProcessBus& bus_;
  const InProcessOptions options_;
  std::uint64_t number_ = 0;    // number of this endpoint at its bus, from 1 on
  std::vector<Message> inbox_;  // ring
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  std::uint64_t dropped_ = 0;
  std::condition_variable has_message_;
  bool is_waiting_ = false;  // in wait_until()
  Message taken_;
  std::vector<Message> kept_;  // own messages for late endpoints, oldest first
};

class InProcessBus {
 public:
  static constexpr std::size_t kInboxLimit = 16384;    // messages
  static constexpr std::size_t kSlotBytes = 9 * 1024;  // above the largest step message

 private:
  friend class InProcessEndpoint;

  mutable std::mutex mutex_;  // guards all endpoints' inboxes and kept messages
  std::vector<InProcessEndpoint*> endpoints_;
  std::uint64_t last_number_ = 0;  // number of the last endpoint that was made
};

}  // namespace slew::transport
