// The health message of a node, made from what its loop keeps in atomics.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/time.h"
#include "node/node.h"

namespace slew::node {

// A loop that has not come round for so long while it should stands still: a deadlock, an endless computation, a thread
// that a debugger holds. Nothing that it does from READY on takes as long, but a step of a large model and a disk.
inline constexpr SimDuration kLoopStands = milliseconds(1000);
inline constexpr int kStepsOfALoop = 20;  // it stands after so many of the steps that it has done, where that is longer

// Looks after the loop of a node from another thread: whether it has given a sign of life (a turn, a message taken, a
// step done). It counts looks and no clock: who looks stands still with a whole process that does.
//
// Not covered: what comes before READY and behind a reset until READY, which has its own deadline (JOIN), the time
// after the end, and a recorder that waits for its disk, for as long as it does.
class LoopWatch {
 public:
  explicit LoopWatch(const HealthState& loop) : loop_(loop) {}
  // To be called every kHealthInterval. True when the loop stands still.
  [[nodiscard]] bool look() noexcept;
  // Since its last sign of life, in looks.
  [[nodiscard]] SimDuration stood_for() const noexcept { return {looks_ * kHealthInterval.ns}; }

 private:
  [[nodiscard]] bool is_busy() const noexcept;
  [[nodiscard]] std::int64_t longest_ns() const noexcept;

  const HealthState& loop_;
  std::uint64_t signs_ = 0;
  std::int64_t looks_ = 0;
};

// To be sent every kHealthInterval, by one thread, which need not be the node's: silence means death to the others.
class HealthReport {
 public:
  explicit HealthReport(Node& node) : node_(node) {}
  // Publishes; does nothing before the node has a session. The mean step time is that since the last report.
  void send();

 private:
  void add_timing(wire::Health& message) const;

  Node& node_;
  std::uint64_t last_steps_ = 0;
  std::int64_t last_sum_ns_ = 0;
  std::vector<std::byte> buffer_;
};

}  // namespace slew::node
