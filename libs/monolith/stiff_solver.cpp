// SPDX-License-Identifier: Apache-2.0
#include "monolith/stiff_solver.h"

#include <cvode/cvode.h>
#include <fmt/format.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/check.h"

namespace slew::monolith {
namespace {

constexpr long kMostSteps = 2'000'000;  // within one advance; a step of 1 us over 2 s
constexpr long kStepsOfProgress = 10'000;
// Parts of kStepsOfProgress in a row whose pace would need more than kMostSteps for the rest: a transient has one or
// two.
constexpr int kMostPartsWithoutProgress = 3;

int call_rates(realtype t, N_Vector y, N_Vector f, void* user) {
  const realtype* const values = N_VGetArrayPointer(y);
  realtype* const out = N_VGetArrayPointer(f);
  const auto n = static_cast<std::size_t>(N_VGetLength(y));
  static_cast<DifferentialEquation*>(user)->rates(t, values, out);
  // a trial point outside of the laws: CVODE takes a shorter step
  const bool is_finite = std::all_of(out, out + n, [](double x) { return std::isfinite(x); });
  return is_finite ? 0 : 1;
}

void ignore_cvode_message(int, const char*, const char*, char*, void*) {}

}  // namespace

struct StiffSolver::Memory {
  SUNContext context = nullptr;
  N_Vector y = nullptr, tolerance = nullptr, work = nullptr;
  SUNMatrix matrix = nullptr;
  SUNLinearSolver solver = nullptr;
  void* cvode = nullptr;

  ~Memory() {
    CVodeFree(&cvode);
    SUNLinSolFree(solver);
    SUNMatDestroy(matrix);
    N_VDestroy(work);
    N_VDestroy(tolerance);
    N_VDestroy(y);
    SUNContext_Free(&context);
  }
};

StiffSolver::StiffSolver(DifferentialEquation& equation, std::span<const double> absolute, double relative)
    : equation_(equation), memory_(std::make_unique<Memory>()) {
  const auto n = static_cast<sunindextype>(absolute.size());
  Memory& m = *memory_;
  SLEW_CHECK(SUNContext_Create(nullptr, &m.context) == 0);
  m.y = N_VNew_Serial(n, m.context);
  m.tolerance = N_VNew_Serial(n, m.context);
  m.work = N_VNew_Serial(n, m.context);
  m.matrix = SUNDenseMatrix(n, n, m.context);
  m.solver = SUNLinSol_Dense(m.y, m.matrix, m.context);
  m.cvode = CVodeCreate(CV_BDF, m.context);
  SLEW_CHECK(m.y != nullptr && m.tolerance != nullptr && m.matrix != nullptr && m.solver != nullptr && m.cvode);
  N_VConst(0, m.y);
  std::copy(absolute.begin(), absolute.end(), N_VGetArrayPointer(m.tolerance));
  SLEW_CHECK(CVodeInit(m.cvode, call_rates, 0, m.y) == CV_SUCCESS);
  SLEW_CHECK(CVodeSVtolerances(m.cvode, relative, m.tolerance) == CV_SUCCESS);
  SLEW_CHECK(CVodeSetUserData(m.cvode, &equation_) == CV_SUCCESS);
  SLEW_CHECK(CVodeSetLinearSolver(m.cvode, m.solver, m.matrix) == CV_SUCCESS);
  SLEW_CHECK(CVodeSetMaxNumSteps(m.cvode, kStepsOfProgress) == CV_SUCCESS);
  SLEW_CHECK(CVodeSetErrHandlerFn(m.cvode, ignore_cvode_message, nullptr) == CV_SUCCESS);
}

StiffSolver::~StiffSolver() = default;

void StiffSolver::restart(double t, std::span<const double> y) {
  closed_ = statistics();
  ++closed_.restarts;
  std::copy(y.begin(), y.end(), N_VGetArrayPointer(memory_->y));
  SLEW_CHECK(CVodeReInit(memory_->cvode, t, memory_->y) == CV_SUCCESS);
  t_ = t;
}

std::string StiffSolver::advance(double t_end) {
  realtype reached = t_;
  int flag = CVodeSetStopTime(memory_->cvode, t_end);
  // in parts with the same steps as in one call
  int slow_parts = 0;
  double before = t_;
  for (long steps = 0; flag == CV_SUCCESS; steps += kStepsOfProgress) {
    flag = CVode(memory_->cvode, t_end, memory_->y, &reached, CV_NORMAL);
    if (flag != CV_TOO_MUCH_WORK) break;
    const double progress = reached - before, needed = kMostSteps / double{kStepsOfProgress} * progress;
    slow_parts = needed < t_end - reached ? slow_parts + 1 : 0;
    if (slow_parts == kMostPartsWithoutProgress || steps + kStepsOfProgress >= kMostSteps) {
      t_ = reached;
      return fmt::format("no progress: the last {} steps advanced it by {:.2g} s", kStepsOfProgress, progress);
    }
    before = reached;
    flag = CV_SUCCESS;
  }
  t_ = reached;
  if (flag >= 0) return {};
  char* const name = CVodeGetReturnFlagName(flag);
  std::string text = name;
  std::free(name);
  return text;
}

std::span<const double> StiffSolver::y() const noexcept {
  return {N_VGetArrayPointer(memory_->y), static_cast<std::size_t>(N_VGetLength(memory_->y))};
}

std::size_t StiffSolver::worst_state() const {
  const auto n = static_cast<std::size_t>(N_VGetLength(memory_->y));
  // the solver's own weights, from relative and absolute tolerance
  const std::unique_ptr<_generic_N_Vector, void (*)(N_Vector)> weights(N_VClone(memory_->work), N_VDestroy);
  if (weights == nullptr || CVodeGetEstLocalErrors(memory_->cvode, memory_->work) != CV_SUCCESS ||
      CVodeGetErrWeights(memory_->cvode, weights.get()) != CV_SUCCESS) {
    return 0;
  }
  const double* const error = N_VGetArrayPointer(memory_->work);
  const double* const weight = N_VGetArrayPointer(weights.get());
  std::size_t worst = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!(std::fabs(error[i]) * weight[i] <= std::fabs(error[worst]) * weight[worst])) worst = i;
  }
  return worst;
}

SolverStatistics StiffSolver::statistics() const {
  SolverStatistics total = closed_;
  long steps = 0, rhs = 0, rhs_of_jacobians = 0, jacobians = 0, error_failures = 0, convergence_failures = 0;
  CVodeGetNumSteps(memory_->cvode, &steps);
  CVodeGetNumRhsEvals(memory_->cvode, &rhs);
  CVodeGetNumLinRhsEvals(memory_->cvode, &rhs_of_jacobians);
  CVodeGetNumJacEvals(memory_->cvode, &jacobians);
  CVodeGetNumErrTestFails(memory_->cvode, &error_failures);
  CVodeGetNumNonlinSolvConvFails(memory_->cvode, &convergence_failures);
  total.steps += steps;
  total.right_hand_sides += rhs + rhs_of_jacobians;
  total.jacobians += jacobians;
  total.error_test_failures += error_failures;
  total.convergence_failures += convergence_failures;
  return total;
}

}  // namespace slew::monolith
