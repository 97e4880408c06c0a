// SPDX-License-Identifier: Apache-2.0
#include "node/stall_watch.h"

#include "node/identity.h"

namespace slew::node {

void StallWatch::look(const std::optional<Awaited>& awaited, std::uint64_t requests, std::int64_t now_ns) noexcept {
  const std::int64_t since_ns = now_ns - looked_ns_;
  looked_ns_ = now_ns;
  if (!awaited || awaited != awaited_) {
    awaited_ = awaited;
    waited_ns_ = 0;
    requests_before_ = requests;
    is_named_ = false;
    return;
  }
  if (since_ns < kStoodStill.ns) waited_ns_ += since_ns;
}

bool StallWatch::is_stalled(const SessionMember& member, std::int64_t now_ns) const noexcept {
  if (!awaited_ || waited_ns_ < kSilentAfter.ns) return false;
  // a silent writer is named as silent, and given up as such
  return now_ns - member.peer(awaited_->role).last_received_ns < kSilentAfter.ns;
}

bool StallWatch::begins(const SessionMember& member, std::int64_t now_ns) noexcept {
  if (is_named_ || !is_stalled(member, now_ns)) return false;
  is_named_ = true;
  ++named_;
  return true;
}

std::string StallWatch::text(const SessionMember& member, std::uint64_t requests) const {
  return "waits for " + std::string(to_text(awaited_->topic)) + " of step " + std::to_string(awaited_->step) +
         " from " + member.describe_peer(awaited_->role) + ", whose other messages arrive; requested " +
         std::to_string(requests - requests_before_) + " times";
}

}  // namespace slew::node
