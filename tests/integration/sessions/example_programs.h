// The example controllers, built as a user builds them: projects of their own.
#pragma once

#include <string>

namespace slew::testing {

struct ExampleFolder {
  const char* name;    // of the folder under examples/
  bool needs_install;  // finds Slewring's client library as a package
};

inline constexpr ExampleFolder kControllerExamples[] = {{"controller_dds", false}};

// Configures and builds the example once a process; kept between runs, so that a second one has nothing to compile.
// The path of its program position_controller. Throws with the output of what failed.
[[nodiscard]] std::string build_example(const ExampleFolder& folder);

}  // namespace slew::testing
