// SPDX-License-Identifier: Apache-2.0
// A session whose physics is one system (libs/monolith), seen as the subsystems of any other: the same samples,
// variables and parameters, so that driver, recorder and replay do not depend on it.
//
// The subsystems of a session share one monolith. The first subsystem to step integrates it to the end of that step,
// stopped at every change that a tick makes; each then shows its own part of the state through the subsystem that
// computes it elsewhere (follow()). A flex node takes part as always: it has no state of its own.
// Not for real time: a step allocates and its cost is not bounded.
#pragma once

#include <memory>

#include "coupling/subsystem.h"
#include "scene/scene.h"
#include "transport/wire.h"

namespace slew::session {

class Monolithic;

// The subsystems of one session, split or monolithic as the scene selects. Null where the scene has no such subsystem.
// The scenes (all alike) outlive the subsystems. Not for several threads.
class SubsystemFamily {
 public:
  [[nodiscard]] std::unique_ptr<coupling::Subsystem> make(wire::Role role, const scene::Scene& scene);

 private:
  std::shared_ptr<Monolithic> monolithic_;  // null until a member of a monolithic scene is made
};

}  // namespace slew::session
