// SPDX-License-Identifier: Apache-2.0
// Checks before a run whether the communication step suits the coupling levels of a scene.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"
#include "session/direct_session.h"

namespace slew::analysis {

// One sentence for every level whose ports are beyond its limit at the start state (coupling::omega_limit), with its
// fastest port and a suitable step. Pre-condition: session is started and of this scene.
[[nodiscard]] std::vector<std::string> coupling_warnings(const scene::Scene& scene,
                                                         const session::DirectSession& session);

}  // namespace slew::analysis
