#include "tests/validation/flexible/small_motion.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "multibody/passes.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody::testing {

std::vector<std::complex<double>> eigenvalues(const SquareMatrix& A) {
  const auto n = static_cast<Eigen::Index>(A.n);
  const Eigen::MatrixXd matrix = Eigen::Map<const Eigen::MatrixXd>(A.values.data(), n, n);
  const Eigen::VectorXcd values = Eigen::EigenSolver<Eigen::MatrixXd>(matrix, false).eigenvalues();
  return {values.begin(), values.end()};
}

std::vector<double> squares_of(const MechanicsDef& def) {
  constexpr double kProbe = 1e-6;
  const Model model = build_model(def);
  Workspace ws(model);
  const State start = start_state(model);
  SquareMatrix A(start.u.size());
  const std::vector<double> rest(start.u.size());
  std::vector<double> rate(start.q.size());
  for (std::size_t j = 0; j < A.n; ++j) {
    for (const double sign : {1.0, -1.0}) {
      State moved = start;
      moved.u[j] = 1;
      update_motion(model, moved.q, moved.u, ws);
      coordinate_rates(model, ws, moved.q, moved.u, rate);
      for (std::size_t k = 0; k < rate.size(); ++k) moved.q[k] += sign * kProbe * rate[k];
      moved.u = rest;
      normalize_quaternions(model, moved.q);
      evaluate(model, moved, ws);
      for (std::size_t i = 0; i < A.n; ++i) A(i, j) -= sign * ws.udot[i] / (2 * kProbe);
    }
  }
  std::vector<double> squares;
  for (const std::complex<double> square : eigenvalues(A)) squares.push_back(square.real());
  std::sort(squares.begin(), squares.end());
  return squares;
}

}  // namespace slew::multibody::testing
