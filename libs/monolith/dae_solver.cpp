// SPDX-License-Identifier: Apache-2.0
#include "monolith/dae_solver.h"

#include <ida/ida.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/check.h"

namespace slew::monolith {
namespace {

constexpr double kFirstStep = 0.1;      // s, times the root of the tolerance: the accuracy of the first order
constexpr long kMostSteps = 2'000'000;  // within one advance

// increments of difference quotients: for y relative to y and 1, since the variables are of the order of a metre, a
// second, a turn; for the rates, in which a mechanism is linear
const double kIncrement = std::sqrt(2.2e-16);
constexpr double kRateIncrement = 1;

// the equation, and the count of residuals for its Jacobian
struct Counted {
  AlgebraicEquation& equation;
  long residuals_of_jacobians = 0;
};

int call_residual(realtype t, N_Vector y, N_Vector y_rate, N_Vector r, void* user) {
  realtype* const out = N_VGetArrayPointer(r);
  static_cast<Counted*>(user)->equation.residual(t, N_VGetArrayPointer(y), N_VGetArrayPointer(y_rate), out);
  // a trial point outside of the laws: IDA takes a shorter step
  const bool is_finite = std::all_of(out, out + N_VGetLength(r), [](double x) { return std::isfinite(x); });
  return is_finite ? 0 : 1;
}

// dF/dy + c dF/dy'. IDA's own increments go down to the tolerance where a variable is zero, and drown in rounding.
int call_jacobian(realtype t, realtype c, N_Vector y, N_Vector y_rate, N_Vector r, SUNMatrix matrix, void* user,
                  N_Vector changed, N_Vector, N_Vector) {
  Counted& counted = *static_cast<Counted*>(user);
  const realtype* const base = N_VGetArrayPointer(r);
  realtype* const other = N_VGetArrayPointer(changed);
  const auto n = static_cast<std::size_t>(N_VGetLength(y));
  for (std::size_t j = 0; j < n; ++j) {
    realtype* const column = SUNDenseMatrix_Column(matrix, static_cast<sunindextype>(j));
    const auto add_quotient = [&](double& variable, double increment, double weight) {
      const double kept = variable;
      variable = kept + increment;
      const double step = variable - kept;
      counted.equation.residual(t, N_VGetArrayPointer(y), N_VGetArrayPointer(y_rate), other);
      variable = kept;
      for (std::size_t i = 0; i < n; ++i) column[i] += weight * (other[i] - base[i]) / step;
    };
    std::fill(column, column + n, 0.0);
    double& value = N_VGetArrayPointer(y)[j];
    add_quotient(value, kIncrement * std::max(1.0, std::fabs(value)), 1);
    add_quotient(N_VGetArrayPointer(y_rate)[j], kRateIncrement, c);
    counted.residuals_of_jacobians += 2;
  }
  return 0;
}

void ignore_message(int, const char*, const char*, char*, void*) {}

}  // namespace

struct DaeSolver::Memory {
  explicit Memory(AlgebraicEquation& equation) : counted{equation} {}

  Counted counted;
  SUNContext context = nullptr;
  N_Vector y = nullptr, y_rate = nullptr, tolerance = nullptr, kind = nullptr;
  SUNMatrix matrix = nullptr;
  SUNLinearSolver solver = nullptr;
  void* ida = nullptr;

  ~Memory() {
    IDAFree(&ida);
    SUNLinSolFree(solver);
    SUNMatDestroy(matrix);
    for (N_Vector vector : {kind, tolerance, y_rate, y}) N_VDestroy(vector);
    SUNContext_Free(&context);
  }
};

DaeSolver::DaeSolver(AlgebraicEquation& equation, double t, const DaeVariables& variables, double relative)
    : memory_(std::make_unique<Memory>(equation)), t_(t) {
  Memory& m = *memory_;
  SLEW_CHECK(SUNContext_Create(nullptr, &m.context) == 0);
  const auto n = static_cast<sunindextype>(variables.start.size());
  for (N_Vector* vector : {&m.y, &m.y_rate, &m.tolerance, &m.kind}) {
    *vector = N_VNew_Serial(n, m.context);
    SLEW_CHECK(*vector != nullptr);
  }
  std::copy(variables.start.begin(), variables.start.end(), N_VGetArrayPointer(m.y));
  std::copy(variables.start_rate.begin(), variables.start_rate.end(), N_VGetArrayPointer(m.y_rate));
  std::copy(variables.absolute.begin(), variables.absolute.end(), N_VGetArrayPointer(m.tolerance));
  std::transform(variables.kind.begin(), variables.kind.end(), N_VGetArrayPointer(m.kind),
                 [](VariableKind kind) { return kind == VariableKind::differential ? 1.0 : 0.0; });
  m.matrix = SUNDenseMatrix(n, n, m.context);
  m.solver = SUNLinSol_Dense(m.y, m.matrix, m.context);
  m.ida = IDACreate(m.context);
  SLEW_CHECK(m.matrix != nullptr && m.solver != nullptr && m.ida != nullptr);
  SLEW_CHECK(IDAInit(m.ida, call_residual, t, m.y, m.y_rate) == IDA_SUCCESS);
  SLEW_CHECK(IDASVtolerances(m.ida, relative, m.tolerance) == IDA_SUCCESS);
  SLEW_CHECK(IDASetUserData(m.ida, &m.counted) == IDA_SUCCESS);
  SLEW_CHECK(IDASetLinearSolver(m.ida, m.solver, m.matrix) == IDA_SUCCESS);
  SLEW_CHECK(IDASetJacFn(m.ida, call_jacobian) == IDA_SUCCESS);
  SLEW_CHECK(IDASetId(m.ida, m.kind) == IDA_SUCCESS);
  SLEW_CHECK(IDASetSuppressAlg(m.ida, SUNTRUE) == IDA_SUCCESS);
  SLEW_CHECK(IDASetMaxNumSteps(m.ida, kMostSteps) == IDA_SUCCESS);
  // IDA's own first step scales with the tolerance itself; multipliers, which are differences over the step, would then
  // be lost in rounding
  SLEW_CHECK(IDASetInitStep(m.ida, kFirstStep * std::sqrt(relative)) == IDA_SUCCESS);
  SLEW_CHECK(IDASetErrHandlerFn(m.ida, ignore_message, nullptr) == IDA_SUCCESS);
}

DaeSolver::~DaeSolver() = default;

std::string DaeSolver::advance(double t_end) {
  realtype reached = t_;
  int flag = IDASetStopTime(memory_->ida, t_end);
  if (flag == IDA_SUCCESS) flag = IDASolve(memory_->ida, t_end, &reached, memory_->y, memory_->y_rate, IDA_NORMAL);
  t_ = reached;
  if (flag >= 0) return {};
  char* const name = IDAGetReturnFlagName(flag);
  std::string text = name;
  std::free(name);
  return text;
}

std::span<const double> DaeSolver::y() const noexcept {
  return {N_VGetArrayPointer(memory_->y), static_cast<std::size_t>(N_VGetLength(memory_->y))};
}

SolverStatistics DaeSolver::statistics() const {
  long steps = 0, residuals = 0, jacobians = 0, error_failures = 0, failures = 0;
  IDAGetNumSteps(memory_->ida, &steps);
  IDAGetNumResEvals(memory_->ida, &residuals);
  IDAGetNumJacEvals(memory_->ida, &jacobians);
  IDAGetNumErrTestFails(memory_->ida, &error_failures);
  IDAGetNumNonlinSolvConvFails(memory_->ida, &failures);
  return {.steps = steps,
          .right_hand_sides = residuals + memory_->counted.residuals_of_jacobians,
          .jacobians = jacobians,
          .error_test_failures = error_failures,
          .convergence_failures = failures,
          .restarts = 0};
}

}  // namespace slew::monolith
