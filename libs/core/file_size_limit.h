// What a process does that has come to the limit on the size of its files (ulimit -f).
#pragma once

#include <csignal>

namespace slew {

// A write beyond the limit fails with EFBIG, which whoever writes can tell and get over; without this SIGXFSZ ends the
// process. For the whole process and the programs that it starts: every program of ours calls it first.
inline void let_writes_fail_at_the_size_limit() noexcept {
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace slew
