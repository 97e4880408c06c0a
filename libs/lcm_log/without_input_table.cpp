// SPDX-License-Identifier: Apache-2.0
#include "lcm_log/input_table.h"

namespace slew::lcm_log {

InputTable input_table(std::string_view, std::span<const TableChannel>, SimDuration, SimDuration) {
  return {.csv = {},
          .problem = "cannot be read: this program was built without LCM",
          .expected = "the packages liblcm-dev and liblcm-bin, and a build with them"};
}

}  // namespace slew::lcm_log
