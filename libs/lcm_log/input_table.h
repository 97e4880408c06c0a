// SPDX-License-Identifier: Apache-2.0
// The inputs of an LCM event log as a time table for the scene's script (scene/csv_table.h), as a session would have
// applied them: `slewring run --input FILE.lcm`.
//
// Time 0 is the log's first event of any channel. Events are taken in their order: where times fall, by at most 100 ms,
// the later event has the time of the earlier one. A value holds until the next one of its channel, or until the
// session's controller_timeout is over: then the channel is neutral. A channel belongs to the controller whose message
// was the first, until that has been silent for kHoldAfterSilence.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/time.h"

namespace slew::lcm_log {

struct TableChannel {
  std::string name;
  bool is_digital = false;
};

struct InputTable {
  std::string csv;
  std::string problem{};  // empty: none; what is wrong with the log
  std::string expected{};
  std::vector<std::string> warnings{};
};

// step: of the session; a time within a microsecond of a step is that of the step, since logs have microseconds.
[[nodiscard]] InputTable input_table(std::string_view log, std::span<const TableChannel> channels, SimDuration step,
                                     SimDuration neutral_after);

}  // namespace slew::lcm_log
