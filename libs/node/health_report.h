// SPDX-License-Identifier: Apache-2.0
// The health message of a node, made from the atomics that its loop updates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/time.h"
#include "node/node.h"

namespace slew::node {

// A loop without a turn for this long stands still: a deadlock, an endless computation, a thread held by a debugger.
// From READY on only a step of a large model and a disk take as long.
inline constexpr SimDuration kLoopStalled = milliseconds(1000);
inline constexpr int kStepsOfALoop = 20;  // the limit is this many mean steps where that is longer

// Watches the loop of a node from another thread for signs of life: a turn, a message taken, a step done. Counts polls
// instead of time: if the whole process is suspended, the watcher is suspended too.
//
// Not covered: the time before READY, also after a reset (JOIN has its own deadline), the time after the end, and a
// recorder while it waits for its disk.
class LoopWatch {
 public:
  explicit LoopWatch(const HealthState& loop) : loop_(loop) {}
  // To be called every kHealthInterval. True when the loop stands still.
  [[nodiscard]] bool poll() noexcept;
  // Time since the last sign of life, in polls.
  [[nodiscard]] SimDuration stood_for() const noexcept { return {polls_ * kHealthInterval.ns}; }

 private:
  [[nodiscard]] bool is_busy() const noexcept;
  [[nodiscard]] std::int64_t longest_ns() const noexcept;

  const HealthState& loop_;
  std::uint64_t signs_ = 0;
  std::int64_t polls_ = 0;
};

// To be sent every kHealthInterval by one thread, which may differ from the node's: the other nodes give a silent node
// up.
class HealthReport {
 public:
  explicit HealthReport(Node& node) : node_(node) {}
  // Publishes; does nothing before the node has a session. The mean step time is taken since the last report.
  void send();

 private:
  void add_timing(wire::Health& message) const;

  Node& node_;
  std::uint64_t last_steps_ = 0;
  std::int64_t last_sum_ns_ = 0;
  std::vector<std::byte> buffer_;
};

}  // namespace slew::node
