// The hydraulic circuit of a scene as a Subsystem: the circuit's own integration with the partner's reduced mechanics
// inside, volumes made consistent with the true piston positions at each exchange (coupling study, section 8).
//
//   v_i^h' = (a_free + W F_line)_i  of a port of level two,   v_i^h' = 0  of any other                (1)
//
// F_line_j is evaluated at F, x^h, v^h of port j at any level, since a held port's force moves the others too. At level
// tlm F is the force of the lines on the piston (hydraulics/line_chambers.h), as in the mechanics.
//
// Also computes the coupling error per port (coupling/indicator.h), since it has both samples of a step, and ends a
// session whose coupling diverges (session.coupling_alarm).
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "coupling/indicator.h"
#include "coupling/line_force.h"
#include "coupling/own_past.h"
#include "coupling/parameter_ramps.h"
#include "coupling/port_levels.h"
#include "coupling/subsystem.h"
#include "coupling/trends.h"
#include "hydraulics/circuit.h"
#include "hydraulics/circuit_integrator.h"
#include "scene/scene.h"

namespace slew::hydraulic_node {

// Partner's reduced model (1) as the circuit's piston motion.
class ReducedMechanics final : public hydraulics::PistonMotion {
 public:
  explicit ReducedMechanics(std::vector<coupling::LineForceLaw> laws) : laws_(std::move(laws)), ports_(laws_.size()) {}
  void set_sample(const coupling::MechanismSample& sample) noexcept {
    W_ = sample.W;
    a_free_ = sample.a_free;
  }
  void add_to(StateHash& hash) const noexcept {
    hash.add(std::span<const double>(W_.span()));
    hash.add(std::span<const double>(a_free_.span()));
  }
  // The sample and the ports as bytes.
  void save(StateWriter& bytes) const { visit(*this, bytes); }
  void load(StateReader& bytes) noexcept { visit(*this, bytes); }
  void set_level(std::size_t port, coupling::Level level) noexcept { ports_[port].level = level; }
  // Sets the force of a port of level tlm for the next step [N].
  void set_thrust(std::size_t port, double F) noexcept { ports_[port].thrust = F; }
  void accelerations(const double* F, const double* x, const double* v, double* a) const noexcept override;
  void slopes(const double* F, const double* x, const double* v, double* da_dF, double* da_dx,
              double* da_dv) const noexcept override;
  [[nodiscard]] double time_to_rest(const double* v, const double* a, const double* j) const noexcept override;
  [[nodiscard]] const coupling::LineForceLaw& law(std::size_t port) const noexcept { return laws_[port]; }

 private:
  struct Port {
    coupling::Level level = coupling::Level::two;
    double thrust = 0;  // N
  };
  template <typename Self, typename Bytes>
  static void visit(Self& self, Bytes& bytes) {
    visit_sized(bytes, self.W_, self.ports_.size() * self.ports_.size());
    visit_sized(bytes, self.a_free_, self.ports_.size());
    for (auto& port : self.ports_) {
      bytes.choice(port.level, coupling::Level::tlm);
      bytes.number(port.thrust);
    }
  }
  [[nodiscard]] coupling::LineForce line_force(std::size_t port, double F, double x, double v) const noexcept;

  std::vector<coupling::LineForceLaw> laws_;
  std::vector<Port> ports_;
  coupling::PortMatrix W_;
  coupling::PortArray a_free_;
};

// The end of a step computed outside: all states of the circuit, pistons included, the capacities of cavitating volumes
// (Circuit::vapour_capacities()), and work and impulse of the ports over the step [J, N s].
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
    return {failure_text_.data(), failure_text_length_};
  }

  [[nodiscard]] const coupling::Indicator& indicator() const noexcept { return indicator_; }
  [[nodiscard]] const hydraulics::Circuit& circuit() const noexcept { return *circuit_; }
  [[nodiscard]] const hydraulics::CircuitIntegrator& integrator() const noexcept { return *integrator_; }
  [[nodiscard]] hydraulics::CircuitIntegrator& integrator() noexcept { return *integrator_; }  // for tests and tools

 private:
  // Sample published at a step and the piston displacement before it, for late samples of the mechanics.
  struct SentSample {
    StepIndex step = -1;
    coupling::ActuatorSample sample;
    coupling::PortArray displacement;  // by port, the circuit's own piston in the step [m]
  };

  template <typename Self, typename Bytes>
  static void visit(Self& self, Bytes& bytes);
  void apply_levels() noexcept;
  [[nodiscard]] Status check_pressures(std::span<const double> F) const;
  [[nodiscard]] Status check_stability(const coupling::MechanismSample* mechanism);
  [[nodiscard]] Status check_coupling(const coupling::MechanismSample& mechanism) const;
  [[nodiscard]] std::optional<std::size_t> first_energy_alarm() const noexcept;
  void format_alarm_text(std::size_t port) noexcept;
  void take_tick(StepIndex n, std::span<const double> controls) noexcept;
  void extrapolate_signals() noexcept;
  void take_mechanism(StepIndex n, const coupling::MechanismSample& mechanism, StepIndex age,
                      StepReport& report) noexcept;
  void take_late_sample(StepIndex step, const coupling::MechanismSample& mechanism) noexcept;
  void keep_begin(StepIndex n) noexcept;
  void keep_end(StepIndex n) noexcept;
  void publish(coupling::ActuatorSample& sample, std::uint32_t flags, bool adds_up) noexcept;
  void list_variables();

  const scene::Scene& scene_;  // outlives the subsystem
  std::unique_ptr<hydraulics::Circuit> circuit_;
  std::unique_ptr<hydraulics::CircuitIntegrator> integrator_;
  std::size_t m_;
  coupling::PortLevels levels_;
  SimDuration H_;
  bool is_free_running_;
  bool ends_on_alarm_;  // ends the session when the coupling diverges
  StepIndex exchange_every_;
  coupling::OwnPast past_;           // free-running: position and speed by port
  std::vector<SentSample> history_;  // free-running: samples of the last steps
  StepIndex used_step_ = -1;         // step of the mechanics' sample in use
  StepIndex partner_age_ = 0;        // age of that sample in the last step
  std::vector<std::string> port_names_;
  std::vector<int> control_of_channel_;  // -1: the channel does not belong to this circuit
  coupling::Trends signal_trends_{0};    // trends of Circuit::flow_controls(), from tick to tick
  std::vector<double> signals_;          // saved signals while extrapolated ones replace them
  ReducedMechanics reduced_;
  coupling::Indicator indicator_;
  coupling::ParameterRamps ramps_{0};  // sized with the circuit
  std::vector<ElementVariable> variables_;
  coupling::ActuatorSample published_;
  coupling::PortArray stiffness_;  // N/m, oil columns, also for ports that publish none
  StepReport failure_;
  std::array<char, 512> failure_text_{};  // text of an alarm that ends the session; no allocation in a step
  std::size_t failure_text_length_ = 0;
  std::uint64_t saved_model_ = 0;  // digest of the model of saved states
};

[[nodiscard]] std::unique_ptr<coupling::Subsystem> make_hydraulics_subsystem(const scene::Scene& scene);

}  // namespace slew::hydraulic_node
