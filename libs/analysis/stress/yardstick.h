// SPDX-License-Identifier: Apache-2.0
// The limit of the machine itself: bare loops that sleep with clock_nanosleep until the time of a step and burn as much
// CPU time as the processes of the session do in it, one loop for each, all released at once. A step has ended when the
// loops have done the nodes' computing. The other work of the session's processes (the middleware, io, the recorder) is
// burned after its end, though in the session some of it comes before. Nothing is sent. Lag, catching up and missing
// follow io_node's rules (io_node/session_clock.h). The first steps of a slice, in which threads and caches are cold,
// are its grace, as in the session.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "core/time.h"
#include "io_node/session_clock.h"
#include "node/step_timing.h"
#include "scene/defs.h"

namespace slew::analysis {

struct YardstickLoop {
  wire::Role role = wire::Role::io;  // role of the process that it stands for
  SimDuration work;                  // CPU time of a step
  SimDuration computing;             // the part of it before the step's end
  int priority = 0;                  // SCHED_FIFO; 0: normal scheduling
  int cpu = -1;                      // processor; -1: any
  bool ends_step = true;             // false: a load, for which the step does not wait
};

inline constexpr SimDuration kYardstickGrace = milliseconds(100);  // at the start of a slice

struct YardstickRules {
  scene::SessionDef session;         // step, overrun policy and grace
  std::vector<YardstickLoop> loops;  // the first leads: it keeps the time
  [[nodiscard]] SimDuration step() const noexcept { return session.step_duration(); }
};

// The loops, in slices; the results of all slices together.
class Yardstick {
 public:
  Yardstick() = default;
  ~Yardstick() { wait(); }
  Yardstick(const Yardstick&) = delete;
  Yardstick& operator=(const Yardstick&) = delete;

  // Runs a slice on threads of its own: the rules' grace, and then steps of so much time that are judged.
  void start(const YardstickRules& rules, SimDuration slice);
  [[nodiscard]] bool is_running() const noexcept { return is_running_.load(); }
  void wait();
  // Ends the present slice.
  void stop() noexcept { is_stopped_ = true; }

  // The results in the form of io_node's health. Only while no slice runs.
  [[nodiscard]] wire::Health result() const;
  // Problem of the first slice whose books do not balance; empty: all do.
  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }

 private:
  void lead(const YardstickRules& rules, SimDuration slice);
  void follow(const YardstickLoop& loop) noexcept;
  void release(std::int32_t round, std::int64_t due_ns) noexcept;

  std::unique_ptr<node::NodeTiming> timing_ = std::make_unique<node::NodeTiming>();
  std::thread thread_;
  std::atomic<bool> is_running_{false}, is_stopped_{false};
  // followers in their places; the step that the leader has released; number of loops that have done it
  std::atomic<std::int32_t> placed_{0}, round_{0}, done_{0};
  std::atomic<std::int64_t> due_ns_{0};
  std::uint64_t steps_ = 0, skipped_ = 0;
  std::int64_t slip_ns_ = 0;
  std::string problem_;
};

// Polls the CPU time of this thread until it has grown by this much.
void burn(SimDuration cpu_time) noexcept;

}  // namespace slew::analysis
