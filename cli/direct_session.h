// The physics of a scene stepped by hand in this process, without nodes and messages: what the nodes compute from INIT
// and the ticks, in the same order. For replay and for a look at the start state.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "cli/monolithic_session.h"
#include "coupling/subsystem.h"
#include "scene/scene.h"
#include "transport/wire.h"

namespace slew::cli {

class DirectSession {
 public:
  explicit DirectSession(const scene::Scene& scene);

  // INIT: start states and samples 0. After reset() again.
  Status start();
  void reset();

  // Applies the commands, then advances all subsystems from t_n to t_{n+1}.
  void step(StepIndex n, std::span<const wire::Command> commands, std::span<const double> controls) noexcept;

  [[nodiscard]] const coupling::Subsystem* subsystem(wire::Role role) const noexcept;
  // Hash of the role's state now, 0 when the scene has no such role.
  [[nodiscard]] std::uint64_t state_hash(wire::Role role) const noexcept;
  // Whether the role has a sample of this step.
  [[nodiscard]] bool has_sample(wire::Role role, StepIndex step) const noexcept {
    return role != wire::Role::flex || step % flexible_every_ == 0;
  }
  // Mechanics' hash at its INIT sample.
  [[nodiscard]] std::uint64_t init_hash() const noexcept { return init_hash_; }
  // What the role's part of the last step reported, and how long it took [ns of the wall clock].
  [[nodiscard]] const StepReport& report(wire::Role role) const noexcept;
  [[nodiscard]] std::int64_t step_time_ns(wire::Role role) const noexcept;
  // Why the last step failed; empty when it did not.
  [[nodiscard]] std::string failure() const;

 private:
  SubsystemFamily family_;
  std::unique_ptr<coupling::Subsystem> mechanics_;
  std::unique_ptr<coupling::Subsystem> hydraulics_;
  std::unique_ptr<coupling::Subsystem> flex_;
  coupling::ElasticExchange elastic_exchange_;
  StepIndex flexible_every_;              // steps between two samples for and of flexible bodies
  coupling::OwnSample mechanics_sample_;  // at t_n
  coupling::OwnSample hydraulics_sample_;
  coupling::OwnSample flex_sample_;
  coupling::OwnSample mechanics_next_;
  coupling::OwnSample hydraulics_next_;
  StepReport mechanics_report_;
  StepReport hydraulics_report_;
  std::int64_t mechanics_ns_ = 0, hydraulics_ns_ = 0;
  std::uint64_t init_hash_ = 0;
};

}  // namespace slew::cli
