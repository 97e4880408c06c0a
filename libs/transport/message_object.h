// SPDX-License-Identifier: Apache-2.0
// Messages as objects, for readers in the process of their writer: no encoding, no copy.
//
// A writer fills a message of its pool and publishes it (Transport::publish_object). Readers keep it as long as they
// need it; the pool then gives it out again. All of them run on one thread.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "core/check.h"
#include "transport/cdr/codec.h"
#include "transport/transport.h"

namespace slew::transport {

// The message as an object to publish. Pre-condition: its texts and lists are within their caps.
template <Message M>
[[nodiscard]] MessageObject object_of(std::shared_ptr<const M> message) {
  const wire::Header* header = &message->header;
  return {kTopicOf<M>, std::move(message), header, [](const void* object, ByteBuffer& buffer) {
            const bool is_encoded = encode(*static_cast<const M*>(object), buffer);
            SLEW_CHECK(is_encoded);
          }};
}

// The received message if it came as an object of this type; else null.
template <Message M>
[[nodiscard]] std::shared_ptr<const M> object_in(const Received& received) {
  if (received.topic != kTopicOf<M>) return nullptr;
  return std::static_pointer_cast<const M>(received.object);
}

// The header of a message on a topic whose messages start with one. False: the bytes cannot be decoded.
[[nodiscard]] inline bool header_of(const Received& received, wire::Header& header) {
  if (received.header == nullptr) return decode_header(received.bytes, header);
  header = *received.header;
  return true;
}

// Messages of one writer or reader that are filled again when no one holds them.
template <typename M>
class MessagePool {
 public:
  // reserved: messages to make at once. Beyond them take() allocates.
  explicit MessagePool(std::size_t reserved = 0) {
    messages_.reserve(reserved);
    while (messages_.size() < reserved) messages_.push_back(std::make_shared<M>());
  }

  // A message that no one holds, with old content. The first ones are used most, so that they stay in the caches.
  [[nodiscard]] const std::shared_ptr<M>& take() {
    for (std::size_t i = 0; i < std::min(kFirst, messages_.size()); ++i) {
      if (messages_[i].use_count() == 1) return messages_[i];
    }
    // where many are held, they are given back in the order in which they were taken
    for (std::size_t tried = kFirst; tried < messages_.size(); ++tried) {
      next_ = next_ + 1 < messages_.size() ? next_ + 1 : kFirst;
      if (messages_[next_].use_count() == 1) return messages_[next_];
    }
    return messages_.emplace_back(std::make_shared<M>());
  }

 private:
  static constexpr std::size_t kFirst = 8;
  std::vector<std::shared_ptr<M>> messages_;
  std::size_t next_ = kFirst;
};

}  // namespace slew::transport
