// What the machine itself can do: a bare loop that sleeps until its time with clock_nanosleep and burns as much CPU
// time as a step of the session, by the same rules of lag, catching up and missing as io_node
// (io_node/session_clock.h).
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include "core/time.h"
#include "io_node/session_clock.h"
#include "node/step_timing.h"

namespace slew::cli {

struct YardstickRules {
  SimDuration step;
  SimDuration work;  // CPU time of a step
  int priority = 0;  // SCHED_FIFO; 0: normal scheduling
  int cpu = -1;      // processor; -1: any
  io::OverrunRules overrun;
};

// One loop, in slices; the results of all of them together.
class Yardstick {
 public:
  Yardstick() = default;
  ~Yardstick() { wait(); }
  Yardstick(const Yardstick&) = delete;
  Yardstick& operator=(const Yardstick&) = delete;

  // Runs a slice on a thread of its own.
  void start(const YardstickRules& rules, SimDuration slice);
  [[nodiscard]] bool is_running() const noexcept { return is_running_.load(); }
  void wait();
  // Ends the present slice.
  void stop() noexcept { is_stopped_ = true; }

  // As io_node's health would tell them. Only while no slice runs.
  [[nodiscard]] wire::Health result() const;
  // Of the first slice whose books do not balance; empty: all do.
  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }

 private:
  void run(const YardstickRules& rules, SimDuration slice);

  std::unique_ptr<node::NodeTiming> timing_ = std::make_unique<node::NodeTiming>();
  std::thread thread_;
  std::atomic<bool> is_running_{false}, is_stopped_{false};
  std::uint64_t steps_ = 0, skipped_ = 0;
  std::int64_t slip_ns_ = 0;
  std::string problem_;
};

// Asks for the CPU time of this thread until so much of it has gone.
void burn(SimDuration cpu_time) noexcept;

}  // namespace slew::cli
