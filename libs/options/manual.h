// SPDX-License-Identifier: Apache-2.0
// Manual pages of a program in the macros of man(7), made of its tree of commands.
#pragma once

#include <string>
#include <vector>

#include "options/command_text.h"

namespace slew::options {

struct ManualPage {
  std::string name;  // "slewring-run"
  std::string text;
};

// A page for the program and one for each of its verbs, which contains the verb's own verbs. version: "0.2.0".
[[nodiscard]] std::vector<ManualPage> manual_pages(const CommandText& program, const std::string& version);

}  // namespace slew::options
