// What the machine was doing while something was measured on it.
#pragma once

#include <cstdint>
#include <string>

namespace slew::cli {

struct Machine {
  std::string kernel;     // "Linux 6.1.0 #1 SMP PREEMPT_DYNAMIC"
  std::string processor;  // its name
  int cpus = 0;           // usable by this process
};
[[nodiscard]] Machine this_machine();

// Processor time since the start of the machine, in ticks of the kernel, from /proc/stat; 0 where there is none.
struct CpuTicks {
  std::uint64_t all = 0;
  std::uint64_t idle = 0;
  std::uint64_t stolen = 0;  // taken by the host of a virtual machine
};
[[nodiscard]] CpuTicks cpu_ticks();

// Share of the time between two looks that was stolen, or not idle: 0 to 1.
[[nodiscard]] double steal_between(const CpuTicks& a, const CpuTicks& b) noexcept;
[[nodiscard]] double busy_between(const CpuTicks& a, const CpuTicks& b) noexcept;

// Load average of the last minute; 0 where there is none.
[[nodiscard]] double load_average();

}  // namespace slew::cli
