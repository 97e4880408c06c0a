// SPDX-License-Identifier: Apache-2.0
// Attitudes in the coordinates of BodyState: reading, writing, rates, turns. Internal to the library.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "math/rotation.h"
#include "multibody/formulations/body_coordinates.h"

namespace slew::multibody {

[[nodiscard]] inline math::Quaternion attitude_at(std::span<const double> q, std::size_t link) noexcept {
  const std::size_t k = 7 * (link - 1) + 3;
  return {q[k], q[k + 1], q[k + 2], q[k + 3]};
}

inline void put_attitude(const math::Quaternion& attitude, std::span<double> q, std::size_t link) noexcept {
  const std::size_t k = 7 * (link - 1) + 3;
  q[k] = attitude.w;
  q[k + 1] = attitude.x;
  q[k + 2] = attitude.y;
  q[k + 3] = attitude.z;
}

inline void normalize_attitudes(BodyState& state) noexcept {
  for (std::size_t link = 1; link <= state.links(); ++link) {
    put_attitude(math::normalized(attitude_at(state.q, link)), state.q, link);
  }
}

// q' of a state
inline void find_rates(const BodyState& state, std::span<double> qdot) noexcept {
  const std::size_t links = state.links();
  for (std::size_t link = 1; link <= links; ++link) {
    const std::size_t u = 6 * (link - 1);
    std::copy_n(state.u.data() + u, 3, qdot.data() + 7 * (link - 1));
    const math::Vec3 w(state.u[u + 3], state.u[u + 4], state.u[u + 5]);
    put_attitude(math::derivative(attitude_at(state.q, link), w), qdot, link);
  }
  std::copy(state.u.begin() + static_cast<std::ptrdiff_t>(6 * links), state.u.end(), qdot.data() + 7 * links);
}

// y = x + scale rate
inline void combine(std::span<const double> x, double scale, std::span<const double> rate,
                    std::span<double> y) noexcept {
  for (std::size_t i = 0; i < x.size(); ++i) y[i] = x[i] + scale * rate[i];
}

}  // namespace slew::multibody
