// SPDX-License-Identifier: Apache-2.0
// Result of an operation that may fail for reasons outside the program, and the exit codes of every program.
#pragma once

#include <string>
#include <utility>

namespace slew {

// Exit codes of `slewring` and of every node; also the class of a Status.
enum class ExitCode : int {
  ok = 0,
  failed = 1,
  bad_input = 2,  // usage, bad file or refused
  losses = 3,     // finished with losses or over a stated miss limit
  node_lost = 4,
  diverged = 5,
  storage = 6,
  resources = 7,      // packages, memory, descriptors
  interrupted = 130,  // SIGINT
  terminated = 143    // SIGTERM
};

// Ok, or a text: what happened, what was done, what the user can do.
struct [[nodiscard]] Status {
  ExitCode code = ExitCode::ok;
  std::string text;

  [[nodiscard]] bool is_ok() const noexcept { return code == ExitCode::ok; }
  [[nodiscard]] static Status ok() { return {}; }
  [[nodiscard]] static Status error(ExitCode code, std::string text) { return {code, std::move(text)}; }
};

}  // namespace slew
