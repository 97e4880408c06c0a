// SPDX-License-Identifier: Apache-2.0
// A stiff system of ordinary differential equations, and the seam of the integrators that advance one.
//
//   M y' = f(y),  M diagonal of ones and zeros                                                        (1)
//
// A zero in M makes its row algebraic, 0 = f_i(y), of index 1: df_i/dy_i stays away from zero. takes_algebraic_rows()
// reports whether an integrator accepts them. All of them cover an interval exactly, sub-step inside it, and call
// accepted() after
// each sub-step. Deterministic: the same system, state and history give the same bits.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/state_bytes.h"
#include "core/state_hash.h"

namespace slew::math {

// y' = f(y), constant inputs over an interval.
class StiffSystem {
 public:
  virtual ~StiffSystem() = default;
  virtual void derivative(const double* y, double* f) noexcept = 0;
  // J = df/dy at y, f = f(y) given; row-major with the stride stated to the integrator. Valid until the next call.
  virtual const double* jacobian(const double* y, const double* f) noexcept = 0;
  // Both at once, for a system that shares work between them; the same bits as one after the other.
  virtual const double* linearise(const double* y, double* f) noexcept {
    derivative(y, f);
    return jacobian(y, f);
  }
  // Estimated time [s] from y, with f = f(y) and J, to a sharp bend of a law. A sub-step that jumps over a bend into a
  // much stiffer region is rejected by its error several times. An adaptive method therefore ends a sub-step at the
  // bend; the error still decides on acceptance.
  [[nodiscard]] virtual double time_to_bend(const double* /*y*/, const double* /*f*/, const double* /*J*/) noexcept {
    return std::numeric_limits<double>::infinity();
  }
  // Balance of a trial sub-step of h seconds from y_before to y that does not rest on the error estimate: the first
  // state that no motion of the system can have reached, -1: none.
  [[nodiscard]] virtual std::int32_t impossible_state(double /*h*/, const double* /*y_before*/,
                                                      const double* /*y*/) noexcept {
    return -1;
  }
  // Balance of an Euler sub-step, whose flows are those at its end y: the first state whose content changed by much
  // else than h times the flow, and the largest such change of content as a share of a state's size.
  struct Unbalanced {
    std::int32_t state = -1;  // -1: none
    double share = 0;
  };
  [[nodiscard]] virtual Unbalanced unbalanced_state(const double* /*y_before*/, const double* /*y*/) noexcept {
    return {};
  }
  // Measure w(y_i) of what a state stores, with its two first derivatives, for a state whose storage is far from linear
  // in it: w is increasing, and its rate a flow. A method that advances w in place of y_i keeps sums of what is stored
  // to rounding, at any tolerance. state_of_measure() inverts it.
  struct Measure {
    double value, slope, bend;
  };
  [[nodiscard]] virtual bool has_measure(std::size_t /*state*/) const noexcept { return false; }
  [[nodiscard]] virtual Measure measure(std::size_t /*state*/, double y) const noexcept { return {y, 1, 0}; }
  [[nodiscard]] virtual double state_of_measure(std::size_t /*state*/, double w) const noexcept { return w; }
  // States whose storage bends so strongly at y that an adaptive method advances their measures: their indices in
  // increasing order, and how many; room for all states.
  [[nodiscard]] virtual std::size_t soft_states(const double* /*y*/, std::span<std::size_t> /*states*/) const noexcept {
    return 0;
  }
  // A sub-step from y_before (derivative f_before) to y was accepted; may move y back into its bounds.
  virtual void accepted(double h, const double* y_before, const double* f_before, double* y) noexcept = 0;
};

// Adaptive methods shorten a sub-step that fails at minimum_step to this share of it: a volume of 1 mm3 behind a wide
// orifice empties in 1e-11 s.
inline constexpr double kShortestShare = 1e-9;

// Error of a state, as a share of its size, with which no sub-step is accepted, whatever it costs.
inline constexpr double kGrossShare = 1e-2;

// Error of a state, as a share of its size, that leaves the result sound although the tolerance is tighter: that of the
// default tolerance.
inline constexpr double kSoundShare = 1e-4;

// Scales of errors and residuals: the size of state i is s_i + r_i |y_i|, with a separate r_i below zero.
struct StiffOptions {
  double relative_tolerance = 1e-4;
  double minimum_step = 1e-6;                    // s; shorter only after a failure (kShortestShare)
  double maximum_step = 1e-4;                    // s, sub-step of the fixed-step integrators
  std::uint32_t substep_budget = 200;            // accepted and rejected sub-steps per interval
  std::vector<double> scale;                     // s_i of the error measure, one per state, > 0
  std::vector<double> relative;                  // r_i: 1, or 0 for a state whose zero is arbitrary (a position)
  std::vector<double> relative_below_zero = {};  // r_i for y_i < 0; empty: the same
  std::vector<char> is_replaced = {};  // 1: the caller replaces the state after the interval, and its error does not
                                       // count in accepted_error; empty: none

  [[nodiscard]] double size_of(std::size_t i, double y) const noexcept {
    return scale[i] + (y < 0 && !relative_below_zero.empty() ? relative_below_zero : relative)[i] * std::fabs(y);
  }
  [[nodiscard]] bool keeps_error(std::size_t i) const noexcept { return is_replaced.empty() || is_replaced[i] == 0; }
};

struct StiffReport {
  std::uint32_t accepted = 0;
  std::uint32_t rejected = 0;
  std::uint32_t dense_factorisations = 0;  // factorisations with dense pivoting, since a diagonal pivot was too small
  std::uint32_t restarts = 0;              // restarts of a multistep method
  bool is_over_budget = false;             // rodas3: the rest of the interval was computed at looser tolerances;
                                           // implicit Euler: more halved sub-steps than the budget
  bool is_at_minimum_step = false;         // a step was accepted with its error because it could not be shorter
  bool is_unstable = false;                // an explicit method's sub-step is beyond its stability limit
  bool is_finite = true;                   // false: y is the last finite state, the interval is not finished
  bool is_impossible = false;     // no sub-step kept the system's balance (impossible_state()) or an error below
                                  // kGrossShare: the interval is not finished
  double largest_error = 0;       // largest error of the accepted steps, 1 = tolerance; explicit: h
                                  // |lambda|_max / limit
  double accepted_error = 0;      // sum of the errors of sub-steps that were accepted above the tolerance and
                                  // kSoundShare, each as a share of the size of a state that is not replaced
  std::int32_t worst_state = -1;  // the state with that error; when not finite or impossible: the first such
                                  // state
};

// A function of one state: g(y_i) and its slope.
class StateFunction {
 public:
  struct Value {
    double value, slope;
  };
  virtual ~StateFunction() = default;
  [[nodiscard]] virtual Value at(double y) const noexcept = 0;
};

class StiffIntegrator {
 public:
  virtual ~StiffIntegrator() = default;

  // Advances y by `duration` seconds.
  virtual StiffReport advance(StiffSystem& system, std::span<double> y, double duration) noexcept = 0;

  // Announces a jump of the system's inputs since the last interval. One-step methods ignore it.
  virtual void inputs_jumped() noexcept {}
  // Forgets the past: a new start.
  virtual void restart() noexcept = 0;

  // Proposed size of the next sub-step; may be set.
  [[nodiscard]] virtual double step_size() const noexcept = 0;
  virtual void set_step_size(double h) noexcept = 0;
  // Raw bits of the state beside y that influences later results.
  virtual void add_to(StateHash& hash) const noexcept { hash.add(step_size()); }
  // The same state as bytes, for a restart with identical results.
  // False: the method's history cannot be restored.
  [[nodiscard]] virtual bool can_save() const noexcept { return true; }
  virtual void save(StateWriter& bytes) const { static_cast<void>(bytes); }
  virtual void load(StateReader& bytes) noexcept { static_cast<void>(bytes); }

  // Integral of g(y_i), i = state, over the sub-step that is being accepted; for StiffSystem::accepted() only.
  // Integrated as the method itself does where that differs from a parabola, so that an outflow of one state equals the
  // inflow of another.
  [[nodiscard]] virtual double integral(const StateFunction& g, std::size_t state, double h, const double* y_before,
                                        const double* f_before, const double* y) const noexcept {
    const StateFunction::Value before = g.at(y_before[state]);
    return h / 3 * (2 * before.value + g.at(y[state]).value) + h * h / 6 * (before.slope * f_before[state]);
  }

  // Diagonal of M in (1), ones and zeros, one per state. Pre-condition: takes_algebraic_rows().
  [[nodiscard]] virtual bool takes_algebraic_rows() const noexcept { return false; }
  virtual void set_mass(std::span<const double> mass) noexcept { static_cast<void>(mass); }
};

}  // namespace slew::math
