// SPDX-License-Identifier: Apache-2.0
#include "tests/validation/cosimulation/explicit_schemes.h"

#include <algorithm>

#include "tests/support/reference_algebra.h"

namespace slew::cosimulation {
namespace {

using Eigen::Matrix2d;
using Matrix = testing::Dense<double>;

// (x, v) of one mass after H, of its own start and of what is held: x' = v, m v' = -k x - c v + b . held
struct Half {
  Matrix2d own, held;
};

Half half(double m, double k, double c, const Eigen::RowVector2d& b, double H) {
  Matrix A(4, 4);
  A(0, 1) = 1;
  A(1, 0) = -k / m;
  A(1, 1) = -c / m;
  A(1, 2) = b[0] / m;
  A(1, 3) = b[1] / m;
  const Matrix E = testing::exponential(A * H);
  Half result;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      result.own(i, j) = E(i, j);
      result.held(i, j) = E(i, j + 2);
    }
  }
  return result;
}

}  // namespace

Map exact_map(const TwoMasses& s, double H) {
  Matrix A(4, 4);
  A(0, 1) = A(2, 3) = 1;
  A(1, 0) = -(s.k1 + s.kc) / s.m1, A(1, 1) = -(s.c1 + s.cc) / s.m1, A(1, 2) = s.kc / s.m1, A(1, 3) = s.cc / s.m1;
  A(3, 0) = s.kc / s.m2, A(3, 1) = s.cc / s.m2, A(3, 2) = -(s.k2 + s.kc) / s.m2, A(3, 3) = -(s.c2 + s.cc) / s.m2;
  return Map(testing::exponential(A * H).data());
}

Map step_map(const TwoMasses& s, Coupling coupling, Order order, double H) {
  const bool is_force = coupling == Coupling::force_displacement;
  const Half first = half(s.m1, s.k1 + s.kc, s.c1 + s.cc, {s.kc, s.cc}, H);
  const Half second =
      is_force ? half(s.m2, s.k2, s.c2, {1, 0}, H) : half(s.m2, s.k2 + s.kc, s.c2 + s.cc, {s.kc, s.cc}, H);
  // what the half of m2 holds, of (x1, v1) and of (x2, v2) at the start of the step
  Matrix2d of_1 = Matrix2d::Identity(), of_2 = Matrix2d::Zero();
  if (is_force) {
    of_1 << s.kc, s.cc, 0, 0;
    of_2 = -of_1;
  }
  Map map;
  const auto put = [&map](int row, const Matrix2d& from_1, const Matrix2d& from_2) {
    map.block<2, 2>(row, 0) = from_1;
    map.block<2, 2>(row, 2) = from_2;
  };
  const Matrix2d second_own = second.own + second.held * of_2;
  if (order == Order::first_2_then_1) {
    put(2, second.held * of_1, second_own);
    put(0, first.own + first.held * map.block<2, 2>(2, 0), first.held * map.block<2, 2>(2, 2));
    return map;
  }
  put(0, first.own, first.held);
  if (order == Order::jacobi) {
    put(2, second.held * of_1, second_own);
  } else {
    put(2, second.held * of_1 * first.own, second.held * of_1 * first.held + second_own);
  }
  return map;
}

double spectral_radius(const Map& map) {
  Matrix A(4, 4);
  std::copy(map.data(), map.data() + map.size(), A.data());
  return testing::spectral_radius(A);
}

double energy(const TwoMasses& s, const State& y) {
  const double stretch = y[0] - y[2];
  return 0.5 *
         (s.m1 * y[1] * y[1] + s.m2 * y[3] * y[3] + s.k1 * y[0] * y[0] + s.kc * stretch * stretch + s.k2 * y[2] * y[2]);
}

State after(const Map& map, int steps, State state) {
  for (int i = 0; i < steps; ++i) state = (map * state).eval();
  return state;
}

}  // namespace slew::cosimulation
