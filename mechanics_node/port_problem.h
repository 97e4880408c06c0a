// SPDX-License-Identifier: Apache-2.0
// The mechanism's sub-step with the stiff forces of its rows: ports, and joints with friction or limits.
//
// Ports come first among the rows, in the scene's order, then the joints. Per sub-step:
//   rows x, v, a_free, W  ->  PortDynamics: mean and slope of every row's force  ->  one step of the mechanism.
// What a_free changes by during a sub-step is continued as over the sub-step before, unless an input, a parameter or a
// contact has changed since (coupling/trends.h); loads that follow a table are looked up ahead (timed_loads.h). A
// sub-step that meets a stop may be repeated in parts (stops.cpp). Rows that friction or a stop holds answer the modes
// and springs behind them in every stage of rk4 (hold_rows.cpp).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/step_report.h"
#include "coupling/port_dynamics.h"
#include "coupling/samples.h"
#include "coupling/trends.h"
#include "mechanics_node/mechanism.h"
#include "mechanics_node/partner_force.h"
#include "mechanics_node/row_force_laws.h"
#include "mechanics_node/row_mobility.h"
#include "mechanics_node/timed_loads.h"

namespace slew::mechanics_node {

class PortProblem final : private multibody::RowLawChange {
 public:
  // mechanism, partner and mobility outlive this. Allocates; nothing else does.
  PortProblem(const scene::Scene& scene, Mechanism& mechanism, PartnerForce& partner, RowMobility& mobility);
  PortProblem(const PortProblem&) = delete;
  PortProblem& operator=(const PortProblem&) = delete;
  // After the mechanism's reset().
  void reset() noexcept;

  [[nodiscard]] const std::vector<Port>& ports() const noexcept { return ports_; }
  // Pressure forces of a start or of a step that was computed elsewhere, by port [N].
  void set_forces(std::span<const double> F) noexcept;
  // An input, a parameter or the state has changed: no trend of a_free is continued.
  void forget_trends() noexcept { a_free_trends_.clear(); }

  // The sub-steps of a step share this.
  struct Step {
    StepIndex n;
    const coupling::ActuatorSample* partner;  // null: no hydraulics
    coupling::MechanismSample& sample;        // receives work and impulse
    StepReport& report;
  };
  // Advances the mechanism by h [s] to an evaluated state, or in parts where a sub-step strays in a stop.
  void take_substep(const Step& step, double h, bool is_first) noexcept { take_substep(step, h, is_first, 0); }

  // ---- published quantities of the evaluated instant

  [[nodiscard]] coupling::PortArray strokes() const noexcept;
  void publish_motion(coupling::MechanismSample& sample) const noexcept;
  // Line forces and accelerations, from the sample's motion and mobility; row_force: of the ports, on the rows' own
  // coordinates.
  void publish_line_forces(coupling::MechanismSample& sample, std::span<double> row_force) noexcept;

  // ---- saved state, in two parts (saved_mechanics.cpp)

  // with_partner_copy: the copies of the partner's forces outlast an exchange.
  void add_to(StateHash& hash, bool with_partner_copy) const noexcept;
  template <typename Self, typename Bytes>
  static void visit_trends(Self& self, Bytes& bytes) {
    if constexpr (Bytes::kIsReading) {
      self.a_free_trends_.load(bytes);
    } else {
      self.a_free_trends_.save(bytes);
    }
  }
  template <typename Self, typename Bytes>
  static void visit_rows(Self& self, Bytes& bytes) {
    for (auto& port : self.ports_) {
      for (auto* x : {&port.z, &port.F, &port.friction, &port.stop}) bytes.number(*x);
    }
    for (std::size_t row = 0; row < self.mechanism_.row_count(); ++row) {
      bool is_active = self.mechanism_.is_row_active(row);
      bytes.flag(is_active);
      if constexpr (Bytes::kIsReading) self.mechanism_.set_row_active(row, is_active);
    }
  }

 private:
  [[nodiscard]] bool is_port(std::size_t row) const noexcept { return row < ports_.size(); }
  [[nodiscard]] double ratio_of(std::size_t row) const noexcept { return is_port(row) ? ports_[row].ratio : 1.0; }
  // Coordinate of the row's law: the stroke of a port, the coordinate of a joint.
  [[nodiscard]] double position_of(std::size_t row) const noexcept {
    return (is_port(row) ? ports_[row].offset : 0) + ratio_of(row) * mechanism_.workspace().row_x[row];
  }

  // port_problem.cpp: one sub-step
  void select_rows(double h) noexcept;
  void load_rows(double h) noexcept;
  void load_partner(const coupling::ActuatorSample* partner, bool is_first_substep) noexcept;
  void take_row_forces() noexcept;
  [[nodiscard]] bool damps_within(double delta) noexcept;
  [[nodiscard]] coupling::PortStep advance(const Step& step, double h, bool is_first_substep) noexcept;
  void finish_substep(const Step& step) noexcept;

  // hold_rows.cpp: laws that hold their rows within a sub-step of rk4
  [[nodiscard]] coupling::RowForce law_at_end(std::size_t k, double speed_change) const noexcept;
  [[nodiscard]] double change(std::size_t row, double speed_change) const noexcept override;
  [[nodiscard]] double slope_over_substep(std::size_t k, double force) const noexcept;
  [[nodiscard]] bool find_slopes(double h) noexcept;
  [[nodiscard]] bool find_gain(double h) noexcept;
  [[nodiscard]] multibody::RowHold* hold_rows(double h) noexcept;

  // stops.cpp: repetition in parts; depth: number of divisions so far
  void take_substep(const Step& step, double h, bool is_first, std::size_t depth) noexcept;
  void restore_start(std::size_t depth) noexcept;
  [[nodiscard]] bool may_meet_stop(double h) const noexcept;
  [[nodiscard]] bool misses_limit() const noexcept;
  [[nodiscard]] double net_acceleration(std::size_t k, double h) noexcept;
  [[nodiscard]] bool strays_in_stop(double h) noexcept;
  // Static force of a row's stop with the row's law at x.
  struct Stop {
    double force = 0, stiffness = 0;  // N, N/m
  };
  [[nodiscard]] Stop stop_at(std::size_t row, double x) const noexcept;

  Mechanism& mechanism_;
  PartnerForce& partner_;
  RowMobility& mobility_;
  std::vector<Port> ports_;
  std::vector<std::size_t> active_;  // rows of the port problem, ascending
  coupling::Trends a_free_trends_;   // by row, from sub-step to sub-step
  TimedLoads timed_loads_;
  RowForceLaws laws_;
  coupling::PortDynamics dynamics_;
  std::vector<double> force_mean_, force_slope_;  // by row, for the mechanism's step
  std::vector<Mechanism::Snapshot> starts_;       // of sub-steps near a stop, by depth; empty: no row has a stop
  std::vector<double> v_begin_, z_begin_;         // by row of the port problem
  multibody::RowHold hold_;
  std::vector<double> held_matrix_;                                   // by row and row
  std::vector<std::size_t> place_;                                    // in the port problem, by row
  std::vector<double> held_force_, dynamics_end_x_, dynamics_end_v_;  // at its end, by row of the port problem
};

}  // namespace slew::mechanics_node
