// SPDX-License-Identifier: Apache-2.0
// The example controllers, built beside the tests as a user builds them: projects of their own.
#pragma once

#include <ostream>
#include <string>

namespace slew::testing {

struct ExampleFolder {
  const char* name;          // name of the folder under examples/
  bool is_optional = false;  // not built where its middleware is not installed
};
// in the names of tests
inline void PrintTo(const ExampleFolder& folder, std::ostream* out) {
  *out << folder.name;
}

// with the client library, and with a middleware alone: Cyclone, and Fast DDS where it is installed
inline constexpr ExampleFolder kControllerExamples[] = {
    {"controller"}, {"controller_dds"}, {"controller_fastdds", true}};

// The path of a program of the example.
[[nodiscard]] std::string example_program(const ExampleFolder& folder,
                                          const std::string& program = "position_controller");

// An optional example that was not built.
[[nodiscard]] bool is_left_out(const ExampleFolder& folder);

// The library has a sanitizer in it: a program that cannot have it too does not load it.
[[nodiscard]] bool is_sanitized();

}  // namespace slew::testing
