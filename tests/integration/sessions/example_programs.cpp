#include "example_programs.h"

#include <stdexcept>

#include "build_paths.h"
#include "program.h"

namespace slew::testing {
namespace {

constexpr const char* kSanitizer = SLEWRING_SANITIZER;
// where the client library is installed for the examples
constexpr const char* kPrefix = SLEWRING_BINARY_DIR "/examples/installed";
constexpr std::int64_t kBuildNs = 120'000'000'000;

void run_cmake(const std::vector<std::string>& arguments) {
  const ScratchFolder output;
  Program cmake(SLEWRING_CMAKE, arguments, output.path() / "cmake");
  if (cmake.wait(kBuildNs) != 0) throw std::runtime_error(cmake.out() + cmake.err());
}

}  // namespace

bool is_sanitized() {
  return *kSanitizer != '\0';
}

std::string build_example(const ExampleFolder& folder, const std::string& program) {
  const std::string build = std::string(SLEWRING_BINARY_DIR "/examples/") + folder.name;
  std::vector<std::string> configure = {"-S", std::string(SLEWRING_SOURCE_DIR "/examples/") + folder.name, "-B", build};
  if (folder.needs_install) {
    run_cmake({"--install", SLEWRING_BINARY_DIR, "--component", "client", "--prefix", kPrefix});
    configure.push_back(std::string("-DCMAKE_PREFIX_PATH=") + kPrefix);
    // a sanitizer in the library wants to be in the program, too
    for (const char* language : {"C", "CXX"}) {
      const std::string flags = *kSanitizer != '\0' ? std::string("-fsanitize=") + kSanitizer : std::string();
      configure.push_back(std::string("-DCMAKE_") + language + "_FLAGS=" + flags);
    }
  }
  run_cmake(configure);
  run_cmake({"--build", build});
  return build + "/" + program;
}

}  // namespace slew::testing
