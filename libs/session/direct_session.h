// SPDX-License-Identifier: Apache-2.0
// The physics of a scene stepped by hand in this process, without nodes and messages: it computes the nodes' results
// from INIT and the ticks, in the same order. For replay and for a look at the start state.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "coupling/subsystem.h"
#include "io_node/saved_session.h"
#include "node/exchange.h"
#include "scene/scene.h"
#include "session/monolithic_session.h"
#include "transport/roles.h"
#include "transport/wire.h"

namespace slew::session {

// Age in steps of the newest samples that mechanics and hydraulics have of each other at step n, below kKeptSamples:
// lost and late samples. For scenes in mode free_running, whose sides bridge such gaps.
using SampleAges = std::function<StepIndex(StepIndex n)>;
inline constexpr StepIndex kKeptSamples = 128;

class DirectSession {
 public:
  // Without ages every sample of the scene's exchange arrives in time.
  explicit DirectSession(const scene::Scene& scene, SampleAges ages = {});

  // INIT: start states and samples 0. After reset() again.
  Status start();
  void reset();
  // Replaces start(): loads the states of one step, at which mechanics and hydraulics have exchanged. Error
  // (bad_input): a state is missing or not this scene's.
  Status load(std::span<const io_node::SavedState> states);
  // Returns the nodes' states after step n-1. Pre-condition: can_save().
  [[nodiscard]] std::vector<io_node::SavedState> save(StepIndex n) const;
  [[nodiscard]] Status can_save() const;

  // Applies the commands, then advances all subsystems from t_n to t_{n+1}.
  void step(StepIndex n, std::span<const wire::Command> commands, std::span<const double> controls) noexcept;

  [[nodiscard]] const coupling::Subsystem* subsystem(wire::Role role) const noexcept;
  // The role's physics without instruments, of the type of its program; null: no such role, or a monolithic scene.
  template <typename Physics>
  [[nodiscard]] const Physics* physics(wire::Role role) const noexcept {
    const coupling::Subsystem* const part = subsystem(role);
    return part == nullptr ? nullptr : dynamic_cast<const Physics*>(&part->physics());
  }
  // Variables of mechanics and hydraulics, each in its order.
  [[nodiscard]] std::vector<ElementVariable> variables() const;
  // Hash of the role's state now, 0 when the scene has no such role.
  [[nodiscard]] std::uint64_t state_hash(wire::Role role) const noexcept;
  // Last published sample of a physics role.
  [[nodiscard]] const coupling::OwnSample& sample(wire::Role role) const noexcept;
  // Whether the role has a sample of this step.
  [[nodiscard]] bool has_sample(wire::Role role, StepIndex step) const noexcept {
    return rules_.is_published_at(transport::traits(role).sample, step);
  }
  // Samples of mechanics and hydraulics at t_n; empty in a scene without them.
  [[nodiscard]] const coupling::MechanismSample& mechanism() const noexcept {
    return sample(wire::Role::mechanics).mechanism;
  }
  [[nodiscard]] const coupling::ActuatorSample& actuators() const noexcept {
    return sample(wire::Role::hydraulics).actuators;
  }
  // Hash of mechanics at its INIT sample.
  [[nodiscard]] std::uint64_t init_hash() const noexcept { return init_hash_; }
  // Report of the role's part of the last step, and its duration [ns of the wall clock].
  [[nodiscard]] const StepReport& report(wire::Role role) const noexcept;
  [[nodiscard]] std::int64_t step_time_ns(wire::Role role) const noexcept;
  // Cause of the last step's failure, as "Arm is not finite" or the subsystem's own text; empty when it succeeded.
  [[nodiscard]] std::string failure() const;

 protected:  // the tests of saved states save and load between two exchanges
  // The two samples that mechanics and hydraulics exchange.
  struct Exchanged {
    coupling::MechanismSample mechanism;
    coupling::ActuatorSample actuators;
  };

  static constexpr std::size_t index(wire::Role role) noexcept { return static_cast<std::size_t>(role); }
  [[nodiscard]] coupling::Subsystem* part(wire::Role role) const noexcept {
    return transport::is_physics(role) ? parts_[index(role)].get() : nullptr;
  }
  [[nodiscard]] coupling::PartnerSamples partners_at_start(wire::Role role) const noexcept;
  [[nodiscard]] coupling::PartnerSamples partners_in_step(wire::Role role, StepIndex n) const noexcept;
  void advance(wire::Role role, StepIndex n, std::span<const wire::Command> commands,
               std::span<const double> controls) noexcept;

  SubsystemFamily family_;
  std::array<std::unique_ptr<coupling::Subsystem>, wire::kRoles> parts_;
  node::ExchangeRules rules_;
  SampleAges ages_;  // empty: the ages of the scene's exchange
  // samples of the last steps, by step, where a step uses samples of other instants than its own
  std::vector<Exchanged> history_;
  std::array<coupling::OwnSample, wire::kRoles> now_, next_;  // at t_n, t_{n+1}
  std::array<StepReport, wire::kRoles> reports_{};            // reports of the last step
  std::array<std::int64_t, wire::kRoles> step_ns_{};
  std::uint64_t init_hash_ = 0;
};

}  // namespace slew::session
