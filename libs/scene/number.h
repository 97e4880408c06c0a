// SPDX-License-Identifier: Apache-2.0
// Numbers as scene files write them: decimal, finite, without the traps of YAML (010, 0x1F, .inf, 1_000).
#pragma once

#include <string>
#include <string_view>

#include "scene/diagnostic.h"

namespace slew::scene {

// A text split into its leading number and what follows it (a unit, or nothing).
struct NumberText {
  bool is_number = false;
  // nearest long double to the decimal text, so that scaling by a unit rounds once; its nearest double is the text's
  long double value = 0;
  std::string_view rest;  // behind the number, without spaces around it
  ValueProblem problem;   // set if the text is not an accepted number
};

[[nodiscard]] NumberText split_number(std::string_view text);

}  // namespace slew::scene
