// SPDX-License-Identifier: Apache-2.0
#include "gateway/outbox.h"

#include <utility>

namespace slew::gateway {

bool Outbox::push(Frame event) {
  if (is_full_ || bytes_ + event.size() > most_bytes_) {
    is_full_ = true;
    return false;
  }
  bytes_ += event.size();
  events_.push_back(std::move(event));
  return true;
}

void Outbox::mark(std::size_t state) {
  if (waits_.size() <= state) waits_.resize(state + 1, false);
  if (waits_[state]) {
    ++left_out_;
    return;
  }
  waits_[state] = true;
  ++waiting_;
}

void Outbox::unmark(std::size_t state) noexcept {
  if (state >= waits_.size() || !waits_[state]) return;
  waits_[state] = false;
  --waiting_;
}

void Outbox::forget_states() noexcept {
  waits_.clear();
  waiting_ = turn_ = 0;
}

std::uint64_t Outbox::take_left_out() noexcept {
  return std::exchange(left_out_, 0);
}

Outbox::Next Outbox::next() {
  if (!events_.empty()) {
    Frame event = std::move(events_.front());
    events_.pop_front();
    bytes_ -= event.size();
    return event;
  }
  if (waiting_ == 0) return {};
  while (true) {
    if (turn_ >= waits_.size()) turn_ = 0;
    const std::size_t state = turn_++;
    if (!waits_[state]) continue;
    waits_[state] = false;
    --waiting_;
    return state;
  }
}

}  // namespace slew::gateway
