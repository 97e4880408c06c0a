// SPDX-License-Identifier: Apache-2.0
// Messages of the wire for clients, byte by byte as they came: a channel /wire/<topic> for each topic, encoding cdr,
// with the interface definition as schema (omgidl).
//
// They come faster than clients can use, so that they have a queue of their own beside the outbox: a message that does
// not fit into it is left out for that client and counted. Those that writers publish once (session, names of
// variables, states of nodes) are kept for clients that come later.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gateway/frame.h"
#include "gateway/server_messages.h"
#include "transport/wire.h"

namespace slew::gateway {

struct WireChannelDef {
  wire::Topic topic = wire::Topic::session;
  std::string type_name;  // "slewring::Tick"
  std::string idl;        // text
};

// Topics that an observer receives, with this program's interface definition.
[[nodiscard]] std::vector<WireChannelDef> observed_topics();
[[nodiscard]] ChannelInfo channel_info(const WireChannelDef& def, std::uint32_t id);

struct WireMessage {
  std::uint64_t time_ns = 0;  // of the session
  std::shared_ptr<const std::string> body{};
};

// The last messages of topics that are published once.
class KeptWireMessages {
 public:
  static constexpr std::size_t kMostOfTopic = 1024;

  [[nodiscard]] static bool keeps(wire::Topic topic) noexcept;
  void take(wire::Topic topic, const WireMessage& message);
  [[nodiscard]] const std::deque<WireMessage>& of(wire::Topic topic) const noexcept {
    return messages_[static_cast<std::size_t>(topic)];
  }

 private:
  std::array<std::deque<WireMessage>, wire::kTopics> messages_;
};

// What waits for one client.
class WireQueue {
 public:
  static constexpr std::size_t kMostBytes = 4u << 20;

  void push(Frame message);
  [[nodiscard]] std::optional<Frame> next();
  // Messages that did not fit, since the last call.
  [[nodiscard]] std::uint64_t take_left_out() noexcept { return std::exchange(left_out_, 0); }

 private:
  std::deque<Frame> frames_;
  std::size_t bytes_ = 0;
  std::uint64_t left_out_ = 0;
};

}  // namespace slew::gateway
