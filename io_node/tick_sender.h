// The tick that is sent next, and the ones sent before, for nodes that request them.
#pragma once

#include <cstddef>
#include <vector>

#include "node/sent_cache.h"
#include "node/session_member.h"

namespace slew::io_node {

class TickSender {
 public:
  // channels: number of control values. depth: ticks that are kept, at least.
  TickSender(node::SessionMember& member, std::size_t channels, std::size_t depth);

  [[nodiscard]] wire::Tick& tick() noexcept { return tick_; }
  // Sends tick() and keeps it as that of this step.
  void send(StepIndex step);
  // An epoch begins: no earlier tick can be requested, and tick() is empty.
  void restart();
  // Sends the kept ticks of these steps again. Number of ticks.
  std::uint64_t resend(StepIndex first, StepIndex last);

 private:
  node::SessionMember& member_;
  wire::Tick tick_;
  std::vector<std::byte> buffer_;
  node::SentCache sent_;
};

}  // namespace slew::io_node
