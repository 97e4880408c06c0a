// SPDX-License-Identifier: Apache-2.0
// Watches for the message that a node waits for. Health, status and samples of other topics do not count as progress: a
// writer whose other messages arrive may never deliver the one that the next step needs.
//
// A time between two calls longer than kStoodStill is not counted: the waiting process itself stood still.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "node/session_member.h"

namespace slew::node {

// The first message that is missing.
struct Awaited {
  wire::Role role = wire::Role::io;
  wire::Topic topic = wire::Topic::tick;
  StepIndex step = 0;
  friend bool operator==(const Awaited&, const Awaited&) noexcept = default;
};

class StallWatch {
 public:
  static constexpr int kMostNamed = 20;  // warnings on standard error in one session

  // To be called in every poll. awaited: none: nothing is missing, or the reason of the wait is already reported.
  // requests: resend requests that this node has sent so far.
  void look(const std::optional<Awaited>& awaited, std::uint64_t requests, std::int64_t now_ns) noexcept;

  // Time for which the same message has been missing.
  [[nodiscard]] SimDuration waited() const noexcept { return {waited_ns_}; }
  // The message has been missing for kSilentAfter while other messages of its writer arrive.
  [[nodiscard]] bool is_stalled(const SessionMember& member, std::int64_t now_ns) const noexcept;
  // The same, true once for each message.
  [[nodiscard]] bool begins(const SessionMember& member, std::int64_t now_ns) noexcept;
  // The message has been named and is still missing.
  [[nodiscard]] bool is_named() const noexcept { return is_named_; }
  // The named message may be written to standard error.
  [[nodiscard]] bool may_warn() const noexcept { return named_ <= kMostNamed; }
  // Pre-condition: a message is missing.
  [[nodiscard]] const Awaited& awaited() const noexcept { return *awaited_; }
  // "waits for actuators of step 7320 from hydraulics (process 12 on crane2), whose other messages arrive; requested 40
  // times"
  [[nodiscard]] std::string text(const SessionMember& member, std::uint64_t requests) const;

 private:
  std::optional<Awaited> awaited_;
  std::int64_t looked_ns_ = 0;
  std::int64_t waited_ns_ = 0;
  std::uint64_t requests_before_ = 0;
  bool is_named_ = false;
  int named_ = 0;
};

}  // namespace slew::node
