// The physics of a scene stepped by hand in this process, without nodes and messages: what the nodes compute from INIT
// and the ticks, in the same order. For replay and for a look at the start state.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "coupling/subsystem.h"
#include "io_node/saved_session.h"
#include "scene/scene.h"
#include "session/monolithic_session.h"
#include "transport/wire.h"

namespace slew::session {

// How many steps old the newest samples are that mechanics and hydraulics have of each other at step n, below
// kKeptSamples: lost and late samples. For scenes in mode free_running, whose sides bridge such gaps.
using SampleAges = std::function<StepIndex(StepIndex n)>;
inline constexpr StepIndex kKeptSamples = 128;

class DirectSession {
 public:
  // Without ages every sample that the scene exchanges comes in time.
  explicit DirectSession(const scene::Scene& scene, SampleAges ages = {});

  // INIT: start states and samples 0. After reset() again.
  Status start();
  void reset();
  // In the place of start(): the states of one step, at which mechanics and hydraulics have exchanged. Error
  // (bad_input): a state is missing or not this scene's.
  Status load(std::span<const io::SavedState> states);
  // The states after step n-1, in the place of the nodes'. Pre-condition: can_save().
  [[nodiscard]] std::vector<io::SavedState> save(StepIndex n) const;
  [[nodiscard]] Status can_save() const;

  // Applies the commands, then advances all subsystems from t_n to t_{n+1}.
  void step(StepIndex n, std::span<const wire::Command> commands, std::span<const double> controls) noexcept;

  [[nodiscard]] const coupling::Subsystem* subsystem(wire::Role role) const noexcept;
  // Those of mechanics and hydraulics, of each in its order.
  [[nodiscard]] std::vector<ElementVariable> variables() const;
  // Hash of the role's state now, 0 when the scene has no such role.
  [[nodiscard]] std::uint64_t state_hash(wire::Role role) const noexcept;
  // What the role published last; of mechanics, hydraulics or flex.
  [[nodiscard]] const coupling::OwnSample& sample(wire::Role role) const noexcept;
  // Whether the role has a sample of this step.
  [[nodiscard]] bool has_sample(wire::Role role, StepIndex step) const noexcept {
    return role != wire::Role::flex || step % flexible_every_ == 0;
  }
  // What mechanics and hydraulics have said of t_n; empty in a scene without them.
  [[nodiscard]] const coupling::MechanismSample& mechanism() const noexcept { return mechanics_sample_.mechanism; }
  [[nodiscard]] const coupling::ActuatorSample& actuators() const noexcept { return hydraulics_sample_.actuators; }
  // Mechanics' hash at its INIT sample.
  [[nodiscard]] std::uint64_t init_hash() const noexcept { return init_hash_; }
  // What the role's part of the last step reported, and how long it took [ns of the wall clock].
  [[nodiscard]] const StepReport& report(wire::Role role) const noexcept;
  [[nodiscard]] std::int64_t step_time_ns(wire::Role role) const noexcept;
  // Why the last step failed, as "Arm is not finite" or the subsystem's own text; empty when it did not.
  [[nodiscard]] std::string failure() const;

 private:
  [[nodiscard]] coupling::Subsystem* part(wire::Role role) const noexcept;

  SubsystemFamily family_;
  std::unique_ptr<coupling::Subsystem> mechanics_;
  std::unique_ptr<coupling::Subsystem> hydraulics_;
  std::unique_ptr<coupling::Subsystem> flex_;
  coupling::ElasticExchange elastic_exchange_;
  StepIndex flexible_every_;  // steps between two samples for and of flexible bodies
  StepIndex exchange_every_;  // steps between two exchanges of mechanics and hydraulics
  SampleAges ages_;           // empty: as the scene exchanges
  struct Said {
    coupling::MechanismSample mechanism;
    coupling::ActuatorSample actuators;
  };
  std::vector<Said> said_;                // of the last steps, when samples may be late
  coupling::OwnSample mechanics_sample_;  // at t_n
  coupling::OwnSample hydraulics_sample_;
  coupling::OwnSample mechanics_exchanged_, hydraulics_exchanged_;  // those of the last exchange, when it is not t_n's
  coupling::OwnSample flex_sample_;
  coupling::OwnSample mechanics_next_;
  coupling::OwnSample hydraulics_next_;
  StepReport mechanics_report_;
  StepReport hydraulics_report_;
  std::int64_t mechanics_ns_ = 0, hydraulics_ns_ = 0;
  std::uint64_t init_hash_ = 0;
};

}  // namespace slew::session
