// SPDX-License-Identifier: Apache-2.0
// What one client has yet to receive: events in their order, and states of which only the newest counts.
//
// A state waits as a mark, not as bytes: its value is encoded when the client can take it, so that a client that reads
// slowly receives newer values less often and needs no memory. Events wait as bytes, up to a limit. An event is never
// dropped: a client whose events do not fit is to be closed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <variant>
#include <vector>

#include "gateway/frame.h"

namespace slew::gateway {

class Outbox {
 public:
  // most_bytes: of the events that wait.
  explicit Outbox(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  // False: the event does not fit, now and from now on.
  bool push(Frame event);
  [[nodiscard]] bool is_full() const noexcept { return is_full_; }
  [[nodiscard]] std::size_t waiting_bytes() const noexcept { return bytes_; }

  // State number `state` has a newer value. One whose value still waits is counted as left out.
  void mark(std::size_t state);
  // Its value is not wanted any more.
  void unmark(std::size_t state) noexcept;
  // No state waits; their numbers have another meaning from now on.
  void forget_states() noexcept;
  // Values that a newer one replaced before they were sent, since the last call.
  [[nodiscard]] std::uint64_t take_left_out() noexcept;

  // The next event, or else the number of the next state, each state in turn; nothing: nothing waits.
  using Next = std::variant<std::monostate, Frame, std::size_t>;
  [[nodiscard]] Next next();

 private:
  std::size_t most_bytes_;
  std::deque<Frame> events_;
  std::size_t bytes_ = 0;
  bool is_full_ = false;
  std::vector<bool> waits_;  // by state
  std::size_t waiting_ = 0;  // number of states that wait
  std::size_t turn_ = 0;     // state to look at first
  std::uint64_t left_out_ = 0;
};

}  // namespace slew::gateway
