// SPDX-License-Identifier: Apache-2.0
// The circuit with masses on its pistons, integrated by RODAS3 and by SUNDIALS CVODE from the same right-hand side.
#include <cvode/cvode.h>
#include <gtest/gtest.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>
#include <cmath>

#include "hydraulics/circuit_integrator.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace slew::hydraulics::test {
namespace cvode_test {

// Circuit and pistons as one right-hand side.
struct Coupled {
  Circuit& circuit;
  const MassLoad& load;
  void rates(const double* y, double* f) const {
    circuit.rates(y, f);
    double F[3];
    circuit.pressure_forces(y, F);
    load.accelerations(F, y + circuit.position(0), y + circuit.speed(0), f + circuit.speed(0));
  }
};

int cvode_rates(realtype, N_Vector y, N_Vector f, void* user) {
  static_cast<const Coupled*>(user)->rates(N_VGetArrayPointer(y), N_VGetArrayPointer(f));
  return 0;
}

// CVODE BDF with absolute tolerances of the states' scales.
class Cvode {
 public:
  Cvode(Coupled& system, std::span<const double> y_0) {
    SUNContext_Create(nullptr, &context_);
    const auto n = static_cast<sunindextype>(y_0.size());
    y_ = N_VNew_Serial(n, context_);
    tolerance_ = N_VNew_Serial(n, context_);
    std::copy(y_0.begin(), y_0.end(), N_VGetArrayPointer(y_));
    for (std::size_t i = 0; i < y_0.size(); ++i) {
      N_VGetArrayPointer(tolerance_)[i] = 1e-9 * system.circuit.scales()[i];
    }
    matrix_ = SUNDenseMatrix(n, n, context_);
    solver_ = SUNLinSol_Dense(y_, matrix_, context_);
    cvode_ = CVodeCreate(CV_BDF, context_);
    CVodeInit(cvode_, cvode_rates, 0, y_);
    CVodeSVtolerances(cvode_, 1e-9, tolerance_);
    CVodeSetUserData(cvode_, &system);
    CVodeSetLinearSolver(cvode_, solver_, matrix_);
    CVodeSetMaxNumSteps(cvode_, 1000000);
  }
  Cvode(const Cvode&) = delete;
  Cvode& operator=(const Cvode&) = delete;
  ~Cvode() {
    CVodeFree(&cvode_);
    SUNLinSolFree(solver_);
    SUNMatDestroy(matrix_);
    N_VDestroy(y_);
    N_VDestroy(tolerance_);
    SUNContext_Free(&context_);
  }

  // Continues to t; the inputs changed at t_input and not since.
  std::span<const double> advance(double t, double t_input) {
    if (t_input != last_input_) CVodeReInit(cvode_, t_input, y_);
    last_input_ = t_input;
    realtype reached = 0;
    CVodeSetStopTime(cvode_, t);
    EXPECT_GE(CVode(cvode_, t, y_, &reached, CV_NORMAL), 0);
    return {N_VGetArrayPointer(y_), static_cast<std::size_t>(N_VGetLength(y_))};
  }

 private:
  SUNContext context_ = nullptr;
  N_Vector y_ = nullptr, tolerance_ = nullptr;
  SUNMatrix matrix_ = nullptr;
  SUNLinearSolver solver_ = nullptr;
  void* cvode_ = nullptr;
  double last_input_ = 0;
};

TEST(CircuitIntegrator, agrees_with_cvode_over_lift_and_stop) {
  const HydraulicsDef def = crane_circuit();
  Circuit circuit(def), reference_circuit(def);
  CircuitIntegrator integrator(circuit, def);
  const MassLoad load = crane_load();
  integrator.start(kCraneStrokes, kAtRest, kCraneForces);
  Coupled system{reference_circuit, load};
  Cvode cvode(system, integrator.state());

  double worst_pressure = 0, worst_position = 0, t_input = 0;
  for (int k = 0; k < 2000; ++k) {
    const double t = k * 1e-3;
    if (k == 200 || k == 1200) {
      for (Circuit* c : {&circuit, &reference_circuit}) c->set_control(c->find_control("L90Lift"), k == 200 ? 500 : 0);
      t_input = t;
    }
    integrator.step(1e-3, load);
    const std::span<const double> expected = cvode.advance(t + 1e-3, t_input);
    for (int i = 0; i < circuit.volume_count(); ++i) {
      const auto v = static_cast<std::size_t>(i);
      worst_pressure = std::max(worst_pressure, std::fabs(integrator.state()[v] - expected[v]));
    }
    for (int j = 0; j < 3; ++j) {
      const auto x = static_cast<std::size_t>(circuit.position(j));
      worst_position = std::max(worst_position, std::fabs(integrator.state()[x] - expected[x]));
    }
  }
  RecordProperty("worst_pressure_bar", std::to_string(worst_pressure / kBar));
  // rtol 1e-4: the fast pump line is off by some hundredths of a bar while it rises by 100 bar
  EXPECT_LT(worst_pressure, 0.1 * kBar);
  EXPECT_LT(worst_position, 1e-6);
}

}  // namespace cvode_test
}  // namespace slew::hydraulics::test
