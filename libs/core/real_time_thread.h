// What `--rt` asks of the operating system, and on which processor a program runs.
#pragma once

#include <string>
#include <vector>

#include "core/status.h"

namespace slew {

// SCHED_FIFO with the given priority (1..99) for the calling thread and those it starts, and memory that is there
// already when it is needed: all of the process locked, what is freed kept, 32 MiB of heap and 256 KiB of this thread's
// stack touched.
// Error resources: the remedy for the missing permission; what could be set stays set.
Status make_real_time(int priority);

// Processors that this process may run on, ascending.
[[nodiscard]] std::vector<int> usable_cpus();

// The calling thread and those it starts run on this processor alone. Error bad_input: there is no such one here; the
// text names those there are.
Status run_on_cpu(int cpu);

// "0, 1, 2"
[[nodiscard]] std::string cpu_list(const std::vector<int>& cpus);

}  // namespace slew
