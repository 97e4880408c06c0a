// Progress of the message that a node waits for. Health, status and samples of other topics from its writer are no
// progress: a writer that is heard otherwise may still never deliver the one that the next step needs.
//
// Time counts only while this process looks: between two looks further apart than kStoodStill the waiter itself stood.
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
  static constexpr int kMostNamed = 20;  // on standard error, of one session

  // To be called in every poll. awaited: none: nothing is missing, or the wait has a reason that is told already.
  // asked: requests to resend that this node has sent so far.
  void look(const std::optional<Awaited>& awaited, std::uint64_t asked, std::int64_t now_ns) noexcept;

  // Time for which the same message has been missing.
  [[nodiscard]] SimDuration waited() const noexcept { return {waited_ns_}; }
  // It is to be named: missing for kSilentAfter, while its writer is heard.
  [[nodiscard]] bool is_stalled(const SessionMember& member, std::int64_t now_ns) const noexcept;
  // The same, once for each message.
  [[nodiscard]] bool begins(const SessionMember& member, std::int64_t now_ns) noexcept;
  // It has been named and is still missing.
  [[nodiscard]] bool is_named() const noexcept { return is_named_; }
  // Whether what is named is still to be written to standard error.
  [[nodiscard]] bool may_warn() const noexcept { return named_ <= kMostNamed; }
  [[nodiscard]] const Awaited& awaited() const noexcept { return *awaited_; }  // while something is
  // "waits for actuators of step 7320 from hydraulics (process 12 on crane2), which is heard otherwise; asked 40 times"
  [[nodiscard]] std::string text(const SessionMember& member, std::uint64_t asked) const;

 private:
  std::optional<Awaited> awaited_;
  std::int64_t looked_ns_ = 0;
  std::int64_t waited_ns_ = 0;
  std::uint64_t asked_before_ = 0;
  bool is_named_ = false;
  int named_ = 0;
};

}  // namespace slew::node
