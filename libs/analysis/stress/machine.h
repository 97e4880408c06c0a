// SPDX-License-Identifier: Apache-2.0
// Activity of the machine during a measurement.
#pragma once

#include <cstdint>
#include <string>

namespace slew::analysis {

struct Machine {
  std::string kernel;      // "Linux 6.1.0 #1 SMP PREEMPT_DYNAMIC"
  std::string preemption;  // preemption_model()
  std::string processor;   // its name
  int cpus = 0;            // usable by this process
};
[[nodiscard]] Machine this_machine();

// Processor time since the start of the machine, in ticks of the kernel, from /proc/stat; 0 where there is none.
struct CpuTicks {
  std::uint64_t all = 0;
  std::uint64_t idle = 0;
  std::uint64_t stolen = 0;  // taken by the host of a virtual machine
};
[[nodiscard]] CpuTicks cpu_ticks();

// Load of the machine during a measurement.
struct MachineActivity {
  double runnable = 0;  // threads of the machine that ran or were ready to, mean of 10 looks a second
  double steal = 0;     // share of the processors' time that the host took: 0 to 1
  double busy = 0;      // share of the time in which they were not idle: 0 to 1
};

// Measures it over any number of spans of time.
class ActivityWatch {
 public:
  void begin();
  // Begins a span if none is under way. Called more often than 10 times a second. The calling thread is not counted.
  void look(std::int64_t now_ns);
  void end();
  [[nodiscard]] MachineActivity result() const noexcept;

 private:
  bool is_under_way_ = false;
  CpuTicks begin_, sum_;
  std::int64_t looked_ns_ = 0, runnable_ = 0, looks_ = 0;
};

}  // namespace slew::analysis
