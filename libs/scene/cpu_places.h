// SPDX-License-Identifier: Apache-2.0
// On which processor each node of a session runs: "mechanics=1, hydraulics=0".
#pragma once

#include <string>
#include <vector>

#include "core/status.h"

namespace slew::scene {

struct CpuPlace {
  std::string role;  // io, mechanics, hydraulics, flex, recorder
  int cpu = 0;       // number of the processor, from 0
};

// Reads such a list; an empty text is an empty list. A role occurs once. The processors are not checked against this
// machine, since a scene is not written for one machine. Error (bad_input): the item and its fault.
[[nodiscard]] Status parse_cpu_places(const std::string& text, std::vector<CpuPlace>& places);

}  // namespace slew::scene
