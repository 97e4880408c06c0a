// SPDX-License-Identifier: Apache-2.0
// Warns about scene variables that recording.variables does not select: before a run, and when a recording lacks one.
//
// Only the built model has the quantities of an element. Here a name is one of the scene when the part in front of its
// first dot is an element, or a section, of the scene.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "recording/reader.h"
#include "scene/scene.h"
#include "session/direct_session.h"

namespace slew::session {

// Names and patterns that belong to the scene and that no pattern of recording.variables can meet.
[[nodiscard]] std::vector<std::string> unrecorded(const scene::Scene& scene, std::span<const std::string> patterns);

// A sentence for every plot of which something will not be drawn for that reason.
[[nodiscard]] std::vector<std::string> unrecorded_plots(const scene::Scene& scene);

// A sentence, with its place in the file, for every pattern of recording.variables and of a plot that no variable of
// the session fits: nothing is recorded or drawn for it. The session need not be started; without a session one is made
// where the patterns need it; throws Failure for a model that cannot be built.
[[nodiscard]] std::vector<std::string> unmet_patterns(const scene::Scene& scene, const DirectSession& session);
[[nodiscard]] std::vector<std::string> unmet_patterns(const scene::Scene& scene);

// "[Cyl_*, Bag.position.y]"
[[nodiscard]] std::string recorded_patterns_text(const scene::Scene& scene);

// Reason why a recording has no variable that fits these patterns. names: its variables.
[[nodiscard]] std::string why_missing(const recording::Reader& reader, std::span<const std::string> patterns,
                                      std::span<const std::string> names);

}  // namespace slew::session
