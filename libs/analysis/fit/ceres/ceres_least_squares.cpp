// SPDX-License-Identifier: Apache-2.0
// The border's function with Ceres. Not with our flags: see least_squares_border.h.
#include <ceres/ceres.h>
#include <glog/logging.h>
#include <Eigen/Cholesky>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <vector>

#include "analysis/fit/least_squares_border.h"

namespace {

using slew::analysis::SquaresProblem;

// One block of all unknowns, one block of all residuals.
class SimulatedResiduals final : public ceres::CostFunction {
 public:
  explicit SimulatedResiduals(const SquaresProblem& problem) : problem_(problem) {
    mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.unknowns));
    set_num_residuals(static_cast<int>(problem.residuals));
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const std::size_t n = problem_.unknowns, m = problem_.residuals;
    const bool needs_jacobian = jacobians != nullptr && jacobians[0] != nullptr;
    const std::size_t count = needs_jacobian ? 1 + 2 * n : 1;
    // the point, then a step below and above it along each unknown
    std::vector<double> points;
    for (std::size_t p = 0; p < count; ++p) points.insert(points.end(), parameters[0], parameters[0] + n);
    for (std::size_t k = 0; needs_jacobian && k < n; ++k) {
      for (std::size_t side = 0; side < 2; ++side) {
        double& moved = points[(1 + 2 * k + side) * n + k];
        moved = std::clamp(moved + (side == 0 ? -1 : 1) * problem_.difference_step, 0.0, 1.0);
      }
    }
    std::vector<double> values(count * m);
    std::vector<unsigned char> has_value(count, 0);
    if (!problem_.residuals_at(problem_.context, points.data(), count, values.data(), has_value.data())) return false;
    if (std::find(has_value.begin(), has_value.end(), 0) != has_value.end()) return false;
    std::copy_n(values.begin(), m, residuals);
    for (std::size_t k = 0; needs_jacobian && k < n; ++k) {
      const std::size_t below = 1 + 2 * k, above = below + 1;
      const double step = points[above * n + k] - points[below * n + k];
      for (std::size_t i = 0; i < m; ++i) {
        jacobians[0][i * n + k] = (values[above * m + i] - values[below * m + i]) / step;
      }
    }
    return true;
  }

 private:
  const SquaresProblem& problem_;
};

// (S J' J S + e)^-1 with columns of length one by S, and e, which only bounds the variance of what J does not
// determine.
bool find_covariance(const SimulatedResiduals& cost, SquaresProblem& squares) {
  constexpr double kLeast = 1e-10;
  const auto n = static_cast<Eigen::Index>(squares.unknowns), m = static_cast<Eigen::Index>(squares.residuals);
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Map<RowMajor> J(squares.jacobian, m, n);
  const double* u = squares.u;
  if (!cost.Evaluate(&u, squares.residuals_at_u, &squares.jacobian)) return false;
  Eigen::Map<Eigen::VectorXd> lengths(squares.column_lengths, n);
  lengths = J.colwise().norm();
  const Eigen::VectorXd S = lengths.unaryExpr([](double length) { return length > 0 ? 1 / length : 1.0; });
  const Eigen::MatrixXd scaled = J * S.asDiagonal();
  const Eigen::MatrixXd normal = scaled.transpose() * scaled + kLeast * Eigen::MatrixXd::Identity(n, n);
  const Eigen::LLT<Eigen::MatrixXd> factors(normal);
  if (factors.info() != Eigen::Success) return false;
  Eigen::Map<Eigen::MatrixXd>(squares.covariance, n, n) =
      S.asDiagonal() * factors.solve(Eigen::MatrixXd::Identity(n, n)) * S.asDiagonal();
  return true;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) void slewring_minimise_squares(SquaresProblem& squares) {
  FLAGS_minloglevel = google::GLOG_FATAL;  // the caller reports what failed
  ceres::Problem problem;
  auto* const cost = new SimulatedResiduals(squares);
  problem.AddResidualBlock(cost, nullptr, squares.u);  // the problem owns it
  for (std::size_t k = 0; k < squares.unknowns; ++k) {
    problem.SetParameterLowerBound(squares.u, static_cast<int>(k), 0);
    problem.SetParameterUpperBound(squares.u, static_cast<int>(k), 1);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = squares.most_iterations;
  options.num_threads = 1;
  // a part of the sum that no unknown changes must not end the search: the unknowns at rest do
  options.function_tolerance = 1e-12;
  options.parameter_tolerance = 1e-6;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  squares.has_converged = summary.termination_type == ceres::CONVERGENCE;
  squares.iterations = summary.num_successful_steps + summary.num_unsuccessful_steps;
  // Ceres minimises half of the sum
  squares.squares_before = 2 * summary.initial_cost;
  squares.squares_after = 2 * summary.final_cost;
  std::snprintf(squares.reason, sizeof squares.reason, "%s", summary.message.c_str());
  squares.has_covariance = summary.IsSolutionUsable() && find_covariance(*cost, squares);
}
