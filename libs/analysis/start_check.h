// SPDX-License-Identifier: Apache-2.0
// Warnings that need a started session and come before a run: its coupling levels, and loads that the pressures of
// common volumes cannot hold.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"
#include "session/direct_session.h"

namespace slew::analysis {

// coupling_warnings(), and one sentence with the actuators and the forces that an equilibrium start leaves without
// pressure (hydraulics/start_pressures.h). Pre-condition: session is started and of this scene.
[[nodiscard]] std::vector<std::string> start_warnings(const scene::Scene& scene, const session::DirectSession& session);

// The same for a scene that is not started yet; none when it cannot start, which its run reports.
[[nodiscard]] std::vector<std::string> start_warnings(const scene::Scene& scene);

}  // namespace slew::analysis
