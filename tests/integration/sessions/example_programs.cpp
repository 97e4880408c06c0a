// SPDX-License-Identifier: Apache-2.0
#include "example_programs.h"

#include <filesystem>

#include "build_paths.h"

namespace slew::testing {

bool is_sanitized() {
  return *SLEWRING_SANITIZER != '\0';
}

std::string example_program(const ExampleFolder& folder, const std::string& program) {
  return std::string(SLEWRING_BINARY_DIR "/examples/") + folder.name + "/" + program;
}

bool is_left_out(const ExampleFolder& folder) {
  return folder.is_optional && !std::filesystem::exists(example_program(folder));
}

}  // namespace slew::testing
