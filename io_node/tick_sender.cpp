#include "io_node/tick_sender.h"

#include "core/check.h"

namespace slew::io_node {

TickSender::TickSender(node::SessionMember& member, std::size_t channels, std::size_t depth)
    : member_(member), sent_(depth) {
  tick_.controls.resize(channels);
  tick_.age.resize(channels);
  if (transport::encode(tick_, buffer_)) sent_.reserve(buffer_.size());
}

void TickSender::send(StepIndex step) {
  const bool is_encoded = transport::encode(tick_, buffer_);
  SLEW_CHECK(is_encoded);
  sent_.keep(step, buffer_);
  member_.send(wire::Topic::tick, buffer_);
}

void TickSender::restart() {
  sent_.clear();
  tick_ = wire::Tick{};
}

std::uint64_t TickSender::resend(StepIndex first, StepIndex last) {
  std::uint64_t ticks = 0;
  for (StepIndex step = first; step <= last; ++step) {
    const std::span<const std::byte> sent = sent_.find(step);
    if (sent.empty()) continue;
    member_.send(wire::Topic::tick, sent);
    ++ticks;
  }
  return ticks;
}

}  // namespace slew::io_node
