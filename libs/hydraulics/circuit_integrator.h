// SPDX-License-Identifier: Apache-2.0
// Advances a circuit and its pistons over communication steps, and provides the partner's linearisation.
//
// Within a step the circuit's equations and the pistons' motion (PistonMotion) are one system for the solver that the
// Def chooses (math/rodas3.h, runge_kutta4.h, implicit_euler.h, cvode_stepper.h):
//   y' = rates(y),  x' = v,  v' = a(F, x, v),  F = e (p_A A_A - p_B A_B) + F_b
// e is the setting of a variable motor, 1 of all others; F_b the force of a brake (circuit_builder.h), 0 without one.
// State of a volume is its pressure, below the cavitation floor its vapour (vapour.h).
// The row of a quasi-static volume is algebraic, 0 = sum Q; its pressure is solved for at the start and again at the
// start of every step, so that a jump of an input finds it consistent.
// Work and impulse of each actuator are integrated beside it with the cubic through both ends of a sub-step:
//   int g dt = h/2 (g_0 + g_1) + h^2/12 (g_0' - g_1')                                                           (1)
// for g = F (impulse) and, about the sub-step's mean force F_m = (F_0 + F_1)/2,
//   work = F_m (x_1 - x_0) + int (F - F_m) v dt,  the integral by (1):
// the errors of v then produce no work at a piston that rests under load.
//
// Published at the end (coupling study, section 8; K_A = (e A_A)^2/C_A, K_B = (e A_B)^2/C_B, K_b of a brake that
// holds):
//   F, F_dot = F',  K = K_A + K_B + K_b,  lambda = (K_A l_A + K_B l_B)/K,  l = -(dQ/dp)/C                        (2)
// l on the steeper side of unilateral valves. The springs of (2) are there one by one, too: over a step
// their sums do not stand for them (math/relaxing_spring.h), nor do they themselves where the circuit around the
// chambers takes part (step_response.h). Chambers have no feed-through, D = 0; where they are
// transmission lines (line_chambers.h) F is the force of the lines at v, D their impedance, K = F_dot = lambda = 0. The
// mean pressure of a volume, and with it the oil that the line takes, is integrated by the method itself: the oil that
// leaves the volume enters the line at any tolerance.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/state_bytes.h"
#include "core/state_hash.h"
#include "core/step_report.h"
#include "hydraulics/circuit.h"
#include "hydraulics/foreseen_interval.h"
#include "hydraulics/piston_motion.h"
#include "hydraulics/step_response.h"
#include "math/dense_lu.h"
#include "math/rodas3.h"
#include "math/stiff_system.h"

namespace slew::hydraulics {

// One actuator's force near (x, v), and its work and impulse in the last step.
struct ActuatorLinearisation {
  double F = 0;          // N
  double F_dot = 0;      // N/s at constant v
  double K = 0;          // N/m; 0 for lines
  double D = 0;          // N s/m
  double stiffness = 0;  // N/m, K of the oil columns, also for lines
  double lambda = 0;     // 1/s
  // F_dot, K and lambda are their sums and weighted mean. Zero for lines
  ActuatorSprings springs;
  double empty_a = 0, empty_b = 0;  // N, change of the chamber's force at which its oil is at the pressure floor
  double x = 0;                     // m, the circuit's own piston position
  double v = 0;                     // m/s
  double work = 0;                  // J, integral of F v dt over the last step
  double impulse = 0;               // N s
  double p_a = 0, p_b = 0;          // Pa absolute
  double Q_a = 0, Q_b = 0;          // m3/s, flows of the circuit into the chambers' volumes
};

// An explicit solver's sub-step relative to its stability limit at a state.
struct ExplicitStability {
  double ratio = 0;       // h |lambda|_max / 2; above 1 the solver is unstable
  double substep = 0;     // h [s]
  StateIndex owner = -1;  // the state with the largest part in the fastest motion
};

class CircuitIntegrator final : private math::StiffSystem {
 public:
  // circuit outlives the integrator. def: validated.
  CircuitIntegrator(Circuit& circuit, const HydraulicsDef& def);

  // Start state as the Def selects; F: static forces of the actuators [N]; W: as Circuit::start_in_equilibrium().
  // Clears the step size and failures.
  void start(std::span<const double> x, std::span<const double> v, std::span<const double> F,
             std::span<const double> W = {}) noexcept;

  // Stability of rk4 at the present state, for steps of H seconds; all zero for the other solvers, which have no limit.
  [[nodiscard]] ExplicitStability explicit_stability(double H, const PistonMotion& motion);
  // Turns chambers into transmission lines with the delay H, or back into volumes; the oil is kept. Between two steps,
  // after align().
  void set_line(int actuator, bool is_line, double H) noexcept;

  // Takes the pistons' true position and speed: pressures follow with the oil enclosed (study, section 8).
  void align(std::span<const double> x, std::span<const double> v) noexcept;

  // Advances by H seconds. A failure is latched: the state before the step stays, and every further report has its
  // flag: non_finite, or ended when no sub-step balances the oil of a volume. A volume with more room without oil than
  // it has room is not_converged. offender: StateIndex of the state that failed, ran out of budget or of stability
  // (not_converged), of the volume farthest beyond the oil's law, or of the first volume that cavitates.
  StepReport step(double H, const PistonMotion& motion) noexcept;

  // Foresees the H seconds from the present state on under the present control signals, and goes back to that state.
  // False: not computed within the budget of sub-steps. No allocation.
  [[nodiscard]] bool foresee(double H, const PistonMotion& motion, ForeseenInterval& interval) noexcept;

  [[nodiscard]] std::span<const ActuatorLinearisation> actuators() const noexcept { return published_; }
  // Changes the springs of actuators() to those over H seconds, as StepResponse::take_part().
  [[nodiscard]] bool take_part(double H, std::span<ActuatorSprings> springs) noexcept {
    return response_.take_part(y_.data(), outflow_, C_, f_, H, springs);
  }
  [[nodiscard]] const StepResponse& response() const noexcept { return response_; }
  [[nodiscard]] std::span<const double> state() const noexcept { return y_; }
  [[nodiscard]] std::span<const double> rates() const noexcept { return f_; }       // y' at actuators()
  [[nodiscard]] std::span<const double> capacities() const noexcept { return C_; }  // m3/Pa, 0 for fixed volumes
  // Mutable state for tests and tools; call refresh() afterwards.
  [[nodiscard]] std::span<double> mutable_state() noexcept { return y_; }
  [[nodiscard]] std::span<LineChamber> mutable_lines() noexcept { return circuit_.mutable_lines(); }
  // Computes actuators() from the state.
  void refresh() noexcept;
  // Computes F_dot alone, under the present control signals.
  void refresh_force_rates() noexcept;
  [[nodiscard]] double step_size() const noexcept { return solver_->step_size(); }
  void set_step_size(double h) noexcept { solver_->set_step_size(h); }
  [[nodiscard]] std::span<const StateIndex> quasi_static() const noexcept { return quasi_static_; }  // volumes
  [[nodiscard]] const math::StiffReport& last_report() const noexcept { return report_; }
  [[nodiscard]] int beyond_waves() const noexcept { return circuit_.beyond_waves(); }  // of the last step
  // The volume with more room without oil than it has room after the last step, -1: none.
  [[nodiscard]] int overdrawn() const noexcept { return circuit_.first_overdrawn(y_.data()); }

  // Adds the raw bits of all state that influences later results: y, the solver's memory, failure latch, live
  // parameters.
  void add_to(StateHash& hash) const noexcept;
  // The same as bytes, the circuit's and actuators() with it. Pre-condition: can_save(). load() allocates; call align()
  // or step() next.
  [[nodiscard]] bool can_save() const noexcept { return solver_->can_save(); }
  void save(StateWriter& bytes) const;
  void load(StateReader& bytes);

 private:
  class Ahead;
  template <typename Self, typename Bytes>
  static void visit(Self& self, Bytes& bytes);
  void derivative(const double* y, double* f) noexcept override;
  const double* jacobian(const double* y, const double* f) noexcept override;
  const double* linearise(const double* y, double* f) noexcept override;
  [[nodiscard]] double time_to_bend(const double* y, const double* f, const double* J) noexcept override;
  [[nodiscard]] std::int32_t impossible_state(double h, const double* y_before, const double* y) noexcept override;
  [[nodiscard]] Unbalanced unbalanced_state(const double* y_before, const double* y) noexcept override;
  [[nodiscard]] bool has_measure(std::size_t state) const noexcept override;
  [[nodiscard]] Measure measure(std::size_t state, double y) const noexcept override;
  [[nodiscard]] double state_of_measure(std::size_t state, double w) const noexcept override;
  [[nodiscard]] std::size_t soft_states(const double* y, std::span<std::size_t> states) const noexcept override;
  void accepted(double h, const double* y_before, const double* f_before, double* y) noexcept override;
  struct PressureForce {
    double F = 0, rate = 0;  // N, N/s
  };
  // Force and its rate of an actuator at y with rates f.
  [[nodiscard]] PressureForce pressure_force(const Actuator& actuator, const double* y, const double* f) const noexcept;
  void publish_force_rate(std::size_t actuator) noexcept;
  [[nodiscard]] double at_full_setting(const Actuator& actuator, const double* y) const noexcept;
  [[nodiscard]] double brake_stiffness(int actuator) noexcept;
  void add_accelerations(const double* y, double* f) noexcept;
  void stamp_accelerations(const double* y, double* J) noexcept;
  void publish() noexcept;
  void close_quadrature(const double* y, const double* f) noexcept;
  void choose_quasi_static();
  void list_quasi_static();
  void note_inputs() noexcept;
  [[nodiscard]] bool make_consistent() noexcept;
  [[nodiscard]] bool correct_by_newton() noexcept;
  [[nodiscard]] bool balance(std::size_t row) noexcept;
  [[nodiscard]] bool march_to_balance() noexcept;
  void fill_algebraic(double per_step) noexcept;
  [[nodiscard]] double size_of(StateIndex row) const noexcept;  // of a pressure, for the error
  [[nodiscard]] StepFlag failure_flag() const noexcept {
    return report_.is_impossible ? StepFlag::ended : StepFlag::non_finite;
  }
  void report_flags(StepReport& report) noexcept;
  void publish_line(int actuator) noexcept;
  void integrate_pressures(double h, const double* y_before, const double* f_before, const double* y) noexcept;

  Circuit& circuit_;
  const PistonMotion* motion_ = nullptr;  // set during step()
  std::size_t m_;
  std::vector<double> y_, y_start_, f_;
  std::vector<double> F_, F_dot_, F_mean_, jerk_, da_dF_, da_dx_, da_dv_, C_, outflow_;
  std::vector<double> pressure_integral_, substep_pressure_;  // Pa s, by line; of the step, of the last sub-step
  std::vector<ActuatorLinearisation> published_;
  double open_quadrature_ = 0;  // h^2/12 of the last sub-step, whose end slope is not known yet
  bool was_clamped_ = false;
  bool has_failed_ = false;
  StateIndex offender_ = -1;  // offender of the failure
  math::StiffOptions options_;
  Solver choice_;
  std::unique_ptr<math::StiffIntegrator> solver_;
  math::Rodas3 ahead_solver_;  // of foresee()
  std::vector<double> y_ahead_, f_ahead_, vapour_;
  math::StiffReport report_;
  std::vector<double> inputs_;  // controls and live parameters of the last step; empty if unused
  double quasi_static_above_;   // 1/s
  std::vector<char> may_be_quasi_static_, is_marked_, is_quasi_static_;  // by volume
  std::vector<StateIndex> quasi_static_;
  std::vector<double> before_, balanced_;  // Pa, by quasi-static volume
  std::vector<double> mass_;
  StepResponse response_;
  math::DenseLu algebraic_;  // matrix of the quasi-static rows and columns
  bool is_consistent_ = true;
};

}  // namespace slew::hydraulics
