// SPDX-License-Identifier: Apache-2.0
// How a run at the limits ended: right within a stated bound, or flagged; anything else is silent garbage.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace slew::multibody::testing {

struct Outcome {
  bool is_flagged = false;  // by at least one step, or not finite, which a session names and stops at
  double error = 0;         // largest, in the unit of the bound
};

// settled: right or flagged, whichever it is.
enum class Ending { right, flagged, settled };

// With SLEWRING_FIGURES set a row of docs/extremes.md is printed.
inline void expect_outcome(const std::string& extreme, const std::string& setting, const Outcome& outcome, double bound,
                           Ending expected) {
  const bool is_right = outcome.error <= bound;
  EXPECT_TRUE(outcome.is_flagged || is_right)
      << "silent garbage: " << extreme << ", " << setting << ", error " << outcome.error;
  if (expected == Ending::right) {
    EXPECT_TRUE(is_right) << extreme << ", " << setting << ", error " << outcome.error;
    EXPECT_FALSE(outcome.is_flagged) << extreme << ", " << setting;
  } else if (expected == Ending::flagged) {
    EXPECT_TRUE(outcome.is_flagged) << extreme << ", " << setting << ", error " << outcome.error;
  }
  if (std::getenv("SLEWRING_FIGURES") == nullptr) return;
  std::printf("| %s | %s | %.0e | %.1e | %s |\n", extreme.c_str(), setting.c_str(), bound, outcome.error,
              outcome.is_flagged ? "flagged"
              : is_right         ? "right"
                                 : "WRONG");
}

}  // namespace slew::multibody::testing
