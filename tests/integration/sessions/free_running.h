// SPDX-License-Identifier: Apache-2.0
// Free-running sessions of real processes, and counts of their recordings.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include "coupling/indicator.h"
#include "session.h"

namespace slew::testing {

// Samples of this quality.
template <typename Messages>
[[nodiscard]] std::int64_t count(const Messages& messages, coupling::Quality quality) {
  return std::count_if(messages.begin(), messages.end(),
                       [&](const auto& message) { return message.state.quality == quality; });
}

// Largest coupling indicator of the ports; -1 without one.
[[nodiscard]] double largest_eta(const RecordedSession& recorded);

// 3 s, in which the hydraulics stands still for 20 ms at least.
[[nodiscard]] RecordedSession run_with_a_partner_that_stands_still();

// problem: why it is not possible here. late: samples that a node did not wait for; most lost datagrams are sent again
// in time, so that a run of seconds may have none.
struct LossyRun {
  std::string problem;
  RecordedSession recorded;
  std::int64_t late;
};

// On both sides of a cable that loses 1 % of the datagrams. The nodes are scheduled FIFO, so that other programs cost
// them nothing, but with a sanitizer, where no other program would get a processor.
[[nodiscard]] LossyRun run_over_a_lossy_cable(std::int64_t seconds);

}  // namespace slew::testing
