// SPDX-License-Identifier: Apache-2.0
// All physics of a scene as one undivided system of ordinary differential equations y' = f(t, y).
//
//   y = [ q | u | z | p of all volumes | component states | work and impulse of all ports ]          (1)
//   q' = multibody coordinate rates,   u' = u'_free + M^-1 J^T r                                     (2)
//   row of port i:   r_i = ratio_i F_line,i(F_i, x_i, v_i),   x_i = offset_i + ratio_i * row coordinate,
//                    F_i = p_A A_A - p_B A_B                                                         (3)
//   row of joint j:  r_j = friction and limits(q_j, u_j, z_j),  z_j' = bristle rate(u_j, z_j)        (4)
//   p', component states': the circuit's rates with the mechanism's x, v of every actuator           (5)
//   W_i' = F_i v_i,   S_i' = F_i                                                                     (6)
//   control(t) = control_0 + (t - t_0) slope                                                         (7)
//
// q and u hold the modes of flexible bodies and the coordinates between segments beside those of joints; z are bristles
// of joint friction, one a row, none in a scene without. Cut joints are closed by projecting q and u onto them before
// every evaluation (multibody/constraints/loops.h); close() removes the violation of y itself.
//
// The laws are the code of the split simulation: multibody dynamics, coupling::LineForceLaw (3), multibody::JointLaw
// (4), hydraulics::Circuit::rates (5). The only difference: no value is held, extrapolated or replaced by a reduced
// model. Not covered: contact.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/element_variable.h"
#include "core/status.h"
#include "coupling/line_force.h"
#include "coupling/port_levels.h"
#include "hydraulics/circuit.h"
#include "multibody/formulations/dynamics.h"
#include "multibody/results/observe.h"
#include "scene/scene.h"

namespace slew::monolith {

// One actuator at an instant.
struct PortState {
  double x = 0, v = 0;    // stroke [m], speed [m/s]
  double a = 0;           // m/s2
  double F = 0;           // pressure force [N]
  double line_force = 0;  // pressure force less friction plus end stop [N]
  double friction = 0;    // N
  double stop = 0;        // N
  double work = 0;        // integral of F v dt since the start [J]
  double impulse = 0;     // integral of F dt since the start [N s]
};

// Owner of a state: "joint Body_Pillar", "mode 2 of Boom", "volume Vol_LiftCyl_A", "component L90Lift".
struct StateOwner {
  enum class Kind : unsigned char { joint, mode, volume, component, port };
  Kind kind = Kind::joint;
  std::string name;
  bool operator==(const StateOwner&) const = default;
};

// Forces of cylinders, and of joints' friction and limits: from the state, or held.
enum class RowForces : unsigned char { follow, held };

class SceneEquations {
 public:
  // Pre-condition: a validated scene. Only read during construction.
  explicit SceneEquations(const scene::Scene& scene);

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::size_t port_count() const noexcept { return ports_.size(); }
  [[nodiscard]] const std::string& port_name(std::size_t port) const { return ports_[port].name; }
  // Scales of errors: y_i is significant down to about 1e-9 absolute_scale_i.
  [[nodiscard]] std::vector<double> absolute_scales() const;
  // Name of y_i, for messages.
  [[nodiscard]] std::string state_name(std::size_t index) const;

  [[nodiscard]] StateOwner owner(std::size_t index) const;
  // False for a fixed volume's pressure, a prescribed coordinate, work and impulse of a port, and rows without
  // bristles.
  [[nodiscard]] bool is_held(std::size_t index) const noexcept;

  // Takes the instant of a co-simulation of the same scene, with its live parameters: y without the work. circuit: null
  // if the scene has none; circuit_y: its state.
  void take(const multibody::Model& model, const multibody::State& state, const hydraulics::Circuit* circuit,
            std::span<const double> circuit_y, std::span<double> y);
  // Removes friction of cylinders, Coulomb friction and bristles of joints.
  void neglect_dry_friction();
  // Treatment of the rows' forces in rates(); held: those of the previous rates().
  void set_row_forces(RowForces forces) noexcept { row_forces_ = forces; }

  // Start state of the scene: mechanism in the scene's pose, circuit from the static forces that hold the ports.
  Status start(std::span<double> y);

  // Input channels over the time from t_0 on, (7); both by channel index.
  void set_controls(double t_0, std::span<const double> controls, std::span<const double> slopes);

  // End of the time for which rates() is called next [s]: jumps of prescribed accelerations there are left out.
  void set_until(double time) noexcept { workspace_.until = time; }

  // Error: no live parameter of that path, or a value out of range.
  Status set_parameter(std::string_view path, double value);
  // Present value, SI; none: no live parameter of that path.
  [[nodiscard]] std::optional<double> parameter(std::string_view path) const;

  // (2) to (6)
  void rates(double t, const double* y, double* f) noexcept;
  // Unit quaternions, as the multibody steps leave them.
  void normalize(std::span<double> y) const noexcept;
  // True if some joint is cut; and projection of y onto these joints, false if they cannot be closed.
  [[nodiscard]] bool has_loops() const noexcept { return model_.has_closing_rows(); }
  [[nodiscard]] bool close(double t, std::span<double> y) noexcept;

  // Everything below belongs to the last rates() or observe(). observe() ends an interval: volumes that cavitate in the
  // next one begin from there (hydraulics/vapour.h).
  void observe(double t, const double* y);
  [[nodiscard]] std::span<const PortState> ports() const noexcept { return port_states_; }
  [[nodiscard]] std::span<const ElementVariable> variables() const noexcept { return variables_; }
  void read_variables(std::span<double> values);
  // The pair whose shapes touch; empty without contact. The memory of contacts is not integrated here.
  [[nodiscard]] std::string touching_pair() const;
  [[nodiscard]] const multibody::Model& model() const noexcept { return model_; }
  [[nodiscard]] const multibody::State& mechanism_state() const noexcept { return state_; }
  [[nodiscard]] std::span<const double> circuit_state() const noexcept { return circuit_y_; }  // pistons included
  [[nodiscard]] std::span<const double> circuit_vapour() const noexcept {
    return circuit_ ? circuit_->vapour_capacities() : std::span<const double>{};
  }

 private:
  struct Port {
    std::string name;
    double offset, ratio;
    coupling::LineForceLaw law;
    coupling::PortUnit unit;
  };

  void take_state(double t, const double* y) noexcept;
  [[nodiscard]] double bristle_of(std::size_t row) const noexcept {
    return state_.bristles.empty() ? 0.0 : state_.bristles[row];
  }
  void take_controls(double t) noexcept;
  void evaluate_ports() noexcept;
  [[nodiscard]] Status find_static_forces(std::span<double> F, std::vector<double>& mobility);
  void list_variables();
  void take_heat(double t) noexcept;

  multibody::Model model_;
  multibody::State state_;
  multibody::Workspace workspace_;
  std::unique_ptr<hydraulics::Circuit> circuit_;  // null: none in the scene
  hydraulics::StartState start_ = hydraulics::StartState::equilibrium;
  std::vector<Port> ports_;
  coupling::PortLevels levels_;          // accepted, without effect
  std::vector<int> control_of_channel_;  // -1: the channel is not for this circuit
  std::vector<int> load_of_channel_;     // -1: it drives no point force or torque
  double control_time_ = 0;
  std::vector<double> control_, control_slope_;  // by channel
  // layout (1)
  std::size_t u_ = 0, z_ = 0, p_ = 0, component_ = 0, work_ = 0, impulse_ = 0, size_ = 0;
  bool is_closed_ = true;  // at the instant: the joints that are cut
  // at the instant
  std::vector<double> circuit_y_, circuit_rates_, F_;
  // of a circuit with temperatures: the last observed instant
  double observed_ = 0;
  std::vector<double> observed_y_;
  std::vector<double> row_force_;
  RowForces row_forces_ = RowForces::follow;
  std::vector<double> q_rate_, u_rate_;
  std::vector<PortState> port_states_;
  std::vector<ElementVariable> variables_;
  std::size_t model_variables_ = 0, reaction_variables_ = 0;
  std::vector<multibody::JointReaction> reactions_;  // by joint of the scene
};

}  // namespace slew::monolith
