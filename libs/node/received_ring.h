// SPDX-License-Identifier: Apache-2.0
// Received messages by step, held until a later step has been done. A message that came as an object is held as it is,
// another one is decoded.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>

#include "core/time.h"
#include "node/step_ring.h"
#include "transport/message_object.h"

namespace slew::node {

template <typename Message>
class ReceivedRing {
 public:
  // depth: steps that can be held at a time. No allocation after construction.
  explicit ReceivedRing(std::size_t depth) : ring_(depth), decoded_(depth + 1) {}

  // Holds the message as that of a step. False: it cannot be decoded.
  [[nodiscard]] bool put(const transport::Received& received, StepIndex step) {
    if (auto object = transport::object_in<Message>(received)) {
      ring_.put(step) = std::move(object);
      return true;
    }
    const std::shared_ptr<Message>& message = decoded_.take();
    if (!transport::decode(received.bytes, *message)) return false;
    ring_.put(step) = message;
    return true;
  }
  [[nodiscard]] const Message* find(StepIndex step) const noexcept {
    const auto* held = ring_.find(step);
    return held != nullptr ? held->get() : nullptr;
  }
  // Gives back the messages of earlier steps. Pre-condition: the steps held are within `depth` of the last call's.
  void drop_before(StepIndex step) noexcept {
    const StepIndex end = std::min(step, oldest_ + static_cast<StepIndex>(ring_.depth()));
    for (StepIndex old = oldest_; old < end; ++old) {
      auto* held = ring_.find(old);
      if (held == nullptr) continue;
      held->reset();
      ring_.remove(old);
    }
    oldest_ = std::max(oldest_, step);
  }
  void clear() noexcept {
    ring_.for_each([](auto& held) { held.reset(); });
    ring_.clear();
    oldest_ = kJoinStep;
  }

 private:
  StepRing<std::shared_ptr<const Message>> ring_;
  transport::MessagePool<Message> decoded_;
  StepIndex oldest_ = kJoinStep;  // no earlier message is held
};

}  // namespace slew::node
