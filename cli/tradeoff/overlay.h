// Settings as a scene file of their own: laid over the scene by `include`.
#pragma once

#include <string>

#include "cli/tradeoff/grid.h"
#include "scene/scene.h"

namespace slew::cli {

// remark: the verb that writes it and why, for the first line.
//
// Text of the overlay, to lie in the folder of the scene. A scene that includes others cannot be included itself: then
// the overlay holds the scene's own keys too. scene: the loaded file. Throws LoadError for a file that cannot be read.
[[nodiscard]] std::string overlay_text(const std::string& file, scene::Scene& scene, const scene::Overrides& settings,
                                       const std::string& remark);

// Writes it and reads it back: what was written loads, and is the scene with these settings. Without a path it lies
// beside the scene, as SCENE_tradeoff.yaml. A file that is not such an overlay is never replaced. Returns the path.
// Throws Failure.
std::string write_overlay(const std::string& file, const scene::Overrides& settings, const std::string& remark,
                          const std::string& path);

}  // namespace slew::cli
