// SPDX-License-Identifier: Apache-2.0
#include "gateway/wire_channels.h"

#include "node/identity.h"
#include "transport/idl_text.h"
#include "transport/roles.h"
#include "transport/topics.h"

namespace slew::gateway {
namespace {

// A writer publishes a message of these once; of the others the next one follows.
std::size_t kept_of(wire::Topic topic) noexcept {
  switch (topic) {
    case wire::Topic::session:
      return 1;
    case wire::Topic::node_status:
      return 2 * wire::kRoles;
    case wire::Topic::variable_directory:
      return KeptWireMessages::kMostOfTopic;
    default:
      return 0;
  }
}

}  // namespace

std::vector<WireChannelDef> observed_topics() {
  std::vector<WireChannelDef> defs;
  for (std::size_t i = 0; i < wire::kTopics; ++i) {
    const auto topic = static_cast<wire::Topic>(i);
    if (!transport::traits(wire::Role::observer).reads.contains(topic)) continue;
    defs.push_back({topic, transport::traits(topic).type_name, std::string(transport::idl_text())});
  }
  return defs;
}

ChannelInfo channel_info(const WireChannelDef& def, std::uint32_t id) {
  return {id, "/wire/" + std::string(node::to_text(def.topic)), def.type_name, def.idl, ChannelEncoding::cdr};
}

bool KeptWireMessages::keeps(wire::Topic topic) noexcept {
  return kept_of(topic) > 0;
}

void KeptWireMessages::take(wire::Topic topic, const WireMessage& message) {
  const std::size_t most = kept_of(topic);
  if (most == 0) return;
  std::deque<WireMessage>& kept = messages_[static_cast<std::size_t>(topic)];
  kept.push_back(message);
  while (kept.size() > most) kept.pop_front();
}

void WireQueue::push(Frame message) {
  if (bytes_ + message.size() > kMostBytes) {
    ++left_out_;
    return;
  }
  bytes_ += message.size();
  frames_.push_back(std::move(message));
}

std::optional<Frame> WireQueue::next() {
  if (frames_.empty()) return std::nullopt;
  Frame frame = std::move(frames_.front());
  frames_.pop_front();
  bytes_ -= frame.size();
  return frame;
}

}  // namespace slew::gateway
