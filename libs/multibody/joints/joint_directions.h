// SPDX-License-Identifier: Apache-2.0
// Parts of the recursion that its two files share: entries of vectors by u, and free directions. Internal to the
// library.
#pragma once

#include <cstddef>
#include <span>

#include "multibody/model/state.h"

namespace slew::multibody {

inline void store(std::span<double> to, int first, math::Vec3 value) noexcept {
  to[static_cast<std::size_t>(first)] = value[0];
  to[static_cast<std::size_t>(first) + 1] = value[1];
  to[static_cast<std::size_t>(first) + 2] = value[2];
}

inline void put(math::Vec3 value, double* to) noexcept {
  for (int k = 0; k < 3; ++k) to[k] = value[k];
}

inline void subtract(math::Vec3 value, double* from) noexcept {
  for (int k = 0; k < 3; ++k) from[k] -= value[k];
}

[[nodiscard]] inline math::Vec3 vector_at(std::span<const double> from, std::size_t first) noexcept {
  return {from[first], from[first + 1], from[first + 2]};
}

[[nodiscard]] inline math::Vec3 load(std::span<const double> from, int first) noexcept {
  return {from[static_cast<std::size_t>(first)], from[static_cast<std::size_t>(first) + 1],
          from[static_cast<std::size_t>(first) + 2]};
}

[[nodiscard]] inline math::Vec3 load_pair(std::span<const double> from, int first) noexcept {
  return {from[static_cast<std::size_t>(first)], from[static_cast<std::size_t>(first) + 1], 0};
}

inline void store_pair(std::span<double> to, int first, math::Vec3 value) noexcept {
  to[static_cast<std::size_t>(first)] = value[0];
  to[static_cast<std::size_t>(first) + 1] = value[1];
}

// Free directions of a joint with two coordinates
struct Pair {
  math::Vec3 turn[2], slide[2];
};

[[nodiscard]] inline Pair directions(LinkJoint joint, const LinkMotion& m) noexcept {
  if (joint == LinkJoint::universal) return {{m.axis1, m.axis}, {}};
  return {{m.axis, math::Vec3()}, {math::Vec3(), m.axis}};
}

}  // namespace slew::multibody
