// SPDX-License-Identifier: Apache-2.0
// A scene as canonical YAML: every field with its value in SI, in one order, so that reading it gives the same Scene
// and writing that gives the same text. Fields that no text can express (an infinite default: "no limit") are left out.
#pragma once

#include <string>

#include "core/field.h"
#include "core/problem.h"
#include "scene/scene.h"

namespace slew::scene {

// Appends a problem with the longest element when the text is longer than kMaxExpandedBytes.
[[nodiscard]] std::string canonical_text(Scene& scene, Problems& problems);
// Throws LoadError instead.
[[nodiscard]] std::string canonical_text(Scene& scene);

// The same for a file: without the keys that nothing reads, which a file must not have. Reading it gives the same
// Scene, but for values of such keys that an override carried along.
[[nodiscard]] std::string file_text(Scene& scene);

// The value of one field as YAML; empty if a scene cannot express it.
[[nodiscard]] std::string value_text(const Field& field, void* def);

// A text as a value of a scene: a YAML scalar, plain where that is safe, else in double quotes; `${` at its begin,
// which begins an expression, as `$${`.
[[nodiscard]] std::string yaml_text(const std::string& text);

// The YAML scalar alone.
[[nodiscard]] std::string yaml_scalar(const std::string& text);

}  // namespace slew::scene
