// SPDX-License-Identifier: Apache-2.0
// The hash chain of a scene computed inside the test: by hand over the subsystems, or by the nodes on one thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "recorded_session.h"
#include "scene/scene.h"
#include "transport/wire.h"

namespace slew::testing {

// The scene of a file with overrides as on the command line ("Bag.mass=1500kg") and a duration ("0.5 s").
[[nodiscard]] scene::Scene load_scene(const std::string& file, const std::string& duration,
                                      const std::vector<std::string>& overrides = {});

// Feeds recorded ticks to fresh subsystems, without nodes and messages. Only the physics hashes are filled.
[[nodiscard]] HashChain chain_of_ticks(const scene::Scene& scene, const std::map<StepIndex, wire::Tick>& ticks);

// All four nodes on this thread over the in-process bus; the recording goes to `runs`.
[[nodiscard]] RecordedSession run_in_one_process(const scene::Scene& scene, const std::filesystem::path& runs);

// The physics hashes after the last step of the other three nodes on this thread without a recorder: no message of a
// step is encoded, no hash computed while it runs.
[[nodiscard]] StepHashes last_hashes_without_recorder(const scene::Scene& scene);

// The chain of an undisturbed session with this number of steps of 1 ms, by the nodes on one thread.
[[nodiscard]] HashChain undisturbed_chain(const std::string& scene_file, StepIndex steps);

// The physics hashes alone.
[[nodiscard]] HashChain physics_only(HashChain chain);

}  // namespace slew::testing
