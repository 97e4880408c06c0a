// SPDX-License-Identifier: Apache-2.0
// Behaviour of a process at the limit on its file size (ulimit -f).
#pragma once

#include <csignal>

namespace slew {

// Makes a write beyond the limit fail with EFBIG, which the writing code handles; otherwise SIGXFSZ would end the
// process. Applies to the whole process and the programs that it starts. Every program of the project calls it first.
inline void let_writes_fail_at_the_size_limit() noexcept {
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace slew
