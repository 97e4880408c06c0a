// Builds the subsystem of a physics node's program: loads the scene from the session's text, compares its files, and
// selects the variables to publish.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "coupling/subsystem.h"
#include "node/built_subsystem.h"
#include "scene/scene.h"

namespace slew::node {

using MakeSubsystem = std::function<std::unique_ptr<coupling::Subsystem>(const scene::Scene&)>;

// assets: folder of the scene's files. The factory owns the scene, to which the subsystem refers: it must outlive the
// subsystem.
[[nodiscard]] node::SubsystemFactory subsystem_factory(MakeSubsystem make, std::string assets);

// Compares the files of a session's manifest with those in the folder. Error bad_input: names the differences.
[[nodiscard]] Status check_session_assets(const wire::SessionDescription& session, const std::string& assets);

// The published variables of a subsystem, by the scene's `recording.variables`.
[[nodiscard]] std::vector<std::uint32_t> published_variables(const scene::Scene& scene,
                                                             const coupling::Subsystem& subsystem);

}  // namespace slew::node
