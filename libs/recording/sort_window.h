// SPDX-License-Identifier: Apache-2.0
// Sorts messages into the order of steps before they are written, for any order of arrival.
//
// Order: (epoch, step, channel, sequence), then the payload's bytes, then arrival; so the same messages leave in the
// same order in every run. The memory is fixed at construction: a ring of bytes for the payloads and an array for
// the entries; nothing allocates afterwards. Not thread-safe.
#pragma once

#include <cstdint>
#include <vector>

#include "core/time.h"
#include "recording/byte_order.h"

namespace slew::recording {

// Place of a message in logical time. Epochs count the resets of a session.
struct MessageStamp {
  std::uint32_t epoch = 0;
  StepIndex step = 0;
  std::uint32_t sequence = 0;        // counted by the publisher per channel
  std::int64_t publish_time_ns = 0;  // wall clock at the publisher since 1970; 0 = unknown
};

struct WindowEntry {
  MessageStamp stamp;
  std::uint16_t channel = 0;
  std::uint32_t size = 0;     // size of the payload
  std::uint64_t arrival = 0;  // running number
  std::size_t block = 0;      // place of the payload's block in the ring
};

class SortWindow {
 public:
  // steps: span of held steps; bytes, messages: capacity.
  SortWindow(StepIndex steps, std::size_t bytes, std::size_t messages);

  enum class PushResult {
    taken,
    full,      // pop the first entries and try again
    too_large  // exceeds the empty window
  };
  [[nodiscard]] PushResult push(const MessageStamp& stamp, std::uint16_t channel, ByteSpan payload) noexcept;

  [[nodiscard]] bool is_empty() const noexcept { return entries_.empty(); }
  // True if the first entry is older than the span of steps behind the newest one.
  [[nodiscard]] bool is_first_due() const noexcept;
  // True if the first entry belongs to this epoch and step, or to an earlier one.
  [[nodiscard]] bool is_first_up_to(std::uint32_t epoch, StepIndex step) const noexcept;

  [[nodiscard]] const WindowEntry& first() const noexcept { return entries_.front(); }
  [[nodiscard]] ByteSpan payload_of(const WindowEntry& entry) const noexcept;
  void pop_first() noexcept;

  [[nodiscard]] std::uint32_t newest_epoch() const noexcept { return newest_epoch_; }
  [[nodiscard]] StepIndex newest_step() const noexcept { return newest_step_; }

 private:
  // head of a block in the ring; the payload follows
  struct BlockHead {
    std::uint32_t size = 0;  // size of the block with this head, a multiple of 8
    std::uint32_t is_live = 0;
  };

  [[nodiscard]] bool allocate(std::size_t size, std::size_t& block) noexcept;
  void release(std::size_t block) noexcept;
  [[nodiscard]] BlockHead head_at(std::size_t block) const noexcept;
  void set_head(std::size_t block, BlockHead head) noexcept;
  [[nodiscard]] bool is_later(const WindowEntry& a, const WindowEntry& b) const noexcept;

  StepIndex steps_;
  std::vector<WindowEntry> entries_;  // binary heap, the earliest in front
  std::size_t capacity_;
  Bytes ring_;
  std::size_t tail_ = 0;  // oldest block
  std::size_t end_ = 0;   // place of the next block
  std::size_t used_ = 0;
  std::uint64_t arrivals_ = 0;
  std::uint32_t newest_epoch_ = 0;
  StepIndex newest_step_ = kJoinStep;
};

}  // namespace slew::recording
