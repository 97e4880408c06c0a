// SPDX-License-Identifier: Apache-2.0
// A hydraulic circuit as a system of ordinary differential equations.
//
//   y = [u of all volumes | x | v of all actuators | component states]
//   u_i' = sum Q_i / C_i,   C_i = sum_k V_k (kappa_oil(p_i) + 1/B_k(p_i))          free volumes          (1)
//   u_i' = 0                                                                       fixed volumes         (2)
//   x' = v;  v' = 0 here: the owner adds the pistons' accelerations                                      (3)
// u is the pressure p; in a cavitating volume it measures the vapour (vapour.h), and C_i is constant there.
// V_k: hoses, rigid blocks, and chambers V_0 +- A x; kappa_oil in oil.h, wall moduli B_k by their component.
// Sources: the flexible-body tutorial thesis (Saimaa UAS 2017), eq. 22 to 27 (lumped fluid theory). Not covered:
// inertia of the oil, wave travel. Temperatures are constant within a communication step (oil_heat.h).
//
// Built once from a validated Def; afterwards only control signals, line forces for display and live parameters change.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/element_variable.h"
#include "core/state_bytes.h"
#include "core/state_hash.h"
#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/hydraulics_def.h"
#include "hydraulics/line_chambers.h"
#include "hydraulics/oil.h"
#include "hydraulics/oil_heat.h"
#include "hydraulics/start_pressures.h"
#include "hydraulics/vapour.h"
#include "math/stiff_system.h"

namespace slew::hydraulics {

// A number that may change while the circuit runs.
struct LiveParameter {
  std::string path;  // "L90Lift.overlap"
  const Field* field = nullptr;
  double* value = nullptr;
  std::size_t component = 0;
};

// Demand of an equilibrium start beyond the limit of a volume.
struct StartDemand {
  int volume = 0, actuator = 0;  // the volume and the actuator with the demand
  double pressure = 0;           // Pa absolute
  double limit = 0;              // Pa absolute: highest pressure that the volume can hold
  std::string_view valve;        // valve that opens above the limit; empty: none
};

// Limit assumed for a volume without a relief or shock valve of its own: hoses and cylinders burst.
inline constexpr double kMostHeld = 1000e5;  // Pa absolute

// A piston may be pressed out of its barrel by this share of its way: stops are springs. Beyond, the machine is not
// that of the scene.
inline constexpr double kMostBeyondBarrel = 0.1;

enum class ParameterResult { ok, unknown, out_of_range };

class Circuit {
 public:
  // def: validate() found no error. Only read during construction.
  explicit Circuit(const HydraulicsDef& def);
  Circuit(const Circuit&) = delete;
  Circuit& operator=(const Circuit&) = delete;

  // layout of y
  [[nodiscard]] int state_count() const noexcept { return size_; }
  [[nodiscard]] int volume_count() const noexcept { return static_cast<int>(volume_name_.size()); }
  [[nodiscard]] int actuator_count() const noexcept { return static_cast<int>(actuators_.size()); }
  [[nodiscard]] StateIndex position(int actuator) const noexcept { return volume_count() + actuator; }
  [[nodiscard]] StateIndex speed(int actuator) const noexcept { return volume_count() + actuator_count() + actuator; }
  [[nodiscard]] StateIndex first_component_state() const noexcept { return volume_count() + 2 * actuator_count(); }
  [[nodiscard]] std::span<const Actuator> actuators() const noexcept { return actuators_; }
  [[nodiscard]] std::span<const Relief> reliefs() const noexcept { return reliefs_; }
  [[nodiscard]] const std::string& volume_name(int volume) const {
    return volume_name_[static_cast<std::size_t>(volume)];
  }
  // Component that a state belongs to, counted from first_component_state() on.
  [[nodiscard]] const std::string& state_owner(int state) const {
    return state_owner_[static_cast<std::size_t>(state)];
  }
  [[nodiscard]] bool is_fixed(int volume) const noexcept { return is_fixed_[static_cast<std::size_t>(volume)] != 0; }
  [[nodiscard]] int find_volume(std::string_view name) const noexcept;                 // -1: none
  [[nodiscard]] const std::vector<double>& scales() const noexcept { return scale_; }  // typical sizes of y
  // 1, or 0 for positions; below zero 0 for volumes too: the size of a tension does not scale its error
  [[nodiscard]] const std::vector<double>& relatives() const noexcept { return relative_; }
  [[nodiscard]] const std::vector<double>& relatives_below_zero() const noexcept { return relative_below_zero_; }
  // non-zero entries of jacobian()
  [[nodiscard]] const math::SparsityPattern& pattern() const noexcept { return pattern_; }
  [[nodiscard]] double pressure_floor() const noexcept { return floor_; }  // Pa absolute; below, the oil cavitates
  [[nodiscard]] double near_floor() const noexcept {
    return near_floor_;
  }  // Pa absolute; below it oil with air is soft
  [[nodiscard]] double lowest_pressure() const noexcept { return oil_.lowest_pressure(); }

  // start states [y without x and v; the caller sets those, x before: areas of stages follow it]
  // Equilibrium: the pressures hold F (start_pressures.h), W is the mobility of the actuators' coordinates, empty
  // where each has its own. Components with states of their own begin at rest under these pressures.
  void start_in_equilibrium(std::span<const double> F, std::span<double> y, std::span<const double> W = {}) const;
  // Part of F that the pressures of common volumes cannot hold, by actuator [N or Nm]. Allocates.
  [[nodiscard]] std::vector<double> unheld_at_start(std::span<const double> F, std::span<const double> W,
                                                    std::span<const double> x = {}) const;
  // The volume whose start pressure exceeds its limit most: above the pressure at which its relief and shock valves are
  // fully open, above kMostHeld without any, or below zero. None: all hold.
  [[nodiscard]] std::optional<StartDemand> demand_beyond_limits(std::span<const double> F,
                                                                std::span<const double> W = {},
                                                                std::span<const double> x = {}) const;
  void start_at_initial_pressures(std::span<double> y) const;
  // The start that the Def selects.
  void start(std::span<const double> F, std::span<double> y, std::span<const double> W = {}) const;

  // inputs
  [[nodiscard]] int find_control(std::string_view component) const noexcept;  // -1: none
  [[nodiscard]] std::span<const std::string> controls() const noexcept { return control_name_; }
  [[nodiscard]] std::span<const double> control_signals() const noexcept { return control_; }
  // Controls that act on flows at once, without a state such as a spool.
  [[nodiscard]] std::span<const int> flow_controls() const noexcept { return flow_controls_; }
  void set_control(int control, double signal) noexcept { control_[static_cast<std::size_t>(control)] = signal; }
  void set_line_force(int actuator, double F) noexcept { line_force_[static_cast<std::size_t>(actuator)] = F; }

  // live parameters; no allocation
  [[nodiscard]] std::span<const LiveParameter> parameters() const noexcept { return parameters_; }
  [[nodiscard]] int find_parameter(std::string_view path) const noexcept;                               // -1: none
  [[nodiscard]] std::span<const double> parameter_values() const noexcept { return parameter_value_; }  // same order
  ParameterResult set_parameter(int index, double value) noexcept;

  // equations (1) to (3)
  void rates(const double* y, double* f) noexcept;
  // One component's part of rates(), added to f, and of jacobian(), for measurements of cost. Pre-condition: rates()
  // was called at this y.
  void add_rates_of(std::size_t component, const double* y, double* f) noexcept;
  void add_slopes_of(std::size_t component, const double* y) noexcept;
  // Jacobian of rates() at y, with f = rates(y); row-major, stride state_count(); valid until the next call.
  double* jacobian(const double* y, const double* f) noexcept;
  // Both at once, the same bits for two thirds of the cost.
  double* linearise(const double* y, double* f) noexcept;
  void pressure_forces(const double* y, double* F) const noexcept;
  // Stiffness of the actuator's brake while it holds [N/m or Nm/rad]; 0 without one.
  [[nodiscard]] double brake_stiffness(int actuator, const double* y) noexcept;

  // Absolute pressure of a volume and its slope over the state: 1, less while it cavitates.
  [[nodiscard]] ValueSlope pressure(int volume, const double* y) const noexcept {
    return vapour_.pressure(static_cast<std::size_t>(volume), y[volume]);
  }
  [[nodiscard]] ValueSlope pressure_at(int volume, double u) const noexcept {
    return vapour_.pressure(static_cast<std::size_t>(volume), u);
  }
  // Remembers the capacities at the floor of the volumes that are not below it, (3) of vapour.h; at the end of every
  // sub-step.
  void follow_vapour(const double* y) noexcept;
  // Balance of a sub-step of h seconds from y_before to y, (4) of vapour.h: the first volume that enters the vapour
  // further than the flow at its end can have taken it, -1: none.
  [[nodiscard]] int emptied_without_outflow(double h, const double* y_before, const double* y) noexcept;
  // Oil of an Euler sub-step, (6) of vapour.h: the first volume where it is off by more than `share` of the size of its
  // pressure, and the largest share.
  [[nodiscard]] math::StiffSystem::Unbalanced unbalanced_volume(double share, const double* y_before,
                                                                const double* y) const noexcept;
  // (7) of vapour.h, for volumes that may cavitate: w over u, and u over w.
  [[nodiscard]] bool may_cavitate(std::size_t volume) const noexcept { return vapour_.begins_below[volume] > 0; }
  [[nodiscard]] OilMeasure oil_measure(std::size_t volume, double u) const noexcept;
  [[nodiscard]] double state_of_oil(std::size_t volume, double w) const noexcept;
  // (8) of vapour.h: these volumes, and how many.
  [[nodiscard]] std::size_t soft_volumes(const double* y, std::span<std::size_t> volumes) const noexcept;
  // The first volume whose room without oil is larger than the volume itself, -1: none.
  [[nodiscard]] int first_overdrawn(const double* y) const noexcept;
  [[nodiscard]] std::span<const double> vapour_capacities() const noexcept { return vapour_.capacity; }
  void set_vapour_capacities(std::span<const double> C) noexcept;
  void save_vapour(StateWriter& bytes, const double* y) const;
  void load_vapour(StateReader& bytes, const double* y) noexcept;
  void add_vapour_to(StateHash& hash, const double* y) const noexcept;  // capacities of the volumes that cavitate at y
  // False for a quasi-static volume, which has no storage.
  void take_up_vapour(int volume, bool does) noexcept;

  // Capacities C_i [m3/Pa] over the state; 0 for fixed volumes.
  void capacities(const double* y, double* C) const noexcept;
  // That of a volume that is not fixed.
  [[nodiscard]] double capacity_at(std::size_t volume, const double* y) const noexcept;
  // d ln C / dp of a volume that is not fixed [1/Pa]
  [[nodiscard]] double capacity_growth(int volume, const double* y) const noexcept;
  // Slopes -dQ/dp of each volume at y, on the steeper side of switches.
  void outflow_slopes(const double* y, double* slope) noexcept;
  // rates(), outflow_slopes() and capacities() at once.
  void rates_and_outflow(const double* y, double* f, double* slope, double* C) noexcept;
  // Slope of a volume's flow, or of a component state's rate, over the pressure of a volume or the state of a
  // component: from the last rates_and_outflow(), on the steeper side of switches, unless jacobian(), linearise() or
  // outflow_slopes() was called since.
  [[nodiscard]] double flow_slope(std::size_t row, std::size_t column) const noexcept {
    return jacobian_[row * static_cast<std::size_t>(size_) + column];
  }
  // Corrects the states of volumes at y from their oil balance if only pistons and lines changed them since y_before
  // (rates f_before): where air makes the oil soft, a small error of the pressure is a large error of the oil. Near the
  // floor only. pressures: int p dt over the sub-step of h seconds by line [Pa s], which gives the oil taken by the
  // line.
  void keep_closed_oil(double h, const double* y_before, const double* f_before, double* y,
                       std::span<const double> pressures) noexcept;
  // Moves the pistons to x_new and lets each pressure follow its chamber's change of volume, no oil lost:
  // C du + A dx = 0, integrated over the displacement. False if a wave of a line was held at the lowest pressure.
  bool move_pistons(double* y, const double* x_new) noexcept;

  // Converts the chambers of an actuator to transmission lines (line_chambers.h), and back; the oil is kept. delay [s]
  // is the communication step, constant until they are lumped again. Meanwhile the volumes' pressures are those at the
  // lines' ends, and moving the pistons makes the lines consistent.
  void make_line(int actuator, double delay, const double* y) noexcept;
  void lump_line(int actuator, double* y) noexcept;
  [[nodiscard]] bool is_line(int actuator) const noexcept;
  // Ends a communication step; mean_pressure [Pa] of the volumes over it, by line.
  void end_line_step(const double* y, std::span<const double> mean_pressure) noexcept;
  // The volume whose line hardened in that step beyond what its waves can follow: air or vapour closed within it, and
  // the pressure is that of the step, not of the machine. -1: none.
  [[nodiscard]] int beyond_waves() const noexcept { return beyond_waves_; }
  // Force of the lines on the piston in the next step, at rest.
  [[nodiscard]] LineThrust line_thrust(int actuator, const double* y) const noexcept;
  [[nodiscard]] double line_capacity(const LineChamber& line, double p, double x) const noexcept;
  // Two chambers per actuator, A then B, lines or not.
  [[nodiscard]] std::span<const LineChamber> lines() const noexcept { return lines_; }
  [[nodiscard]] std::span<LineChamber> mutable_lines() noexcept { return lines_; }  // for tests
  void add_lines_to(StateHash& hash) const noexcept;

  // Temperatures of the volumes (oil_heat.h); everything else below needs has_temperatures(). start: all volumes at the
  // start temperature. A communication step of H seconds from y on: begin, add after each sub-step of h seconds, end.
  [[nodiscard]] bool has_temperatures() const noexcept { return heat_ != nullptr; }
  void start_heat(const double* y) noexcept;
  void set_temperatures(std::span<const double> T, const double* y) noexcept;
  void begin_heat(const double* y) noexcept;
  void add_heat(double h, const double* y) noexcept;
  void end_heat(double H, const double* y) noexcept;
  // Friction of an actuator against its speed, held over the coming step [N or Nm].
  void set_friction(int actuator, double F) noexcept { heat_->friction[static_cast<std::size_t>(actuator)] = F; }
  [[nodiscard]] std::span<const double> temperatures() const noexcept { return heat_->T; }  // K, by volume
  void save_heat(StateWriter& bytes) const;
  void load_heat(StateReader& bytes, const double* y) noexcept;
  void add_heat_to(StateHash& hash) const noexcept;

  // All state beside y: live parameters, signals, line forces and load-sensing pressures for display, lines.
  void save(StateWriter& bytes) const;
  void load(StateReader& bytes) noexcept;

  // Holds the pressures of volumes without vapour at or above the lowest pressure; true if one was changed.
  bool bound(double* y) const noexcept;

  // StepFlag bits that hold at y: cavitating, relief_open, limit_hit (a piston in its stop), clamp_active (a chamber
  // pressed shut); and the first volume that cavitates, or else a state of a line that does (-1: none).
  [[nodiscard]] std::uint32_t flags(const double* y) noexcept;
  [[nodiscard]] int first_cavitating(const double* y) noexcept;
  // The volume with the highest pressure beyond the oil's law, else one with a temperature beyond it; -1: none.
  [[nodiscard]] int farthest_beyond_oil_law(const double* y) const noexcept;

  // The actuator whose piston is out of its barrel by more than kMostBeyondBarrel; -1: none.
  [[nodiscard]] int first_out_of_barrel(const double* y) const noexcept;

  // variables of all volumes and components, in a fixed order
  [[nodiscard]] std::span<const ElementVariable> variables() const noexcept { return variables_; }
  void read_variables(const double* y, std::span<double> values) noexcept;

 private:
  template <typename Self, typename Bytes>
  static void visit(Self& self, Bytes& bytes);

  struct Capacity {
    double value, d_pressure, oil;
  };

  // A content whose volume or wall changes, with its constant parts precomputed.
  struct Piece : Content {
    double lumped = 1;  // share of the volume; the rest is a transmission line
    bool has_constant_wall = true;
    double wall_compressibility = 0;  // 1/Pa, when constant

    [[nodiscard]] bool is_closed(const double* y) const noexcept { return unbound_content(y[position]) <= smallest; }
    [[nodiscard]] double content_at(const double* y) const noexcept {
      if (position < 0) return volume;
      const double V = unbound_content(y[position]);
      return V > smallest ? V : smallest;
    }
    [[nodiscard]] double unbound_content(double x) const noexcept {
      return stages == nullptr ? volume + slope * x : volume + stages->content_at(x);
    }
    // dV/dx
    [[nodiscard]] double growth_at(const double* y) const noexcept {
      return stages == nullptr ? slope : stages->area_at(y[position]).value;
    }
    // Oil that a displacement from y takes in: of stages by the contents at both ends.
    [[nodiscard]] double swept(const double* y, double dx) const noexcept {
      if (stages == nullptr) return sweep_at(y) * dx;
      return stages->content_at(y[position] + dx) - stages->content_at(y[position]);
    }
    [[nodiscard]] ValueSlope wall_at(double p) const noexcept {
      return has_constant_wall ? ValueSlope{wall_compressibility, 0} : elastic_wall_at(p);
    }
    [[nodiscard]] ValueSlope elastic_wall_at(double p) const noexcept;
    [[nodiscard]] double wall_growth(double p) const noexcept;  // int_0^p 1/B dp
  };
  // All contents of a volume: constant ones summed, the others one by one.
  struct VolumeContent {
    double volume = 0;               // m3
    double wall = 0;                 // m3/Pa, sum of volume x wall compressibility
    double nominal = 0;              // m3, oil that scales the row of a quasi-static volume without content
    std::size_t begin = 0, end = 0;  // in pieces_
  };

  struct Equilibrium {
    std::vector<double> held_by_brakes;  // N or Nm, by actuator
    StartPressures start;
  };
  // y: initial pressures, supply at the pump pressure.
  [[nodiscard]] Equilibrium equilibrium(std::span<const double> F, std::span<const double> W,
                                        std::span<double> y) const;
  // Forces of the brakes at an equilibrium start; y has the start pressures.
  [[nodiscard]] std::vector<double> held_by_brakes(std::span<const double> F, const double* y) const;
  void start_supply(std::span<double> y) const;
  void move_brakes(double* y) noexcept;
  void start_components(std::span<double> y) const;
  void add_contents(const CircuitBuilder& builder);
  void order_ls_sources(const CircuitBuilder& builder);
  void evaluate_heat(const double* y, std::vector<HeatFlow>& now, std::vector<double>& contents) noexcept;
  void follow_temperatures(const double* y) noexcept;
  [[nodiscard]] int first_beyond_temperatures() const noexcept;
  void declare_pattern();
  void make_heat(const HydraulicsDef& def);
  void list_variables();
  void list_parameters();
  void evaluate_ls(const CircuitView& now) noexcept;
  // y with pressures in place of u for cavitating volumes; y itself without cavitation.
  [[nodiscard]] const double* physical(const double* y) noexcept;
  [[nodiscard]] CircuitView view(const double* y) noexcept {
    return {physical(y), control_.data(), ls_.data(), line_force_.data()};
  }
  [[nodiscard]] Capacity capacity(std::size_t volume, const double* y) const noexcept;
  // Oil in a volume [m3]; with vapour its room.
  [[nodiscard]] double content_at(std::size_t volume, const double* y) const noexcept;
  [[nodiscard]] double capacity_of_lines(std::size_t volume, double p, const double* y) const noexcept;
  void stamp_flows(const double* y) noexcept;
  void evaluate_flows(const double* y, double* f) noexcept;
  void add_line_flows(const double* y, Rates& sums) const noexcept;
  void stamp_lines() noexcept;
  void to_pressure_rates(std::size_t volume, const Capacity& C, double rate, const double* y) noexcept;
  void read_outflow(const double* y, double* slope) noexcept;
  void chamber_rates(const double* y, double* dp) const noexcept;
  [[nodiscard]] double chamber_growth(std::size_t volume, const double* y) const noexcept;
  [[nodiscard]] double capacity_at_floor(std::size_t volume, const double* y) const noexcept;
  // Oil and walls of the contents that no piston changes; one unit of oil where there is none.
  struct RigidContent {
    double volume, walls, most_walls;  // m3; m3/Pa: constant walls, and with the elastic ones at their softest
    double at_reference = 0;           // m3/Pa, C_r(p_r) of (7)
  };
  void list_rigid_contents();
  [[nodiscard]] double soft_below(std::size_t volume) const noexcept;  // Pa, limit of (8); -infinity: none
  [[nodiscard]] bool has_line(std::size_t volume) const noexcept;
  // int_pf^p C_r dp [m3] with its derivatives; pre-condition: p >= floor
  [[nodiscard]] OilMeasure rigid_oil(std::size_t volume, double p) const noexcept;
  void move_through_floor(std::size_t volume, double dV, double share, double* y) noexcept;
  void to_state_slopes(const double* y) noexcept;
  [[nodiscard]] bool is_closed(std::size_t volume, const double* y, const double* f) const noexcept;
  [[nodiscard]] double intake_of_lines(std::size_t volume, double h, std::span<const double> pressures) const noexcept;
  [[nodiscard]] double moved_alone(std::size_t volume, double dV, const double* y_start) noexcept;
  bool move_lines(const double* x_new) noexcept;
  void fill(LineChamber& line, double oil, double dx) const noexcept;
  [[nodiscard]] double missed_pressure(const LineChamber& line, double c_m, const double* y) const noexcept;
  [[nodiscard]] double line_volume(const LineChamber& line, double x) const noexcept;
  [[nodiscard]] double line_content(const LineChamber& line, double p) const noexcept;
  [[nodiscard]] double line_pressure(const LineChamber& line, double content, double p, double error) const noexcept;
  [[nodiscard]] double pressure_by_parts(const LineChamber& line, double oil, double dx) const noexcept;
  [[nodiscard]] double volume_content(std::size_t volume, double p, const double* y) const noexcept;
  [[nodiscard]] std::span<LineChamber> lines_of(int actuator) noexcept {
    return std::span(lines_).subspan(2 * static_cast<std::size_t>(actuator), 2);
  }
  [[nodiscard]] std::span<const LineChamber> lines_of(int actuator) const noexcept {
    return std::span(lines_).subspan(2 * static_cast<std::size_t>(actuator), 2);
  }

  int size_ = 0;
  OilCompressibility oil_;
  double floor_, kappa_at_floor_, near_floor_;  // Pa, 1/Pa, Pa
  double content_at_floor_;                     // content() of the oil there
  Vapour vapour_;
  std::vector<std::string> volume_name_;
  std::vector<char> is_fixed_;
  std::vector<double> initial_pressure_;
  std::vector<StateIndex> supply_;
  std::vector<int> joined_;  // by volume: start_volumes.h
  std::vector<Relief> reliefs_;
  StartState start_;
  double start_return_, start_slew_, start_pump_;

  std::vector<Piece> pieces_;  // pieces, by volume
  std::vector<VolumeContent> volumes_;
  std::vector<RigidContent> rigid_;         // by volume
  std::vector<double> soft_below_;          // Pa, one per volume
  std::vector<std::size_t> with_chambers_;  // volumes that pistons change
  std::vector<LineChamber> lines_;          // two by actuator
  int beyond_waves_ = -1;
  std::vector<Actuator> actuators_;
  std::vector<ComponentState> states_;
  std::vector<std::string> state_owner_;
  std::vector<double> scale_, relative_, relative_below_zero_;

  std::vector<std::unique_ptr<HydraulicComponent>> components_;
  std::vector<HydraulicComponent*> active_;        // with equations
  std::vector<const HydraulicComponent*> braked_;  // by actuator: its component if it has a brake, else null
  struct LsSource {
    HydraulicComponent* component;
    LsIndex index;
  };
  std::vector<LsSource> ls_order_;
  math::SparsityPattern pattern_{0};
  std::unique_ptr<OilHeat> heat_;  // null: the oil has one temperature

  std::vector<double> control_;
  std::vector<std::string> control_name_;
  std::vector<int> flow_controls_;
  std::vector<double> line_force_;
  std::vector<ElementVariable> variables_;
  std::vector<LiveParameter> parameters_;
  std::vector<double> parameter_value_;

  // work space
  std::vector<double> ls_, jacobian_, moved_, displacement_, growth_, physical_, kept_, kept_rates_;
  std::array<std::vector<double>, 4> slope_;  // stages of move_pistons()
};

}  // namespace slew::hydraulics
