#include "coupling/static_forces.h"

#include <algorithm>

#include "core/check.h"
#include "coupling/samples.h"
#include "math/small_solve.h"

namespace slew::coupling {

bool static_forces(std::span<const double> W, std::span<const double> a_free, std::span<double> F) noexcept {
  const std::size_t m = a_free.size();
  SLEW_CHECK(m <= kMaxPorts && F.size() == m && W.size() == m * m);
  PortMatrix matrix;
  matrix.resize(m * m);
  std::copy(W.begin(), W.end(), matrix.begin());
  for (std::size_t i = 0; i < m; ++i) F[i] = -a_free[i];
  return math::solve_in_place(matrix.data(), F.data(), m, 1);
}

}  // namespace slew::coupling
