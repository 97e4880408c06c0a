// SPDX-License-Identifier: Apache-2.0
// The small coupled problem at the ports, solved implicitly in the mechanics' sub-step (coupling study, section 8).
//
// A row is a scalar coordinate of the mechanism with a stiff force law: an actuator's stroke, or a joint coordinate
// with friction and limits. Over a sub-step of length h the mechanism is its reduced model
//   x' = v,   v' = a_free + a_free' t + W f                                                        (1)
// and each row's force f = f(z, x, v, t) follows the row's own law, where z is the partner's pressure force with
//   z' = F_dot - K (v - v_ref) - lambda (z - F_n)                                                  (2)
// (K = lambda = F_dot = 0 for rows without partner; K is a matrix over coupled rows). (1), (2) are integrated with
// micro-steps of the L-stable, stiffly accurate two-stage SDIRK method (Alexander 1977, gamma = 1 - 1/sqrt(2), order
// 2); each stage is a Newton iteration on the m speeds; where a law jumps, as a stop's damping does when it is touched,
// and no speed fits, the force is the one between its two sides that holds the speed at the jump. Friction slopes of
// 4e4 1/s and end stops are thus inside the implicit solve, while the mechanism itself sees only the mean and the slope
// in time of f.
//
// The second stage extrapolates the first one's acceleration by a factor of 2.4: behind a stop that only pushes, this
// would release a row that was just stopped at up to 1.4 times its speed. A micro-step in which a stop begins or ends
// to push is therefore taken in parts, ever shorter towards the event. The shortest part, with the event, uses
//   implicit Euler:  x_1 = x_0 + h v_1,  v_1 = v_0 + h (a_free + W f_1)                            (3)
// which adds no energy at a stop beyond that of its spring. While a stop's spring throws back, parts are short against
// its oscillation, omega = sqrt(k W_ii); a stop faster than the shortest part loses its rebound.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "core/state_bytes.h"

namespace slew::coupling {

// Partner's linearisation for one row, equation (2), and its feed-through -D (v - v_ref).
struct RowPartner {
  double F_dot = 0;   // N/s
  double K = 0;       // N/m
  double lambda = 0;  // 1/s
  double D = 0;       // N s/m
  double F_n = 0;     // N
  double v_ref = 0;   // m/s
};

// Value and slopes of one row's force, on the row's own coordinate: N and m, or N m and rad.
struct RowForce {
  double force = 0;  // N
  double d_z = 0;    // 1
  double d_x = 0;    // N/m
  double d_v = 0;    // N s/m
  double stop = 0;   // push of a stop, contained in force [N]
};

// The rows' force laws; row i depends on its own z, x, v only.
class RowLaws {
 public:
  virtual ~RowLaws() = default;
  [[nodiscard]] virtual RowForce evaluate(std::size_t row, double z, double x, double v) const noexcept = 0;
  // The first `rows` rows at once.
  virtual void evaluate_all(std::size_t rows, const double* z, const double* x, const double* v,
                            RowForce* force) const noexcept {
    for (std::size_t row = 0; row < rows; ++row) force[row] = evaluate(row, z[row], x[row], v[row]);
  }

  // Laws with a memory (bristles of dry friction). begin(): from here on evaluate() means the end of an interval h at
  // its speed, which began with the memory as it is; true when any row of this solve has a memory. set_interval():
  // another h from here on. carry(): the memory of a row advances by h at the speed v. go_back(): the memory returns to
  // the last keep().
  virtual bool begin(double /*h*/) noexcept { return false; }
  virtual void set_interval(double /*h*/) noexcept {}
  virtual void carry(std::size_t /*row*/, double /*v*/, double /*h*/) noexcept {}
  virtual void keep() noexcept {}
  virtual void go_back() noexcept {}

  // True if a stop of this row can push at x.
  [[nodiscard]] virtual bool is_at_stop(std::size_t /*row*/, double /*x*/) const noexcept { return false; }
};

struct PortStep {
  double residual = 0;  // largest final residual of all stages [m/s or rad/s]; NaN after a non-finite value
  int iterations = 0;   // Newton iterations of all stages
  bool has_converged = true;
  bool meets_stop = false;  // a stop pushed during the step
};

class PortDynamics {
 public:
  // capacity: number of rows at the start.
  explicit PortDynamics(std::size_t capacity);

  // Number of rows of the next sub-steps, at most the capacity; all inputs must be set again.
  void set_rows(std::size_t rows) noexcept;
  [[nodiscard]] std::size_t rows() const noexcept { return rows_; }

  // inputs of a sub-step, set by the owner; all arrays have one entry per row
  std::span<double> x() noexcept { return {x_.data(), rows_}; }            // start positions, advanced by solve()
  std::span<double> v() noexcept { return {v_.data(), rows_}; }            // start speeds, advanced by solve()
  std::span<double> z() noexcept { return {z_.data(), rows_}; }            // pressure forces, advanced by solve()
  std::span<double> a_free() noexcept { return {a_free_.data(), rows_}; }  // at the start
  std::span<double> a_free_rate() noexcept { return {a_free_rate_.data(), rows_}; }  // over the sub-step
  std::span<double> W() noexcept { return {W_.data(), rows_ * rows_}; }              // row-major
  std::span<RowPartner> partner() noexcept { return {partner_.data(), rows_}; }
  // The K of (2) between rows, row-major with a zero diagonal [N/m], all zero at first; rows are coupled by it until
  // the next set_rows().
  std::span<double> couple() noexcept;

  // Integrates over h in `micro_steps` equal steps.
  PortStep solve(double h, int micro_steps, RowLaws& laws) noexcept;

  // results of the last solve(): force over the sub-step is f_mean + (t - h/2) f_slope to first order; of a force that
  // is linear in time the mean is exact, the slope of rows with a partner too large by 24 % over the square of
  // micro_steps (the quadrature's). A row without partner whose speed decays within a micro-step gets, of three
  // or more, the slope with which mean and slope move it as the stages did: after a jump of the load its force is a
  // blow.
  [[nodiscard]] std::span<const double> f_mean() const noexcept { return {f_mean_.data(), rows_}; }
  [[nodiscard]] std::span<const double> f_slope() const noexcept { return {f_slope_.data(), rows_}; }
  [[nodiscard]] std::span<const double> work() const noexcept { return {work_.data(), rows_}; }  // work of z [J]
  // impulse of z [N s]
  [[nodiscard]] std::span<const double> impulse() const noexcept { return {impulse_.data(), rows_}; }

 private:
  static constexpr double kUnbounded = std::numeric_limits<double>::infinity();
  // Alexander (1977), SIAM J. Numer. Anal. 14, 1006: gamma = 1 - 1/sqrt(2)
  static constexpr double kGamma = 0.29289321881345247560;
  // A part of a solve: where it begins, its length, times of its stages.
  struct Span {
    double begin, length, first, end;  // s
  };
  void prepare(double weight) noexcept;
  bool try_stages(const Span& span, RowLaws& laws, PortStep& report) noexcept;
  void take_in_parts(const Span& span, RowLaws& laws, PortStep& report) noexcept;
  void take_euler(const Span& span, RowLaws& laws, PortStep& report) noexcept;
  void set_weight(double weight, RowLaws& laws) noexcept;
  void keep_first() noexcept;
  // Time at which the force of a stage acts. of_stage: at the stage itself, for rows with a partner. of_line: makes
  // mean and slope of a force linear in time exact, for friction that holds against a growing load. of_displacement:
  // reproduces the displacement of the stages (x_1 has h^2 (2 gamma (1 - gamma) f_first + gamma^2 f_end)), at a stop.
  struct Instant {
    double of_stage, of_line, of_displacement;  // s
    bool is_at_stop;
  };
  void add(double share, const Instant& at, std::span<const double> f, std::span<const double> pressure_force,
           std::span<const double> v) noexcept;
  void move(PortStep& report) noexcept;
  void note_decay(int step, double delta) noexcept;
  [[nodiscard]] double slope_of(std::size_t row, int micro_steps) const noexcept;
  bool follows_stops(const Span& span, const RowLaws& laws) noexcept;
  [[nodiscard]] double longest_in_swing(std::size_t row, double time) const noexcept;
  bool solve_stage(double weight, double time, const RowLaws& laws, PortStep& report) noexcept;
  // rows: their number, for a few rows as a constant
  template <typename Rows>
  bool solve_stage_of(Rows rows, double weight, double time, const RowLaws& laws, PortStep& report) noexcept;
  template <typename Rows>
  void evaluate_rows(Rows rows, double weight, const RowLaws& laws) noexcept;
  void pull_by_others() noexcept;
  void add_coupled_slopes() noexcept;
  void forget_bracket(std::size_t row) noexcept;
  bool note_side(std::size_t row, double step) noexcept;
  // sway: speed change of the row by its own force [m/s per N]
  double bracketed(std::size_t row, double step, double sway, double narrow) noexcept;

  std::size_t capacity_;
  std::size_t rows_;
  std::vector<double> x_, v_, z_, a_free_, a_free_rate_, W_;
  std::vector<RowPartner> partner_;
  std::vector<double> weighted_W_, weighted_a_;      // weight W, the same in every stage; weight a_free of the stage
  std::vector<double> shrink_, drive_, pull_;        // z of a stage = shrink z_base + drive - pull v, by (2)
  std::vector<double> K_between_, pull_between_;     // of coupled rows
  std::vector<double> x_base_, v_base_, z_base_;     // stage value = base + weight * slope
  std::vector<double> x_stage_, v_stage_, z_stage_;  // stage values
  std::vector<double> pressure_force_;               // z with the feed-through
  std::vector<RowForce> law_;
  std::vector<double> f_, slope_, f_mean_, f_slope_, work_, impulse_;
  std::vector<double> displacing_;  // moment of the force about h/2 by Instant::of_displacement [N s2]
  std::vector<double> f_settled_;   // force at the end of the second micro-step
  std::vector<char> decays_;        // the row's speed decays within each micro-step
  std::vector<double> residual_, A_;
  std::vector<double> low_, high_;                          // speeds of the stage that bracket the iteration's solution
  std::vector<double> f_low_, f_high_;                      // forces there
  std::vector<double> f_held_;                              // force in a bracket that holds a jump
  std::vector<double> last_step_;                           // last step of the iteration, inside the bracket
  std::vector<char> is_at_jump_;                            // the bracket holds a jump
  std::vector<double> k_x_, k_v_, k_z_;                     // slopes of the first stage
  std::vector<double> v_first_, f_first_, pressure_first_;  // values of the first stage
  std::vector<RowForce> law_first_, law_start_;
  std::vector<char> jump_first_;
  double h_ = 0;           // length of the solve [s]
  double largest_a_ = 0;   // largest value of weighted_a_
  double swing_rate_ = 0;  // squared rate of the stops that push [1/s2]
  double allowed_ = 0;     // length that a stop's swing allows [s]
  int tries_left_ = 0;     // remaining tries of parts
  bool is_at_stop_ = false;
  bool has_memory_ = false;
  bool is_coupled_ = false;
};

}  // namespace slew::coupling
