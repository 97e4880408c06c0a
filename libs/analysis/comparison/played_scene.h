// SPDX-License-Identifier: Apache-2.0
// A scene stepped in this process with its script as input: the results of `slewring run --in-process`, bit for bit,
// without messages and recording.
#pragma once

#include <span>
#include <vector>

#include "io_node/session_inputs.h"
#include "scene/scene.h"
#include "session/direct_session.h"

namespace slew::analysis {

// Hashes of the states that determine all later steps; 0 where the scene has no such state.
struct StateHashes {
  std::uint64_t mechanics = 0, hydraulics = 0;
  bool operator==(const StateHashes&) const = default;
};

class PlayedScene {
 public:
  // The scene must outlive it. Throws Failure when no start state exists.
  explicit PlayedScene(const scene::Scene& scene);

  // The inputs of the tick that begins at time().
  [[nodiscard]] const io_node::InputGate& inputs() const noexcept { return inputs_.gate(); }
  // From step() to the next one: controls and parameter changes of this step, then the physics.
  void advance();

  [[nodiscard]] StepIndex step() const noexcept { return n_; }
  [[nodiscard]] SimTime time() const noexcept { return start_of(n_, H_); }
  [[nodiscard]] const session::DirectSession& session() const noexcept { return session_; }
  // Controls of the last advance(), by input channel.
  [[nodiscard]] std::span<const double> controls() const noexcept { return controls_; }
  [[nodiscard]] StateHashes state_hashes() const noexcept;

 private:
  // Inputs and parameter changes of the tick of step n_.
  void take_tick();

  SimDuration H_;
  io_node::SessionInputs inputs_;
  session::DirectSession session_;
  StepIndex n_ = 0;
  std::vector<double> controls_;
  std::vector<wire::Command> commands_;
};

}  // namespace slew::analysis
