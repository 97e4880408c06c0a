// SPDX-License-Identifier: Apache-2.0
// A reason to end the program: thrown anywhere above the step loops, caught in main, printed as one line.
#pragma once

#include <stdexcept>
#include <string>

#include "core/status.h"

namespace slew {

class Failure : public std::runtime_error {
 public:
  Failure(ExitCode code, const std::string& text) : std::runtime_error(text), code_(code) {}
  [[nodiscard]] ExitCode code() const noexcept { return code_; }

 private:
  ExitCode code_;
};

// Throws when the status is an error.
inline void require(const Status& status) {
  if (!status.is_ok()) throw Failure(status.code, status.text);
}

}  // namespace slew
