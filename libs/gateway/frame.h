// SPDX-License-Identifier: Apache-2.0
// One message for a WebSocket client.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>

namespace slew::gateway {

enum class FrameType : bool { binary, text };

// The bytes are head, then body. Clients share the body of a value that all of them receive.
struct Frame {
  FrameType type = FrameType::text;
  std::string head{};
  std::shared_ptr<const std::string> body{};  // null: none

  [[nodiscard]] std::size_t size() const noexcept { return head.size() + (body != nullptr ? body->size() : 0); }
};

[[nodiscard]] inline Frame text_frame(std::string text) {
  return {FrameType::text, std::move(text), nullptr};
}
[[nodiscard]] inline Frame binary_frame(std::string head, std::shared_ptr<const std::string> body = nullptr) {
  return {FrameType::binary, std::move(head), std::move(body)};
}

}  // namespace slew::gateway
