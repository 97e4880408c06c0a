// SPDX-License-Identifier: Apache-2.0
// Timing of a node: duration of each step, waits by partner, overruns (docs/realtime.md).
//
//   Tick n sent by io            released        t = 0 of the step's response
//   Tick n received              release jitter  delay of the tick
//   partners' samples n there    wait            from the node's own sample before, until the step can begin; by
//   partner Subsystem::step done         execution sample n+1 published         response        an overrun when longer
//   than H
//
// Release is the time at which io sent the tick, from its time stamp when io is on the same machine, else the time of
// its arrival. All times are of the monotonic clock of the host, whatever clock drives the node. Steps of the start-up
// grace are not measured. Without a deadline (`free` pace) there are no overruns.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>

#include "core/hdr_histogram.h"
#include "core/time.h"
#include "transport/wire.h"

namespace slew::node {

// Accounts of the steps of a paced session, io_node/session_clock.h.
struct SessionBooks {
  StepIndex run = 0;      // number of the next tick
  std::uint64_t due = 0;  // 0: the session has no accounts
  std::uint64_t skipped = 0;
  std::int64_t lag_ns = 0, rest_ns = 0;
};

// The books as of one moment, for another thread.
class BooksCell {
 public:
  // Real-time safe: keeps the older ones while another thread reads them.
  void write(const SessionBooks& books) noexcept {
    if (!mutex_.try_lock()) return;
    books_ = books;
    mutex_.unlock();
  }
  [[nodiscard]] SessionBooks read() const {
    const std::lock_guard lock(mutex_);
    return books_;
  }

 private:
  mutable std::mutex mutex_;
  SessionBooks books_;
};

// All measurements, for the thread that publishes them while the loop goes on. One thread writes.
struct NodeTiming {
  HdrHistogram release_jitter, execution, cpu_time, wait, response;
  HdrHistogram input_latency;  // io: from a controller's value to the samples that first used it
  std::array<std::atomic<std::int64_t>, wire::kRoles> waited_ns{};  // by role; for io itself: for controllers
  std::atomic<std::int64_t> response_recent_ns{0};                  // largest since it was last read
  std::atomic<std::uint64_t> overruns{0};
  std::atomic<std::uint64_t> longest_overrun{0};  // steps in a row
  std::atomic<std::uint64_t> overrun_run{0};      // steps in a row up to now
  // newest step, for display
  std::atomic<std::int64_t> last_response_ns{0}, last_release_jitter_ns{0};
  // heap calls in the loop from the first step on; -1: not counted
  std::atomic<std::int64_t> allocations{-1}, carrier_allocations{-1};
  std::atomic<std::uint64_t> transitions{0};  // io: transitions of the overrun policy
  BooksCell books;                            // io

  // Adds a step's response, which is late if it exceeds the deadline.
  void add_response(std::int64_t ns, bool is_late) noexcept;
  // Adds skipped steps in a row, the first of which was due this long ago, as overruns.
  void add_given_up(std::int64_t first_due_for_ns, SimDuration step, StepIndex steps) noexcept;

 private:
  void note_recent(std::int64_t response_ns) noexcept;
  void add_overruns(StepIndex steps) noexcept;
};

[[nodiscard]] wire::Quantiles quantiles_of(const HdrHistogram& histogram) noexcept;

// CPU time of the calling thread so far.
[[nodiscard]] std::int64_t thread_cpu_ns() noexcept;

// Time at which a message that has just been received was sent, on the monotonic clock, whose present time is now_ns:
// from its stamp when its writer has the same clock, else now. An impossible stamp (the clock was set) is replaced by
// now.
enum class WriterClock : std::uint8_t { same, other };
[[nodiscard]] std::int64_t sent_ns(std::int64_t source_wall_ns, std::int64_t now_ns, WriterClock clock) noexcept;

// Measures the steps of one node; its functions are called in the order of a step. Real-time safe.
class StepTiming {
 public:
  explicit StepTiming(NodeTiming& timing) : timing_(timing) {}

  // Deadline of a step's response; 0: none.
  void set_deadline(SimDuration deadline) noexcept { deadline_ns_ = deadline.ns; }
  // Earlier steps are not measured.
  void judge_from(StepIndex first) noexcept { first_ = first; }
  // The message that releases this step has arrived: times at which it was sent and received.
  void release(StepIndex step, std::int64_t released_ns, std::int64_t in_hand_ns) noexcept;
  // The step waits for a partner although it is released.
  void waits_for(wire::Role partner) noexcept { partner_ = partner; }
  // A sample that the next step needs has arrived.
  void came(wire::Role partner, std::int64_t now_ns) noexcept { came_ = {partner, now_ns}; }
  void begin(StepIndex step) noexcept;
  // Returns the time since begin() [ns].
  std::int64_t computed() noexcept;
  // The step's response so far exceeds the deadline.
  [[nodiscard]] bool is_late() const noexcept;
  void published() noexcept;
  // A new epoch begins: drops the releases of the former one.
  void restart() noexcept;

 private:
  static constexpr std::size_t kDepth = 128;  // steps that may be released ahead
  // Without a deadline the CPU time is the mean of so many steps: the thread's clock is a call of the kernel.
  static constexpr int kCpuSteps = 64;
  struct Release {
    StepIndex step = kJoinStep - 1;
    std::int64_t released_ns = 0, in_hand_ns = 0;
  };

  NodeTiming& timing_;
  std::array<Release, kDepth> releases_{};
  std::int64_t deadline_ns_ = 0;
  StepIndex first_ = 0;
  // the present step
  StepIndex step_ = kJoinStep;
  Release release_;
  wire::Role partner_ = wire::Role::io;
  struct Came {
    wire::Role partner = wire::Role::io;
    std::int64_t ns = 0;
  } came_;
  std::int64_t begin_ns_ = 0, computed_ns_ = 0;
  // the step before
  std::int64_t published_ns_ = 0, released_ns_ = 0;
  std::int64_t cpu_ns_ = 0;  // CPU time when it was read last
  int cpu_steps_ = 0;        // steps published since

  [[nodiscard]] std::int64_t held_back_ns() const noexcept;
  void measure_cpu_time() noexcept;
};

}  // namespace slew::node
