#include "example_programs.h"

#include "build_paths.h"

namespace slew::testing {

bool is_sanitized() {
  return *SLEWRING_SANITIZER != '\0';
}

std::string example_program(const ExampleFolder& folder, const std::string& program) {
  return std::string(SLEWRING_BINARY_DIR "/examples/") + folder.name + "/" + program;
}

}  // namespace slew::testing
