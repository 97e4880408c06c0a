// SPDX-License-Identifier: Apache-2.0
// The hydraulics' linearisation of the pressure forces as the mechanics use it: coupling level of each port, age of the
// sample in use, and the correction by late samples (coupling study, section 6).
#pragma once

#include <span>

#include "core/state_bytes.h"
#include "core/state_hash.h"
#include "coupling/own_past.h"
#include "coupling/port_dynamics.h"
#include "coupling/port_levels.h"
#include "coupling/samples.h"
#include "scene/scene.h"

namespace slew::mechanics_node {

class PartnerForce {
 public:
  // Allocates; nothing else does.
  explicit PartnerForce(const scene::Scene& scene);
  void reset() noexcept;

  // Step n uses the sample of step n - age.
  void receive(StepIndex n, StepIndex age) noexcept;
  [[nodiscard]] StepIndex age() const noexcept { return age_; }
  [[nodiscard]] bool is_free_running() const noexcept { return is_free_running_; }
  // Whether the sample is too old for the oscillation of the published mobility W against its stiffness K. H: step [s].
  [[nodiscard]] bool is_too_old(const coupling::PortMatrix& W, const coupling::ActuatorSample& sample,
                                double H) const noexcept;

  // Pressure force at the start of a step, where the ports are at x [m] and the mechanics' copy is `copy` [N]. A new
  // sample of this step gives its force at x; without a new sample the copy is continued; a late sample corrects the
  // copy by the difference at the step that the sample belongs to.
  [[nodiscard]] double at_exchange(std::size_t port, const coupling::ActuatorSample& sample, double copy,
                                   std::span<const double> x) noexcept;
  // The linearisation that the port's level uses.
  [[nodiscard]] coupling::RowPartner linearisation(std::size_t port,
                                                   const coupling::ActuatorSample& sample) const noexcept;
  // Remembers strokes and pressure forces at the start of step n, for late samples. Without effect in lock-step.
  void remember(StepIndex n, std::span<const double> x, std::span<const double> z) noexcept;

  [[nodiscard]] coupling::PortLevels& levels() noexcept { return levels_; }
  [[nodiscard]] const coupling::PortLevels& levels() const noexcept { return levels_; }

  // Saved state, in two parts (saved_mechanics.cpp).
  template <typename Self, typename Bytes>
  static void visit_past(Self& self, Bytes& bytes) {
    if (!self.is_free_running_) return;
    if constexpr (Bytes::kIsReading) {
      self.past_.load(bytes);
    } else {
      self.past_.save(bytes);
    }
  }
  template <typename Self, typename Bytes>
  static void visit_age(Self& self, Bytes& bytes) {
    bytes.number(self.used_step_);
    bytes.number(self.age_);
  }

 private:
  coupling::PortLevels levels_;
  bool is_free_running_;
  coupling::OwnPast past_;       // free-running: stroke and pressure force by port
  StepIndex used_step_ = -1;     // step of the sample in use
  StepIndex age_ = 0;            // age of this sample in the last step
  bool has_new_sample_ = false;  // the sample arrived in this step
};

}  // namespace slew::mechanics_node
