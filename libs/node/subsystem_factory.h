// SPDX-License-Identifier: Apache-2.0
// Builds the subsystem of a physics node's program: loads the scene from the session's text, compares its files, and
// selects the variables to publish.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/status.h"
#include "core/time.h"
#include "coupling/subsystem.h"
#include "node/exchange.h"
#include "scene/scene.h"
#include "transport/wire.h"

namespace slew::node {

struct BuiltSubsystem {
  std::shared_ptr<const void> scene;  // the subsystem refers to it; destroyed after the subsystem
  std::unique_ptr<coupling::Subsystem> subsystem;
  std::uint32_t variables_every = 10;              // steps between two variable blocks
  std::vector<std::uint32_t> published_variables;  // indices into Subsystem::variables(), ascending
  scene::SessionDef session;
  ExchangeRules exchange;
  StepIndex exchange_unit = 1;  // steps after which all nodes have exchanged
};

// Builds the subsystem. Error: the reason why it cannot (assets that differ, a scene that this build cannot run).
using SubsystemFactory = std::function<Status(const wire::SessionDescription&, BuiltSubsystem&)>;

using MakeSubsystem = std::function<std::unique_ptr<coupling::Subsystem>(const scene::Scene&)>;

// assets: folder of the scene's files. The factory owns the scene, to which the subsystem refers: it must outlive the
// subsystem.
[[nodiscard]] SubsystemFactory subsystem_factory(MakeSubsystem make, std::string assets);

// Compares the files of a session's manifest with those in the folder. Error bad_input: names the differences.
[[nodiscard]] Status check_session_assets(const wire::SessionDescription& session, const std::string& assets);

// The published variables of a subsystem, by the scene's `recording.variables`.
[[nodiscard]] std::vector<std::uint32_t> published_variables(const scene::Scene& scene,
                                                             const coupling::Subsystem& subsystem);

}  // namespace slew::node
