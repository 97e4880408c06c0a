// How a node keeps its time: what each step took, whom it waited for, how many came too late (docs/realtime.md).
//
//   Tick n sent by io            released        t = 0 of the step's response
//   Tick n in hand               release jitter  how late the node gets to know
//   partners' samples n there    wait            from the node's own sample before, until it can begin; and for whom
//   Subsystem::step done         execution
//   sample n+1 handed over       response        late (an overrun) when longer than H
//
// Release is the moment at which io sent the tick, told by its time stamp when io is on the same machine, else that of
// its arrival. All times are of the monotonic clock of the host, whatever clock drives the node.
// Steps of the start-up grace are measured by nobody. Without a deadline (`free` pace) nothing overruns.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>

#include "core/hdr_histogram.h"
#include "core/time.h"
#include "transport/wire.h"

namespace slew::node {

// What became of the steps of a paced session, io_node/session_clock.h.
struct SessionBooks {
  StepIndex run = 0;      // the next tick's number
  std::uint64_t due = 0;  // 0: no books are kept
  std::uint64_t skipped = 0;
  std::int64_t lag_ns = 0, rest_ns = 0;
};

// The books as of one moment, for another thread.
class BooksCell {
 public:
  // Real-time safe: while they are being read the older ones stay.
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

// Everything that is measured, for the thread that tells it while the loop goes on. One thread writes.
struct NodeTiming {
  HdrHistogram release_jitter, execution, cpu_time, wait, response;
  HdrHistogram input_latency;  // io: from a controller's value to the samples that first used it
  std::array<std::atomic<std::int64_t>, 4> waited_ns{};  // for io (of io: for controllers), mechanics, hydraulics, flex
  std::atomic<std::int64_t> response_recent_ns{0};       // largest since it was last taken
  std::atomic<std::uint64_t> overruns{0};
  std::atomic<std::uint64_t> longest_overrun{0};  // steps in a row
  std::atomic<std::uint64_t> overrun_run{0};      // steps in a row up to now
  // newest step, for who shows them
  std::atomic<std::int64_t> last_response_ns{0}, last_release_jitter_ns{0};
  // heap calls in the loop from the first step on; -1: nobody counts them
  std::atomic<std::int64_t> allocations{-1}, carrier_allocations{-1};
  std::atomic<std::uint64_t> transitions{0};  // of the overrun policy, by io
  BooksCell books;                            // by io

  // A step's response, against the deadline where there is one.
  void add_response(std::int64_t ns, bool is_late) noexcept;
  // Steps in a row that nobody does, of which the first was due so long ago: as many that overran.
  void add_given_up(std::int64_t first_due_for_ns, SimDuration step, StepIndex steps) noexcept;

 private:
  void note_recent(std::int64_t response_ns) noexcept;
  void add_overruns(StepIndex steps) noexcept;
};

[[nodiscard]] wire::Quantiles quantiles_of(const HdrHistogram& histogram) noexcept;

// CPU time of the calling thread so far.
[[nodiscard]] std::int64_t thread_cpu_ns() noexcept;

// When a message was sent, on the monotonic clock: by its stamp when its writer has the same clock, else its arrival.
// A stamp that cannot be true (the clock was set) counts as the arrival.
enum class WriterClock : std::uint8_t { same, other };
[[nodiscard]] std::int64_t sent_ns(std::int64_t source_wall_ns, WriterClock clock) noexcept;

// Follows the steps of one node, in the order in which a step goes. Real-time safe.
class StepTiming {
 public:
  explicit StepTiming(NodeTiming& timing) : timing_(timing) {}

  // Of a step's response; 0: none.
  void set_deadline(SimDuration deadline) noexcept { deadline_ns_ = deadline.ns; }
  // Earlier steps are not measured.
  void judge_from(StepIndex first) noexcept { first_ = first; }
  // What releases this step is in hand.
  void release(StepIndex step, std::int64_t released_ns) noexcept;
  // The step waits for a partner although it is released.
  void waits_for(wire::Role partner) noexcept { partner_ = partner; }
  // The sample has come without which the next step cannot be done.
  void came(wire::Role partner, std::int64_t now_ns) noexcept { came_ = {partner, now_ns}; }
  void begin(StepIndex step) noexcept;
  void computed() noexcept;
  // The step's response so far is beyond the deadline.
  [[nodiscard]] bool is_late() const noexcept;
  void published() noexcept;
  // A new epoch: nothing of the former is waited for any more.
  void restart() noexcept;

 private:
  static constexpr std::size_t kDepth = 128;  // steps that may be released ahead
  struct Release {
    StepIndex step = kJoinStep - 1;
    std::int64_t released_ns = 0, in_hand_ns = 0;
  };

  NodeTiming& timing_;
  std::array<Release, kDepth> releases_{};
  std::int64_t deadline_ns_ = 0;
  StepIndex first_ = 0;
  // of the step in work
  StepIndex step_ = kJoinStep;
  Release release_;
  wire::Role partner_ = wire::Role::io;
  struct Came {
    wire::Role partner = wire::Role::io;
    std::int64_t ns = 0;
  } came_;
  std::int64_t begin_ns_ = 0, computed_ns_ = 0;
  // of the one before
  std::int64_t published_ns_ = 0, cpu_ns_ = 0, released_ns_ = 0;

  [[nodiscard]] std::int64_t held_back_ns() const noexcept;
};

}  // namespace slew::node
