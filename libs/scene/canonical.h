// A scene as canonical YAML: every field with its value in SI, in one order, so that reading it gives the same Scene
// and writing that gives the same text. Fields that no text can express (an infinite default: "no limit") are left out.
#pragma once

#include <string>

#include "scene/scene.h"

namespace slew::scene {

[[nodiscard]] std::string canonical_text(Scene& scene);

// A text as a YAML scalar: plain where that is safe, else in double quotes.
[[nodiscard]] std::string yaml_text(const std::string& text);

}  // namespace slew::scene
