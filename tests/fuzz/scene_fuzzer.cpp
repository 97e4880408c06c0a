// SPDX-License-Identifier: Apache-2.0
// The scene reader: any text is a scene or is refused with where and why; it throws LoadError and nothing else.
#include <string>

#include "scene/parameters.h"
#include "scene/scene.h"
#include "tests/fuzz/bytes.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slew;
  try {
    const scene::Scene scene = scene::load_text({reinterpret_cast<const char*>(data), size}, "fuzz.yaml");
    static_cast<void>(scene::parameters(scene));
    // the scene text that a session publishes is a scene again
    const scene::Scene again = scene::load_text(scene.expanded_text, "fuzz.yaml");
    fuzz::require(again.expanded_text == scene.expanded_text);
  } catch (const scene::LoadError& error) {
    fuzz::require(!error.diagnostics().empty() && error.diagnostics().size() <= scene::kMaxReportedProblems + 1);
  }
  return 0;
}
