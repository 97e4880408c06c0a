// SPDX-License-Identifier: Apache-2.0
// Real-time settings of `--rt`, and the processor that a program runs on.
#pragma once

#include <string>
#include <vector>

#include "core/status.h"

namespace slew {

// Sets SCHED_FIFO with the given priority (1..99) for the calling thread and the threads it starts. Provides memory in
// advance: locks the process, keeps freed memory, touches 32 MiB of heap and 256 KiB of this thread's stack.
// Error resources: with the remedy for the missing permission; settings that succeeded stay.
Status make_real_time(int priority);

// Processors that this process may run on, ascending.
[[nodiscard]] std::vector<int> usable_cpus();

// Binds the calling thread and the threads it starts to this processor. Error bad_input: the processor does not exist;
// the text lists the available ones.
Status run_on_cpu(int cpu);

// "0, 1, 2"
[[nodiscard]] std::string cpu_list(const std::vector<int>& cpus);

}  // namespace slew
