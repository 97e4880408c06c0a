// SPDX-License-Identifier: Apache-2.0
// SUNDIALS CVODE as a value: variable-order BDF with Newton iteration, dense matrix, Jacobian by difference quotients.
//
// Errors per step are held below rtol |y_i| + atol_i (weighted root mean square). Source: Hindmarsh et al. 2005, ACM
// TOMS 31, 363. Not real-time safe: it allocates and its cost is not bounded.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace slew::monolith {

class DifferentialEquation {
 public:
  virtual ~DifferentialEquation() = default;
  virtual void rates(double t, const double* y, double* f) noexcept = 0;
};

struct SolverStatistics {
  std::int64_t steps = 0;
  std::int64_t right_hand_sides = 0;  // those of the Jacobian included
  std::int64_t jacobians = 0;
  std::int64_t error_test_failures = 0;
  std::int64_t convergence_failures = 0;
  std::int64_t restarts = 0;
};

class StiffSolver {
 public:
  // equation outlives the solver. absolute: one tolerance per state.
  StiffSolver(DifferentialEquation& equation, std::span<const double> absolute, double relative);
  ~StiffSolver();
  StiffSolver(const StiffSolver&) = delete;
  StiffSolver& operator=(const StiffSolver&) = delete;

  // Restarts from y at t without history: after every jump of y or of the equation.
  void restart(double t, std::span<const double> y);
  // Advances to exactly t_end > t. Empty: done; else CVODE's message, or that its steps have become too short to reach
  // t_end in a sensible number: near a singularity of the equation.
  [[nodiscard]] std::string advance(double t_end);

  [[nodiscard]] std::span<const double> y() const noexcept;
  [[nodiscard]] double time() const noexcept { return t_; }
  // State with the largest share in the last step's error test.
  [[nodiscard]] std::size_t worst_state() const;
  [[nodiscard]] SolverStatistics statistics() const;

 private:
  struct Memory;

  DifferentialEquation& equation_;
  std::unique_ptr<Memory> memory_;
  double t_ = 0;
  SolverStatistics closed_;  // statistics of the runs before the last restart
};

}  // namespace slew::monolith
