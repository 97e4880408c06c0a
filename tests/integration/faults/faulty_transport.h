// SPDX-License-Identifier: Apache-2.0
// Faults between the nodes of one process, drawn from a seed: faults of a transport and of a scheduler. Times are those
// of a clock that is a number.
//
// Ticks, samples, resends and health are lost, doubled, late and overtaken; in a partition they are lost. The rest
// (session, status, variables, leases, requests, to the recorder bodies' shapes too) is late only and keeps its order,
// in a partition until its end: a reliable transport repeats it for as long as it takes, and the nodes rely on that
// (idl/README.md).
#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "transport/transport.h"

namespace slew::testing {

inline constexpr std::int64_t kMs = 1'000'000;  // ns

struct VirtualClock {
  std::int64_t now_ns = 1'000'000 * kMs;
};

// Chances of a message, and the longest delay of one that is late.
struct MessageFaults {
  double loss = 0, duplicate = 0, late = 0;
  std::int64_t longest_delay_ns = 0;
};

// Nothing gets from one role to another, in this direction.
struct Partition {
  wire::Role from = wire::Role::io, to = wire::Role::io;
  std::int64_t begin_ns = 0, end_ns = 0;
};

// The role's process does not run.
struct Stall {
  wire::Role role = wire::Role::io;
  std::int64_t begin_ns = 0, end_ns = 0;
};

// The role's process dies, once the session ticks, and another one comes when io has given it up.
struct Kill {
  wire::Role role = wire::Role::io;
  std::int64_t at_ns = 0;
};

// Messages that never arrive from a time on, or up to another one, as behind a filter or in a reader that was led
// astray: those of one topic, of one size or in one direction, whatever else arrives. Any topic, also one that a
// reliable transport would repeat.
struct Drop {
  std::optional<wire::Topic> topic;
  std::optional<wire::Role> from, to;
  std::size_t least_bytes = 0, most_bytes = static_cast<std::size_t>(-1);
  std::int64_t begin_ns = 0;
  std::int64_t end_ns = std::numeric_limits<std::int64_t>::max();
};

struct FaultPlan {
  std::uint64_t seed = 0;
  std::vector<Drop> drops;
  double mutation = 0;  // chance that a message, its header apart or not, has some bytes changed, is cut or comes twice
  MessageFaults messages;
  std::vector<Partition> partitions;
  std::vector<Stall> stalls;
  std::vector<Kill> kills;
  std::int64_t end_ns = 0;  // of all faults

  // roles: of the session. Faults begin at any time from the clock's on and last for 0.2 to 1.7 s, below the 2 s after
  // which a node is given up. kills: physics nodes die too, up to twice.
  enum class Kills : std::uint8_t { none, some };
  static FaultPlan drawn(std::uint64_t seed, const std::vector<wire::Role>& roles, std::int64_t begin_ns, Kills kills);

  [[nodiscard]] bool is_stalled(wire::Role role, std::int64_t now_ns) const noexcept;
  // One topic, one size or one direction is dropped for good, drawn from a seed; in every third one messages are
  // mutated too.
  static FaultPlan drawn_for_good(std::uint64_t seed, const std::vector<wire::Role>& roles, std::int64_t begin_ns,
                                  std::int64_t end_ns);
  [[nodiscard]] bool is_dropped(wire::Topic topic, wire::Role from, wire::Role to, std::size_t bytes,
                                std::int64_t now_ns) const noexcept;
  // End of the partition that is in the way now; 0: none is.
  [[nodiscard]] std::int64_t cut_until(wire::Role from, wire::Role to, std::int64_t now_ns) const noexcept;
  // All partitions that the role is part of, one after the other.
  [[nodiscard]] std::int64_t cut_off_ns(wire::Role role) const noexcept;
  [[nodiscard]] std::string text() const;
};

// Counts of the faults.
struct FaultCount {
  std::uint64_t lost = 0, doubled = 0, late = 0, dropped = 0, mutated = 0;
  std::uint64_t overtaken = 0;  // by one of its own writer and topic that was sent behind it
};

// The receiving side of a node's place at the bus. Sending is left as it is.
class FaultyTransport final : public transport::Transport {
 public:
  // All outlive the transport.
  FaultyTransport(transport::Transport& transport, wire::Role self, const VirtualClock& clock, const FaultPlan& plan,
                  FaultCount& count);

  Status publish(wire::Topic topic, std::span<const std::byte> bytes) noexcept override {
    return transport_.publish(topic, bytes);
  }
  bool take(transport::Received& message) override;
  void wait_until(std::int64_t) override {}
  [[nodiscard]] std::vector<std::string> discovered_writers(wire::Topic topic) override {
    return transport_.discovered_writers(topic);
  }
  [[nodiscard]] std::vector<std::string> misfits() override { return transport_.misfits(); }
  [[nodiscard]] std::size_t matched_readers(wire::Topic topic) const override {
    return transport_.matched_readers(topic);
  }

 private:
  struct Pending {
    wire::Topic topic = wire::Topic::session;
    std::int64_t source_ns = 0;
    std::vector<std::byte> bytes;
  };

  void fetch();
  void deliver(const transport::Received& message);
  void deliver_mutated(const transport::Received& message);
  [[nodiscard]] std::int64_t due_ns(std::int64_t delay_ns) const noexcept;
  void put(const transport::Received& message, std::int64_t due_ns);
  [[nodiscard]] bool happens(double chance);
  [[nodiscard]] std::int64_t delay();

  transport::Transport& transport_;
  wire::Role self_;
  const VirtualClock& clock_;
  const FaultPlan& plan_;
  FaultCount& count_;
  std::mt19937_64 random_;
  std::multimap<std::int64_t, Pending> pending_;                          // by the time at which they are there
  std::map<std::pair<wire::Role, wire::Topic>, std::int64_t> last_sent_;  // due, of a dialogue
  std::map<std::pair<wire::Role, wire::Topic>, std::int64_t> last_due_;   // time at which the last sent message is due
  Pending taken_;
};

}  // namespace slew::testing
