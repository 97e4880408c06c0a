// SPDX-License-Identifier: Apache-2.0
// One node's connection to the others: bytes out on a topic, bytes in with their topic.
//
// Two transports behind it: Cyclone DDS (cyclone_transport.h) and the bus of one process (in_process_bus.h). Both carry
// the same CDR bytes from one encoder (codec.h), so that a recording does not depend on the transport.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/status.h"
#include "transport/wire.h"

namespace slew::transport {

// A received message: its bytes, which stay valid until the next take() on the same transport, or the object that a
// writer of the same process published (message_object.h).
struct Received {
  wire::Topic topic = wire::Topic::session;
  std::span<const std::byte> bytes;  // encapsulation header (4 bytes) and CDR; empty when there is an object
  std::int64_t source_ns = 0;        // writer's wall clock at the write
  // Number of the writer of controller_input, the same after the writer was lost and discovered again. 0: not known.
  std::uint64_t writer = 0;
  std::shared_ptr<const void> object{};  // of the topic's message type; null: the message came as bytes
  const wire::Header* header = nullptr;  // of the object
};

// A message as an object to publish; object_of() in message_object.h makes it.
struct MessageObject {
  wire::Topic topic;
  std::shared_ptr<const void> message;  // of the topic's message type; does not change once published
  const wire::Header* header;           // of the message
  void (*encode)(const void* message, std::vector<std::byte>& buffer);
};

// State of a writer, as the transport sees it.
struct WriterSight {
  bool has_left = false;  // the transport no longer sees the writer
  std::string process{};  // "process 812 on crane2"; empty: not known
};

class Transport {
 public:
  virtual ~Transport() = default;

  // Sends; never blocks longer than the transport's own bound (stated in the implementation). Thread-safe.
  virtual Status publish(wire::Topic topic, std::span<const std::byte> bytes) noexcept = 0;

  // The same for a message that exists as an object: readers that take objects get it, the others its bytes. Encodes it
  // into the buffer when a reader needs the bytes, and else leaves the buffer empty. One thread only.
  virtual Status publish_object(const MessageObject& object, std::vector<std::byte>& buffer) noexcept {
    object.encode(object.message.get(), buffer);
    return publish(object.topic, buffer);
  }
  // Some reader may need the bytes of this topic's messages.
  [[nodiscard]] virtual bool needs_bytes(wire::Topic) const noexcept { return true; }
  // Messages may be lost, and a writer may have to wait for the network.
  [[nodiscard]] virtual bool is_network() const noexcept { return true; }

  // Next received message of any subscribed topic; false when there is none now. One thread only.
  virtual bool take(Received& message) = 0;

  // The process behind Received::writer. Thread of take().
  [[nodiscard]] virtual WriterSight see_writer(wire::Topic, std::uint64_t) { return {}; }

  // Blocks until a message may be there or the monotonic deadline passes.
  virtual void wait_until(std::int64_t monotonic_deadline_ns) = 0;

  // Writers of a topic as the transport sees them, e.g. "host:pid type slewring::Tick", for messages about a JOIN that
  // fails; empty when the transport has no such list.
  [[nodiscard]] virtual std::vector<std::string> discovered_writers(wire::Topic topic) = 0;

  // Number of readers in other processes that a message on this topic reaches now; a topic that keeps no messages loses
  // the earlier ones.
  [[nodiscard]] virtual std::size_t matched_readers(wire::Topic topic) const = 0;

  // Processes of this session that do not match this endpoint by type or QoS, a sentence each; without this report they
  // would only be silent. Thread-safe.
  [[nodiscard]] virtual std::vector<std::string> misfits() = 0;
};

}  // namespace slew::transport
