// SPDX-License-Identifier: Apache-2.0
// The hydraulic circuit of a scene as a Subsystem: the circuit's own integration with the partner's reduced mechanics
// inside, volumes made consistent with the true piston positions at each exchange (coupling study, section 8).
//
//   v_i^h' = (a_free + W F_line)_i  of a port of level two,   v_i^h' = 0  of any other                (1)
//
// F_line_j is evaluated at F, x^h, v^h of port j at any level, since a held port's force moves the others too. At level
// tlm F is the force of the lines on the piston (hydraulics/line_chambers.h), as in the mechanics.
//
// Also computes the coupling error per port (coupling/indicator.h), since it has both samples of a step, and ends a
// session whose coupling diverges (session.coupling_alarm) or whose circuit is no longer solved (convergence_watch.h).
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "coupling/parameter_ramps.h"
#include "coupling/port_levels.h"
#include "coupling/subsystem.h"
#include "hydraulics/circuit.h"
#include "hydraulics/circuit_integrator.h"
#include "hydraulics_node/control_signals.h"
#include "hydraulics_node/convergence_watch.h"
#include "hydraulics_node/coupling_alarm.h"
#include "hydraulics_node/emptying_chambers.h"
#include "hydraulics_node/foreseen_forces.h"
#include "hydraulics_node/late_samples.h"
#include "hydraulics_node/reduced_mechanics.h"
#include "hydraulics_node/shared_volumes.h"
#include "scene/scene.h"

namespace slew::hydraulics_node {

// The end of a step that another integrator computed: all states of the circuit, pistons included, with the capacities
// of volumes that cavitate (Circuit::vapour_capacities()); work and impulse of the ports over the step [J, N s].
struct FollowedCircuit {
  std::span<const double> state, vapour, work, impulse;
};

class HydraulicsSubsystem final : public coupling::Subsystem {
 public:
  // Pre-condition: a validated scene with a circuit; it outlives the subsystem (reset() builds from it again).
  explicit HydraulicsSubsystem(const scene::Scene& scene);

  [[nodiscard]] bool first_sample(coupling::OwnSample& sample) noexcept override;
  Status start(const coupling::PartnerSamples& partners, coupling::OwnSample& sample) override;
  StepReport step(StepIndex n, const coupling::PartnerSamples& partners, std::span<const double> controls,
                  coupling::OwnSample& sample) noexcept override;
  // Replaces step(): applies parameters and controls of this step, takes the external state and publishes the end
  // sample.
  StepReport follow(StepIndex n, const FollowedCircuit& step, const coupling::PartnerSamples& partners,
                    std::span<const double> controls, coupling::OwnSample& sample) noexcept;
  bool change_parameter(StepIndex n, const coupling::ParameterChange& change) noexcept override;
  void reset() override;
  [[nodiscard]] std::uint64_t state_hash() const noexcept override;
  [[nodiscard]] Status can_save() const override;
  void save(std::vector<std::byte>& state) const override;
  Status load(std::span<const std::byte> state, coupling::OwnSample& sample) override;
  [[nodiscard]] coupling::Level level() const noexcept override { return levels_.lowest(); }
  [[nodiscard]] std::span<const ElementVariable> variables() const noexcept override { return variables_; }
  void read_variables(std::span<double> values) const noexcept override;
  [[nodiscard]] std::string_view offender_name(std::int32_t index) const noexcept override;
  [[nodiscard]] std::string_view failure_text() const noexcept override {
    return alarm_.text().empty() ? convergence_.text() : alarm_.text();
  }

  [[nodiscard]] const coupling::Indicator& indicator() const noexcept { return alarm_.indicator(); }
  // The published sample with the force and the springs of its instant (foreseen_forces.h).
  [[nodiscard]] const coupling::ActuatorSample& at_instant() const noexcept { return has_own_ ? own_ : published_; }
  [[nodiscard]] const hydraulics::Circuit& circuit() const noexcept { return *circuit_; }
  [[nodiscard]] const hydraulics::CircuitIntegrator& integrator() const noexcept { return *integrator_; }
  [[nodiscard]] hydraulics::CircuitIntegrator& integrator() noexcept { return *integrator_; }  // for tests and tools

 private:
  template <typename Self, typename Bytes>
  static void visit(Self& self, Bytes& bytes);
  void apply_levels() noexcept;
  void lump_lines() noexcept;
  void apply_tick(StepIndex n, std::span<const double> controls) noexcept;
  void take_mechanism(StepIndex n, const coupling::MechanismSample& mechanism, StepIndex age,
                      StepReport& report) noexcept;
  void align(const coupling::MechanismSample& mechanism, StepIndex age) noexcept;
  void publish(coupling::ActuatorSample& sample, std::uint32_t flags, bool adds_up, bool is_used) noexcept;
  [[nodiscard]] bool is_out_of_barrel(const double* y) noexcept;
  void list_variables();
  [[nodiscard]] std::size_t cross_count() const noexcept { return shared_.any() ? m_ * m_ : 0; }

  const scene::Scene& scene_;  // outlives the subsystem
  std::unique_ptr<hydraulics::Circuit> circuit_;
  std::unique_ptr<hydraulics::CircuitIntegrator> integrator_;
  std::size_t m_;
  SimDuration H_;
  StepIndex exchange_every_;
  bool is_free_running_;
  coupling::PortLevels levels_;
  ControlSignals signals_;
  SharedVolumes shared_;
  ReducedMechanics reduced_;
  std::vector<hydraulics::ActuatorSprings> springs_;  // over an interval
  EmptyingChambers emptying_;
  ForeseenForces foreseen_;
  LateSamples late_samples_;
  CouplingAlarm alarm_;
  ConvergenceWatch convergence_;
  coupling::ParameterRamps ramps_;
  StepIndex used_step_ = -1;   // step of the mechanics' sample in use
  StepIndex partner_age_ = 0;  // age of this sample in the last step
  std::vector<ElementVariable> variables_;
  coupling::ActuatorSample published_;
  coupling::ActuatorSample own_;  // at_instant()
  bool has_own_ = false;
  coupling::PortArray stiffness_;  // of the oil columns, also of ports that publish none [N/m]
  StepReport failure_;
  std::uint64_t saved_model_ = 0;  // identifies the scenes whose saved states fit
};

[[nodiscard]] std::unique_ptr<coupling::Subsystem> make_hydraulics_subsystem(const scene::Scene& scene);

}  // namespace slew::hydraulics_node
