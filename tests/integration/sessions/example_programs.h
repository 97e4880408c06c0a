// The example controllers, built beside the tests as a user builds them: projects of their own.
#pragma once

#include <ostream>
#include <string>

namespace slew::testing {

struct ExampleFolder {
  const char* name;  // name of the folder under examples/
};
// in the names of tests
inline void PrintTo(const ExampleFolder& folder, std::ostream* out) {
  *out << folder.name;
}

// with the client library, and with the middleware alone
inline constexpr ExampleFolder kControllerExamples[] = {{"controller"}, {"controller_dds"}};

// The path of a program of the example.
[[nodiscard]] std::string example_program(const ExampleFolder& folder,
                                          const std::string& program = "position_controller");

// The library has a sanitizer in it: a program that cannot have it too does not load it.
[[nodiscard]] bool is_sanitized();

}  // namespace slew::testing
