// The hydraulic circuit of a scene as a Subsystem: the circuit's own integration with the partner's reduced mechanics
// inside, volumes made consistent with the true piston positions at each exchange (coupling study, section 8).
//
//   level two:  v^h' = a_free + W F_line(F, x^h, v^h)       level hold:  v^h' = 0                    (1)
//
// Also follows the coupling's error per port (coupling/indicator.h), since it is where both samples of a step meet.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "coupling/indicator.h"
#include "coupling/line_force.h"
#include "coupling/parameter_ramps.h"
#include "coupling/subsystem.h"
#include "hydraulics/circuit.h"
#include "hydraulics/circuit_integrator.h"
#include "scene/scene.h"

namespace slew::hydraulic_node {

// Partner's reduced model (1) as the circuit's piston motion.
class ReducedMechanics final : public hydraulics::PistonMotion {
 public:
  explicit ReducedMechanics(std::vector<coupling::LineForceLaw> laws) : laws_(std::move(laws)) {}
  void set_sample(const coupling::MechanismSample& sample) noexcept {
    W_ = sample.W;
    a_free_ = sample.a_free;
  }
  void accelerations(const double* F, const double* x, const double* v, double* a) const noexcept override;
  void slopes(const double* F, const double* x, const double* v, double* da_dF, double* da_dx,
              double* da_dv) const noexcept override;
  [[nodiscard]] const coupling::LineForceLaw& law(std::size_t port) const noexcept { return laws_[port]; }

 private:
  std::vector<coupling::LineForceLaw> laws_;
  coupling::PortMatrix W_;
  coupling::PortArray a_free_;
};

// The end of a step that somebody else computed: all states of the circuit, pistons included; work and impulse of the
// ports over the step [J, N s].
struct FollowedCircuit {
  std::span<const double> state, work, impulse;
};

class HydraulicsSubsystem final : public coupling::Subsystem {
 public:
  // Pre-condition: a validated scene with a circuit; it outlives the subsystem (reset() builds from it again).
  explicit HydraulicsSubsystem(const scene::Scene& scene);

  [[nodiscard]] bool first_sample(coupling::OwnSample& sample) noexcept override;
  Status start(const coupling::PartnerSamples& partners, coupling::OwnSample& sample) override;
  StepReport step(StepIndex n, const coupling::PartnerSamples& partners, std::span<const double> controls,
                  coupling::OwnSample& sample) noexcept override;
  // In the place of step(): parameters and controls of this step, then what is published at its end.
  StepReport follow(StepIndex n, const FollowedCircuit& step, const coupling::PartnerSamples& partners,
                    std::span<const double> controls, coupling::OwnSample& sample) noexcept;
  bool change_parameter(StepIndex n, const coupling::ParameterChange& change) noexcept override;
  void reset() override;
  [[nodiscard]] std::uint64_t state_hash() const noexcept override;
  [[nodiscard]] coupling::Level level() const noexcept override { return level_; }
  [[nodiscard]] std::span<const ElementVariable> variables() const noexcept override { return variables_; }
  void read_variables(std::span<double> values) const noexcept override;
  [[nodiscard]] std::string_view offender_name(std::int32_t index) const noexcept override;

  [[nodiscard]] const coupling::Indicator& indicator() const noexcept { return indicator_; }
  [[nodiscard]] const hydraulics::Circuit& circuit() const noexcept { return *circuit_; }
  [[nodiscard]] const hydraulics::CircuitIntegrator& integrator() const noexcept { return *integrator_; }
  [[nodiscard]] hydraulics::CircuitIntegrator& integrator() noexcept { return *integrator_; }  // for tests and tools

 private:
  void take_tick(StepIndex n, std::span<const double> controls) noexcept;
  void take_mechanism(const coupling::MechanismSample& mechanism) noexcept;
  void publish(coupling::ActuatorSample& sample, std::uint32_t flags) noexcept;
  void list_variables();

  const scene::Scene& scene_;  // outlives the subsystem
  std::unique_ptr<hydraulics::Circuit> circuit_;
  std::unique_ptr<hydraulics::CircuitIntegrator> integrator_;
  std::size_t m_;
  coupling::Level level_;
  SimDuration H_;
  std::vector<std::string> port_names_;
  std::vector<int> control_of_channel_;  // -1: the channel is not for this circuit
  ReducedMechanics reduced_;
  hydraulics::HeldSpeed held_;
  coupling::Indicator indicator_;
  coupling::ParameterRamps ramps_{0};  // sized with the circuit
  std::vector<ElementVariable> variables_;
  coupling::ActuatorSample published_;
  StepReport failure_;
};

[[nodiscard]] std::unique_ptr<coupling::Subsystem> make_hydraulics_subsystem(const scene::Scene& scene);

}  // namespace slew::hydraulic_node
