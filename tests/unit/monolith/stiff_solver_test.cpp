// SPDX-License-Identifier: Apache-2.0
#include "monolith/stiff_solver.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace slew::monolith {
namespace stiff_solver_test {

// Robertson (1966), the usual test of stiff solvers
class Robertson final : public DifferentialEquation {
 public:
  void rates(double, const double* y, double* f) noexcept override {
    f[0] = -0.04 * y[0] + 1e4 * y[1] * y[2];
    f[2] = 3e7 * y[1] * y[1];
    f[1] = -f[0] - f[2];
  }
};

class Growth final : public DifferentialEquation {
 public:
  void rates(double, const double* y, double* f) noexcept override { f[0] = y[0] * y[0]; }
};

TEST(StiffSolver, FollowsRobertsonsKinetics) {
  Robertson equation;
  const std::array<double, 3> tolerance = {1e-12, 1e-16, 1e-12};
  StiffSolver solver(equation, tolerance, 1e-9);
  solver.restart(0, std::array<double, 3>{1, 0, 0});
  ASSERT_EQ(solver.advance(40), "");
  // Hairer and Wanner 1996, IV.10, from a run at 1e-14
  EXPECT_NEAR(solver.y()[0], 0.7158270687, 1e-8);
  EXPECT_NEAR(solver.y()[1], 9.185534765e-6, 1e-13);
  EXPECT_NEAR(solver.y()[2], 0.2841637457, 1e-8);
  EXPECT_EQ(solver.time(), 40);
}

TEST(StiffSolver, CountsOverRestarts) {
  Robertson equation;
  const std::array<double, 3> tolerance = {1e-9, 1e-12, 1e-9};
  StiffSolver solver(equation, tolerance, 1e-6);
  solver.restart(0, std::array<double, 3>{1, 0, 0});
  ASSERT_EQ(solver.advance(1), "");
  const SolverStatistics first = solver.statistics();
  const std::array<double, 3> middle = {solver.y()[0], solver.y()[1], solver.y()[2]};
  solver.restart(1, middle);
  ASSERT_EQ(solver.advance(2), "");
  EXPECT_GT(solver.statistics().steps, first.steps);
  EXPECT_GT(solver.statistics().right_hand_sides, first.right_hand_sides);
  EXPECT_EQ(solver.statistics().restarts, 2);
}

TEST(StiffSolver, NamesTheStateThatTheErrorTestIsAbout) {
  // a large state with a large error of which its relative tolerance allows more, and a small one that sets the step
  class Waves final : public DifferentialEquation {
   public:
    void rates(double t, const double*, double* f) noexcept override {
      f[0] = 1e3 * std::cos(t);
      f[1] = 3 * std::cos(3 * t);
    }
  };
  Waves equation;
  StiffSolver solver(equation, std::array<double, 2>{1e-6, 1e-6}, 1e-6);
  solver.restart(0, std::array<double, 2>{1e7, 0});
  for (int i = 1; i <= 10; ++i) {
    ASSERT_EQ(solver.advance(0.7 * i), "");
    EXPECT_EQ(solver.worst_state(), 1u) << i;
  }
}

// y' = -sign(y): from y = 0 on no step is short enough for the error test, and each advances a little
struct Chattering final : DifferentialEquation {
  void rates(double, const double* y, double* f) noexcept override { f[0] = y[0] > 0 ? -1e3 : 1e3; }
};

TEST(StiffSolver, EndsWhereItMakesNoProgress) {
  Chattering equation;
  StiffSolver solver(equation, std::array<double, 1>{1e-12}, 1e-9);
  solver.restart(0, std::array<double, 1>{1});
  const std::string failure = solver.advance(1);
  EXPECT_NE(failure.find("no progress: the last 10000 steps advanced it by"), std::string::npos) << failure;
  EXPECT_LT(solver.statistics().steps, 100'000);
  EXPECT_NEAR(solver.time(), 1e-3, 1e-4);
}

TEST(StiffSolver, ReportsThatASolutionEscapes) {
  // y = 1 / (1 - t) has no value at 1
  Growth equation;
  StiffSolver solver(equation, std::array<double, 1>{1e-9}, 1e-9);
  solver.restart(0, std::array<double, 1>{1});
  EXPECT_NE(solver.advance(2), "");
  EXPECT_NEAR(solver.time(), 1, 1e-3);
}

}  // namespace stiff_solver_test
}  // namespace slew::monolith
