// SPDX-License-Identifier: Apache-2.0
// Reasons to hold the next tick although all samples are there: a pause, and lockstep controllers (input_gate.h).
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "core/time.h"

namespace slew::io_node {

// A pause withholds the ticks, except single steps on request.
class Pause {
 public:
  explicit Pause(bool is_paused) noexcept : is_paused_(is_paused) {}

  void begin() noexcept {
    is_paused_ = true;
    single_steps_ = 0;
  }
  void end() noexcept { is_paused_ = false; }
  void add_steps(StepIndex steps) noexcept { single_steps_ += steps; }
  void drop_steps() noexcept { single_steps_ = 0; }
  // A tick was sent. True: it was the last single step.
  bool count_tick() noexcept { return is_paused_ && --single_steps_ == 0; }

  [[nodiscard]] bool is_paused() const noexcept { return is_paused_; }
  [[nodiscard]] bool withholds_tick() const noexcept { return is_paused_ && single_steps_ == 0; }
  // Step at which the ticks stop, when n is the next; none: they do not.
  [[nodiscard]] std::optional<StepIndex> stops_at(StepIndex n) const noexcept {
    return is_paused_ ? std::optional(n + single_steps_) : std::nullopt;
  }

 private:
  bool is_paused_;
  StepIndex single_steps_ = 0;  // ticks still to send in the pause
};

// Lockstep controllers: the first step of an epoch waits until each of their channels has a holder, every tick for
// their values.
class ControllerWait {
 public:
  enum class Event : std::uint8_t { none, begins, ends, times_out };
  // Before the first step of an epoch. is_vacant: a lockstep channel has no holder.
  Event look_for_holders(bool is_vacant, std::int64_t now_ns, SimDuration longest) noexcept {
    if (!is_vacant) return std::exchange(holders_due_ns_, 0) == 0 ? Event::none : Event::ends;
    if (holders_due_ns_ == 0) {
      holders_due_ns_ = now_ns + longest.ns;
      return Event::begins;
    }
    if (now_ns <= holders_due_ns_) return Event::none;
    holders_due_ns_ = 0;
    return Event::times_out;
  }
  [[nodiscard]] bool is_for_holders() const noexcept { return holders_due_ns_ != 0; }

  // The tick lacks nothing but values of controllers. True: it is held, for the longest time at most.
  bool look_for_values(SimDuration longest, std::int64_t now_ns) noexcept {
    if (longest.ns == 0) return false;
    if (values_since_ns_ == 0) values_since_ns_ = now_ns;
    return now_ns - values_since_ns_ < longest.ns;
  }
  // Start of the wait for values; 0: no tick waits for them.
  [[nodiscard]] std::int64_t values_since_ns() const noexcept { return values_since_ns_; }
  // The wait for values ends; its length.
  std::int64_t end_values(std::int64_t now_ns) noexcept {
    const std::int64_t since_ns = std::exchange(values_since_ns_, 0);
    return since_ns == 0 ? 0 : now_ns - since_ns;
  }
  [[nodiscard]] bool is_waiting() const noexcept { return holders_due_ns_ != 0 || values_since_ns_ != 0; }
  void reset() noexcept { holders_due_ns_ = values_since_ns_ = 0; }

 private:
  std::int64_t holders_due_ns_ = 0;  // end of the wait for holders; 0: no step waits for them
  std::int64_t values_since_ns_ = 0;
};

}  // namespace slew::io_node
