// SPDX-License-Identifier: Apache-2.0
#include "math/cvode_stepper.h"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"

namespace slew::math {
namespace {

constexpr std::uint32_t kMostSteps = 100'000;  // within one interval
// Share of the tolerance that the error of one step may have: those of BDF add up to ten to a hundred times as much.
constexpr double kShareOfTolerance = 0.01;
constexpr double kJump = 1e-3;  // share of a state's size above which a move of y is an event

void ignore_message(int, const char*, const char*, char*, void*) {}

}  // namespace

struct CvodeStepper::Memory {
  SUNContext context = nullptr;
  N_Vector z = nullptr, work = nullptr, weights = nullptr;
  SUNMatrix matrix = nullptr;
  SUNLinearSolver solver = nullptr;
  void* cvode = nullptr;
  // data of the callbacks
  StiffSystem* system = nullptr;
  const StiffOptions* options = nullptr;
  std::size_t stride = 0;
  std::vector<double> offset, y, rate;
  std::vector<StiffSystem::Measure> measures;

  ~Memory() {
    CVodeFree(&cvode);
    SUNLinSolFree(solver);
    SUNMatDestroy(matrix);
    N_VDestroy(weights);
    N_VDestroy(work);
    N_VDestroy(z);
    SUNContext_Free(&context);
  }

  // w(y_i); pre-condition here and below: there is a system.
  [[nodiscard]] double measure_of(std::size_t i, double state) const noexcept {
    return system->has_measure(i) ? system->measure(i, state).value : state;
  }
  [[nodiscard]] double state_of(std::size_t i, double w) const noexcept {
    return system->has_measure(i) ? system->state_of_measure(i, w) : w;
  }
  const double* state(N_Vector at) noexcept {
    const realtype* const values = N_VGetArrayPointer(at);
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = state_of(i, values[i] + offset[i]);
    return y.data();
  }

  // at rest while there is no system: the first calls only take memory
  static int rates(realtype, N_Vector at, N_Vector out, void* user) {
    Memory& m = *static_cast<Memory*>(user);
    double* const f = N_VGetArrayPointer(out);
    if (m.system == nullptr) {
      N_VConst(0, out);
      return 0;
    }
    const double* const y = m.state(at);
    m.system->derivative(y, f);
    for (std::size_t i = 0; i < m.y.size(); ++i) {
      if (m.system->has_measure(i)) f[i] *= m.system->measure(i, y[i]).slope;
    }
    // a trial point outside of the laws: CVODE takes a shorter step
    return std::all_of(f, f + m.y.size(), [](double x) { return std::isfinite(x); }) ? 0 : 1;
  }

  static int jacobian(realtype, N_Vector at, N_Vector f, SUNMatrix out, void* user, N_Vector, N_Vector, N_Vector) {
    Memory& m = *static_cast<Memory*>(user);
    if (m.system == nullptr) return 0;  // zero already
    const double* const y = m.state(at);
    const realtype* const z_rate = N_VGetArrayPointer(f);
    const std::size_t n = m.y.size();
    for (std::size_t i = 0; i < n; ++i) {
      m.measures[i] = m.system->has_measure(i) ? m.system->measure(i, y[i]) : StiffSystem::Measure{y[i], 1, 0};
      m.rate[i] = z_rate[i] / m.measures[i].slope;
    }
    const double* const J = m.system->jacobian(y, m.rate.data());
    // d(w_i' f_i)/dw_j = (w_i' J_ij + w_i'' f_i if i = j) / w_j'
    for (std::size_t j = 0; j < n; ++j) {
      realtype* const column = SM_COLUMN_D(out, static_cast<sunindextype>(j));
      for (std::size_t i = 0; i < n; ++i) column[i] = m.measures[i].slope * J[i * m.stride + j] / m.measures[j].slope;
      column[j] += m.measures[j].bend * m.rate[j] / m.measures[j].slope;
    }
    return 0;
  }

  static int error_weights(N_Vector at, N_Vector out, void* user) {
    Memory& m = *static_cast<Memory*>(user);
    const StiffOptions& options = *m.options;
    const realtype* const values = N_VGetArrayPointer(at);
    realtype* const weight = N_VGetArrayPointer(out);
    for (std::size_t i = 0; i < m.y.size(); ++i) {
      const double w = values[i] + m.offset[i];
      const double size = options.size_of(i, m.system == nullptr ? w : m.state_of(i, w));
      weight[i] = 1 / (kShareOfTolerance * options.relative_tolerance * size);
    }
    return 0;
  }
};

CvodeStepper::CvodeStepper(std::size_t jacobian_stride, StiffOptions options)
    : options_(std::move(options)),
      memory_(std::make_unique<Memory>()),
      reached_(options_.scale.size()),
      f_(reached_),
      new_(reached_),
      given_(reached_),
      moved_(reached_) {
  const auto n = static_cast<sunindextype>(reached_.size());
  Memory& m = *memory_;
  m.options = &options_;
  m.stride = jacobian_stride;
  m.offset = m.y = m.rate = reached_;
  m.measures.resize(reached_.size());
  SLEW_CHECK(SUNContext_Create(nullptr, &m.context) == 0);
  m.z = N_VNew_Serial(n, m.context);
  m.work = N_VNew_Serial(n, m.context);
  m.weights = N_VNew_Serial(n, m.context);
  m.matrix = SUNDenseMatrix(n, n, m.context);
  m.solver = SUNLinSol_Dense(m.z, m.matrix, m.context);
  m.cvode = CVodeCreate(CV_BDF, m.context);
  SLEW_CHECK(m.z && m.work && m.weights && m.matrix && m.solver && m.cvode);
  N_VConst(0, m.z);
  SLEW_CHECK(CVodeInit(m.cvode, Memory::rates, 0, m.z) == CV_SUCCESS);
  SLEW_CHECK(CVodeSetUserData(m.cvode, &m) == CV_SUCCESS);
  SLEW_CHECK(CVodeWFtolerances(m.cvode, Memory::error_weights) == CV_SUCCESS);
  SLEW_CHECK(CVodeSetLinearSolver(m.cvode, m.solver, m.matrix) == CV_SUCCESS);
  SLEW_CHECK(CVodeSetJacFn(m.cvode, Memory::jacobian) == CV_SUCCESS);
  SLEW_CHECK(CVodeSetErrHandlerFn(m.cvode, ignore_message, nullptr) == CV_SUCCESS);
  // one empty step: CVODE allocates the rest of its memory in its first step
  realtype reached = 0;
  SLEW_CHECK(CVode(m.cvode, 1, m.z, &reached, CV_ONE_STEP) >= 0);
}

CvodeStepper::~CvodeStepper() = default;

void CvodeStepper::begin_at(std::span<const double> y, StiffReport& report) noexcept {
  Memory& m = *memory_;
  std::fill(m.offset.begin(), m.offset.end(), 0.0);
  realtype* const z = N_VGetArrayPointer(m.z);
  for (std::size_t i = 0; i < y.size(); ++i) z[i] = m.measure_of(i, y[i]);
  SLEW_CHECK(CVodeReInit(m.cvode, 0, m.z) == CV_SUCCESS);
  t_ = 0;
  has_history_ = true;
  ++report.restarts;
}

// (1), or a new start after a jump.
void CvodeStepper::take_along(std::span<const double> y, StiffReport& report) noexcept {
  if (!has_history_ || !take_move(reached_, y)) begin_at(y, report);
}

// A move of y from outside as an offset (1); false: too large for an offset.
bool CvodeStepper::take_move(std::span<const double> before, std::span<const double> after) noexcept {
  Memory& m = *memory_;
  for (std::size_t i = 0; i < after.size(); ++i) {
    moved_[i] = after[i] == before[i] ? 0 : m.measure_of(i, after[i]) - m.measure_of(i, before[i]);
    if (!(std::fabs(moved_[i]) <= kJump * options_.size_of(i, after[i]))) return false;
  }
  for (std::size_t i = 0; i < after.size(); ++i) m.offset[i] += moved_[i];
  return true;
}

StiffReport CvodeStepper::advance(StiffSystem& system, std::span<double> y, double duration) noexcept {
  Memory& m = *memory_;
  StiffReport report;
  m.system = &system;
  take_along(y, report);
  double done = 0;    // part of the interval before its last restart
  double begin = t_;  // start of the part after it
  bool is_fresh = report.restarts > 0;
  long failures_before = 0, failures = 0;
  CVodeGetNumErrTestFails(m.cvode, &failures_before);
  if (is_fresh) failures_before = 0;
  double t_end = begin + duration;
  while (t_ < t_end && report.accepted < kMostSteps) {
    system.derivative(y.data(), f_.data());
    realtype reached = t_;
    int flag = CVodeSetStopTime(m.cvode, t_end);
    if (flag == CV_SUCCESS) flag = CVode(m.cvode, t_end, m.z, &reached, CV_ONE_STEP);
    if (flag < 0) {
      // retry once from here without the past
      if (is_fresh) break;
      done += t_ - begin;
      begin_at(y, report);
      begin = 0, t_end = duration - done, is_fresh = true;
      continue;
    }
    is_fresh = false;
    const double h = reached - t_;
    t_ = reached;
    ++report.accepted;
    const realtype* const z = N_VGetArrayPointer(m.z);
    for (std::size_t i = 0; i < y.size(); ++i) given_[i] = new_[i] = m.state_of(i, z[i] + m.offset[i]);
    system.accepted(h, y.data(), f_.data(), new_.data());
    std::copy(new_.begin(), new_.end(), y.begin());
    if (new_ != given_ && !take_move(given_, new_)) {
      done += t_ - begin;
      begin_at(y, report);
      begin = 0, t_end = duration - done;
    }
  }
  CVodeGetNumErrTestFails(m.cvode, &failures);
  report.rejected = static_cast<std::uint32_t>(std::max(0L, failures - failures_before));
  if (t_ < t_end) {
    report.is_finite = false;
    report.is_over_budget = report.accepted >= kMostSteps;
    report.worst_state = worst_state();
    has_history_ = false;
  }
  std::copy(y.begin(), y.end(), reached_.begin());
  m.system = nullptr;
  return report;
}

std::int32_t CvodeStepper::worst_state() const noexcept {
  Memory& m = *memory_;
  for (std::size_t i = 0; i < f_.size(); ++i) {
    if (!std::isfinite(f_[i])) return static_cast<std::int32_t>(i);
  }
  if (CVodeGetEstLocalErrors(m.cvode, m.work) != CV_SUCCESS || CVodeGetErrWeights(m.cvode, m.weights) != CV_SUCCESS) {
    return -1;
  }
  const double* const error = N_VGetArrayPointer(m.work);
  const double* const weight = N_VGetArrayPointer(m.weights);
  std::size_t worst = 0;
  for (std::size_t i = 0; i < f_.size(); ++i) {
    if (!(std::fabs(error[i]) * weight[i] <= std::fabs(error[worst]) * weight[worst])) worst = i;
  }
  return static_cast<std::int32_t>(worst);
}

double CvodeStepper::step_size() const noexcept {
  realtype h = 0;
  if (!has_history_ || CVodeGetCurrentStep(memory_->cvode, &h) != CV_SUCCESS) return 0;
  return h;
}

void CvodeStepper::add_to(StateHash& hash) const noexcept {
  Memory& m = *memory_;
  hash.add(has_history_);
  if (!has_history_) return;
  hash.add(t_);
  hash.add(std::span<const double>(m.offset));
  hash.add(step_size());
  int order = 0;
  long steps = 0;
  CVodeGetLastOrder(m.cvode, &order);
  CVodeGetNumSteps(m.cvode, &steps);
  hash.add(order);
  for (int k = 1; steps > 0 && k <= order; ++k) {
    if (CVodeGetDky(m.cvode, t_, k, m.work) != CV_SUCCESS) continue;
    hash.add(std::span<const double>(N_VGetArrayPointer(m.work), m.y.size()));
  }
}

}  // namespace slew::math
