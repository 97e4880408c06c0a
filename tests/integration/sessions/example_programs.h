// The example controllers, built as a user builds them: projects of their own.
#pragma once

#include <ostream>
#include <string>

namespace slew::testing {

struct ExampleFolder {
  const char* name;    // of the folder under examples/
  bool needs_install;  // finds Slewring's client library as a package
};
// in the names of tests
inline void PrintTo(const ExampleFolder& folder, std::ostream* out) {
  *out << folder.name;
}

inline constexpr ExampleFolder kControllerExamples[] = {{"controller", true}, {"controller_dds", false}};

// Configures and builds the example once a process; kept between runs, so that a second one has nothing to compile.
// The path of its program. Throws with the output of what failed.
[[nodiscard]] std::string build_example(const ExampleFolder& folder,
                                        const std::string& program = "position_controller");

// The library has a sanitizer in it: a program that cannot have it too does not load it.
[[nodiscard]] bool is_sanitized();

}  // namespace slew::testing
