// SPDX-License-Identifier: Apache-2.0
// SUNDIALS IDA as a value: variable-order BDF for F(t, y, y') = 0 with Newton iteration, dense matrix, Jacobian by
// difference quotients.
//
// Errors per step are held below rtol |y_i| + atol_i (weighted root mean square) in the differential variables; the
// algebraic ones take part in the iteration only. Source: Hindmarsh et al. 2005, ACM TOMS 31, 363. Not real-time safe:
// it allocates and its cost is not bounded.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "monolith/stiff_solver.h"

namespace slew::monolith {

class AlgebraicEquation {
 public:
  virtual ~AlgebraicEquation() = default;
  // Writes F into r, of the size of y.
  virtual void residual(double t, const double* y, const double* y_rate, double* r) noexcept = 0;
};

enum class VariableKind : unsigned char { algebraic, differential };

// Values by variable.
struct DaeVariables {
  std::vector<double> start, start_rate;  // consistent: F = 0
  std::vector<double> absolute;           // tolerances
  std::vector<VariableKind> kind;
};

class DaeSolver {
 public:
  // equation outlives the solver.
  DaeSolver(AlgebraicEquation& equation, double t, const DaeVariables& variables, double relative);
  ~DaeSolver();
  DaeSolver(const DaeSolver&) = delete;
  DaeSolver& operator=(const DaeSolver&) = delete;

  // Advances to exactly t_end > t. Empty: done; else IDA's message.
  [[nodiscard]] std::string advance(double t_end);

  [[nodiscard]] std::span<const double> y() const noexcept;
  [[nodiscard]] double time() const noexcept { return t_; }
  [[nodiscard]] SolverStatistics statistics() const;

 private:
  struct Memory;
  std::unique_ptr<Memory> memory_;
  double t_ = 0;
};

}  // namespace slew::monolith
