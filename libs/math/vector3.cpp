// SPDX-License-Identifier: Apache-2.0
#include "math/vector3.h"

#include <algorithm>
#include <utility>

namespace slew::math {

std::array<double, 3> symmetric_eigenvalues(const Mat3& a) noexcept {
  double m[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m[i][j] = a(i, j);
  }
  constexpr int kSweeps = 12;  // quadratic convergence: 3 x 3 is done after about 6
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const auto& [p, q] : {std::pair{0, 1}, {0, 2}, {1, 2}}) {
      if (m[p][q] == 0) continue;
      const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
      const double t = (theta >= 0 ? 1 : -1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
      const double c = 1 / std::sqrt(t * t + 1), s = t * c;
      const int r = 3 - p - q;
      const double m_pq = m[p][q], m_rp = m[r][p], m_rq = m[r][q];
      m[p][p] -= t * m_pq;
      m[q][q] += t * m_pq;
      m[p][q] = m[q][p] = 0;
      m[r][p] = m[p][r] = c * m_rp - s * m_rq;
      m[r][q] = m[q][r] = s * m_rp + c * m_rq;
    }
  }
  std::array<double, 3> values = {m[0][0], m[1][1], m[2][2]};
  std::sort(values.begin(), values.end());
  return values;
}

}  // namespace slew::math
