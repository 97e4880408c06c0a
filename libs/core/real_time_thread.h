// What `--rt` asks of the operating system for the calling thread.
#pragma once

#include "core/status.h"

namespace slew {

// SCHED_FIFO with the given priority (1..99) and locked memory for the whole process.
// Error resources: the remedy for the missing permission; what could be set stays set.
Status make_real_time(int priority);

}  // namespace slew
