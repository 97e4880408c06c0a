// SPDX-License-Identifier: Apache-2.0
// Samples of the mechanics that arrive late (free-running): each corrects the pistons by its difference to what the
// circuit had at the step of the sample (coupling/own_past.h).
#pragma once

#include <cstddef>
#include <vector>

#include "core/state_bytes.h"
#include "coupling/own_past.h"
#include "coupling/samples.h"
#include "hydraulics/circuit.h"
#include "hydraulics/circuit_integrator.h"

namespace slew::hydraulics_node {

// The numbers of an actuator sample as bytes. cross: numbers of K_cross.
template <typename Sample, typename Bytes>
void visit_actuators(Sample& sample, std::size_t ports, std::size_t cross, Bytes& bytes) {
  for (auto* values :
       {&sample.F, &sample.F_dot, &sample.K, &sample.lambda, &sample.D, &sample.x_ref, &sample.v_ref,
        &sample.friction_scale, &sample.work, &sample.impulse, &sample.p_A, &sample.p_B, &sample.Q_A, &sample.Q_B}) {
    visit_sized(bytes, *values, ports);
  }
  bytes.number(sample.flags);
  if (cross > 0) visit_sized(bytes, sample.K_cross, cross);
}

class LateSamples {
 public:
  // cross: numbers of the samples' K_cross; remembered: number of steps, 0 where no sample is late. Allocates; nothing
  // else does.
  LateSamples(std::size_t ports, std::size_t cross, std::size_t remembered);
  void clear() noexcept;

  // Remembers the pistons at the beginning of step n; the sample that was published at step n.
  void keep_pistons(StepIndex n, const hydraulics::Circuit& circuit,
                    const hydraulics::CircuitIntegrator& integrator) noexcept;
  void keep_sent(StepIndex n, const coupling::ActuatorSample& sample) noexcept;

  // Corrects the pistons by the mechanics' sample of an earlier step. A sample that is too old changes nothing.
  void align(StepIndex step, const coupling::MechanismSample& mechanism,
             hydraulics::CircuitIntegrator& integrator) noexcept;
  // The own sample of that step, for the indicator: its pistons are behind the mechanics' by the difference of the
  // strokes in that step, since the circuit's own position then lacks later corrections. H: step [s]. False: none.
  [[nodiscard]] bool own_sample(StepIndex step, const coupling::MechanismSample& mechanism, double H,
                                coupling::ActuatorSample& own) const noexcept;

  template <typename Self, typename Bytes>
  static void visit(Self& self, Bytes& bytes) {
    if (self.sent_.empty()) return;
    if constexpr (Bytes::kIsReading) {
      self.past_.load(bytes);
    } else {
      self.past_.save(bytes);
    }
    for (auto& sent : self.sent_) {
      bytes.number(sent.step);
      if (sent.step < 0) continue;
      visit_actuators(sent.sample, self.ports_, self.cross_, bytes);
      visit_sized(bytes, sent.displacement, self.ports_);
    }
  }

 private:
  struct SentSample {
    StepIndex step = -1;
    coupling::ActuatorSample sample;
    coupling::PortArray displacement;  // by port, of the circuit's own piston in the step before [m]
  };

  std::size_t ports_, cross_;
  coupling::OwnPast past_;        // position and speed of the pistons
  std::vector<SentSample> sent_;  // samples of the last steps
};

}  // namespace slew::hydraulics_node
