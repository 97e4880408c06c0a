// SPDX-License-Identifier: Apache-2.0
#include "tests/validation/flexible/small_motion.h"

#include <algorithm>

#include "multibody/formulations/passes.h"
#include "tests/support/reference_algebra.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody::testing {

std::vector<double> squares_of(const MechanicsDef& def) {
  constexpr double kProbe = 1e-6;
  const Model model = build_model(def);
  Workspace ws(model);
  const State start = start_state(model);
  const auto n = static_cast<slew::testing::Index>(start.u.size());
  slew::testing::Dense<double> A(n, n);
  const std::vector<double> rest(start.u.size());
  std::vector<double> rate(start.q.size());
  for (std::size_t j = 0; j < start.u.size(); ++j) {
    for (const double sign : {1.0, -1.0}) {
      State moved = start;
      moved.u[j] = 1;
      update_motion(model, moved.q, moved.u, ws);
      coordinate_rates(model, ws, moved.q, moved.u, rate);
      for (std::size_t k = 0; k < rate.size(); ++k) moved.q[k] += sign * kProbe * rate[k];
      moved.u = rest;
      normalize_quaternions(model, moved.q);
      evaluate(model, moved, ws);
      for (slew::testing::Index i = 0; i < n; ++i) {
        A(i, static_cast<slew::testing::Index>(j)) -= sign * ws.udot[static_cast<std::size_t>(i)] / (2 * kProbe);
      }
    }
  }
  std::vector<double> squares;
  for (const std::complex<double> square : slew::testing::eigenvalues(A)) squares.push_back(square.real());
  std::sort(squares.begin(), squares.end());
  return squares;
}

}  // namespace slew::multibody::testing
