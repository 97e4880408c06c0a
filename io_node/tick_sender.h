// SPDX-License-Identifier: Apache-2.0
// The tick that is sent next, and the ticks sent before, for nodes that request them.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "node/sent_cache.h"
#include "node/session_member.h"
#include "transport/message_object.h"

namespace slew::io_node {

class TickSender {
 public:
  // channels: number of control values. depth: ticks that are kept, at least.
  TickSender(node::SessionMember& member, std::size_t channels, std::size_t depth) : member_(member), sent_(depth) {
    tick_.controls.resize(channels);
    tick_.age.resize(channels);
    if (transport::encode(tick_, buffer_)) sent_.reserve(buffer_.size());
  }

  [[nodiscard]] wire::Tick& tick() noexcept { return tick_; }
  // Sends tick() and keeps it as that of this step.
  void send(StepIndex step) {
    const std::shared_ptr<wire::Tick>& tick = out_.take();
    *tick = tick_;
    member_.publish_object<wire::Tick>(tick, buffer_);
    // a tick that every reader took as an object is not lost
    if (!buffer_.empty()) sent_.keep(step, buffer_);
  }
  // An epoch begins: no earlier tick can be requested, and tick() is empty.
  void restart() {
    sent_.clear();
    tick_ = wire::Tick{};
  }
  // Sends the kept ticks of these steps again. Number of ticks.
  std::uint64_t resend(StepIndex first, StepIndex last) {
    std::uint64_t ticks = 0;
    for (StepIndex step = first; step <= last; ++step) {
      const std::span<const std::byte> sent = sent_.find(step);
      if (sent.empty()) continue;
      member_.send(wire::Topic::tick, sent);
      ++ticks;
    }
    return ticks;
  }

 private:
  node::SessionMember& member_;
  wire::Tick tick_;
  transport::MessagePool<wire::Tick> out_{1};
  std::vector<std::byte> buffer_;
  node::SentCache sent_;
};

}  // namespace slew::io_node
