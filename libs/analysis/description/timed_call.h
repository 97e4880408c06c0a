// SPDX-License-Identifier: Apache-2.0
// How long one call takes when nothing disturbs it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "analysis/description/cost.h"
#include "core/time.h"

namespace slew::analysis {

// ns, the fastest of kCalls calls.
template <typename Call>
[[nodiscard]] double fastest_of(const Call& call) {
  std::int64_t fastest = std::numeric_limits<std::int64_t>::max();
  for (int i = 0; i < kCalls; ++i) {
    const std::int64_t begin = monotonic_ns();
    call();
    fastest = std::min(fastest, monotonic_ns() - begin);
  }
  return static_cast<double>(fastest);
}

}  // namespace slew::analysis
