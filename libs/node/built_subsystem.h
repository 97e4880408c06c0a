// What the program of a physics node builds from the session's scene.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
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

}  // namespace slew::node
