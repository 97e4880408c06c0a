// SPDX-License-Identifier: Apache-2.0
// Settings as a scene file of their own: laid over the scene by `include`.
#pragma once

#include <string>
#include <string_view>

#include "analysis/tradeoff/grid.h"
#include "scene/scene.h"

namespace slew::analysis {

// remark: verb and reason, for the first line.
//
// Text of the overlay, to lie in the folder of the scene. A scene that includes others cannot be included itself: then
// the overlay holds the scene's own keys too. scene: the loaded file. Throws LoadError for a file that cannot be read.
[[nodiscard]] std::string overlay_text(const std::string& file, scene::Scene& scene, const scene::Overrides& settings,
                                       const std::string& remark);

// Path of an overlay of the scene: `path`, or without one SCENE_suffix.yaml beside the scene. Throws Failure when that
// is not the scene's folder or holds another kind of file, which is never replaced.
[[nodiscard]] std::string overlay_target(const std::string& file, const std::string& path, std::string_view suffix);

// Writes the text to target and loads it as a check. Throws Failure.
void write_overlay(const std::string& file, const scene::Overrides& settings, const std::string& remark,
                   const std::string& target);

}  // namespace slew::analysis
