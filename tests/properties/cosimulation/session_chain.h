// SPDX-License-Identifier: Apache-2.0
// The physics of a scene stepped by hand under inputs that move, to be saved and continued by another chain.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "session/direct_session.h"

namespace slew::testing {

// A parameter change that begins at a step.
struct ChainChange {
  StepIndex at = 0;
  std::string path;
  double value = 0;
  SimDuration over;
};

// Driving of a chain; the same for a continued one.
struct Drive {
  std::vector<ChainChange> changes{};
  // Raw value -1..1 of every channel; none: to and fro, each at its own pace.
  std::vector<double> held_sticks{};
  // How old the newest samples of mechanics and hydraulics are at a step; none: as the scene exchanges.
  session::SampleAges ages{};
};

// Small changes of every number of the scene that may be changed live, ten steps from the start and of different
// lengths: at step 100 some have arrived and some are under way.
[[nodiscard]] std::vector<ChainChange> small_changes(const scene::Scene& scene);

// States by role, without the frame of a checkpoint.
using SavedParts = std::map<wire::Role, std::vector<std::byte>>;

class SessionChain : private session::DirectSession {
 public:
  // scene and drive outlive the chain.
  SessionChain(const scene::Scene& scene, const Drive& drive)
      : DirectSession(scene, drive.ages), scene_(scene), drive_(drive), controls_(scene.inputs.size()) {}

  void start();
  void step();
  void run_to(StepIndex n) {
    while (n_ < n) step();
  }

  [[nodiscard]] SavedParts save() const;
  // Replaces start(): continues from the states that another chain saved now, with its samples that are still to be
  // exchanged.
  void go_on(const SavedParts& saved, const SessionChain& from);

  // Fails the test, and returns false, if anything differs in a bit: samples, reports, hashes, variables.
  [[nodiscard]] bool is_same_as(const SessionChain& other) const;

  [[nodiscard]] StepIndex n() const noexcept { return n_; }
  // Null: the scene has no such part.
  using DirectSession::part;
  using DirectSession::report;
  [[nodiscard]] coupling::OwnSample& sample(wire::Role role) noexcept { return now_[index(role)]; }

 private:
  const scene::Scene& scene_;
  const Drive& drive_;
  std::vector<double> controls_;
  StepIndex n_ = 0;
};

}  // namespace slew::testing
