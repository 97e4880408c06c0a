// SPDX-License-Identifier: Apache-2.0
// The interface between a node and the driver that polls it. The same node code runs in a process of its own, where the
// driver waits on the transport, and beside others on one thread, where the driver polls them in turn.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "core/status.h"
#include "node/session_member.h"
#include "node/step_timing.h"

namespace slew::node {

// Contents of the health message, in atomics: a separate thread sends it, so that a node that computes or waits for
// long still reports, as long as its loop turns (LoopWatch in health_report.h).
struct HealthState {
  std::atomic<std::uint64_t> turns{0};      // turns of the loop and messages taken: signs of life
  std::atomic<bool> waits_for_disk{false};  // the loop may stand still for as long as a disk takes
  std::atomic<std::uint8_t> state{0};
  std::atomic<bool> is_waiting{false};
  std::atomic<std::uint8_t> waiting_for{0};
  std::atomic<std::int64_t> waiting_step{0};
  std::atomic<std::int64_t> step{kJoinStep};
  std::atomic<std::uint64_t> steps_done{0};
  std::atomic<std::uint64_t> resends_asked{0};
  std::atomic<std::uint64_t> resends_answered{0};
  std::atomic<std::uint64_t> refused{0};
  std::atomic<std::int64_t> step_time_sum_ns{0};
  std::atomic<std::int64_t> step_time_max_ns{0};  // since the last health message
  std::atomic<std::int64_t> slip_ns{0};
  std::atomic<bool> has_session{false};
  std::atomic<std::uint32_t> epoch{0};

  // To be called by the loop's thread only. Real-time safe.
  void turn() noexcept { turns.store(turns.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed); }
};

// The loop may wait for a disk while an object of this class exists.
class DiskWait {
 public:
  explicit DiskWait(HealthState& health) noexcept
      : health_(health), was_waiting_(health.waits_for_disk.exchange(true, std::memory_order_relaxed)) {}
  ~DiskWait() { health_.waits_for_disk.store(was_waiting_, std::memory_order_relaxed); }
  DiskWait(const DiskWait&) = delete;
  DiskWait& operator=(const DiskWait&) = delete;

 private:
  HealthState& health_;
  bool was_waiting_;
};

class Node {
 public:
  virtual ~Node() = default;

  // Takes the messages that have arrived and does what they allow. True when anything was done.
  virtual bool poll(std::int64_t now_ns) = 0;

  // Monotonic time at which poll() has something to do even if nothing arrives.
  [[nodiscard]] virtual std::int64_t next_deadline(std::int64_t now_ns) const = 0;

  [[nodiscard]] virtual bool is_finished() const = 0;

  // Orderly end on a signal: io ends the session, other nodes leave it.
  virtual void request_stop(ExitCode code) = 0;

  [[nodiscard]] virtual SessionMember& member() = 0;
  [[nodiscard]] HealthState& health() noexcept { return health_; }
  [[nodiscard]] NodeTiming& timing() noexcept { return *timing_; }

 private:
  HealthState health_;
  const std::unique_ptr<NodeTiming> timing_ = std::make_unique<NodeTiming>();  // too large for a stack
};

}  // namespace slew::node
