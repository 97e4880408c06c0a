// SPDX-License-Identifier: Apache-2.0
// Largest payload by cylinder, from the line forces at rest and the largest forces of the valves.
//
//   m_i = m_0 + (F_i,max - F_i(m_0)) / s_i                           a cylinder that moves a coordinate alone    (1)
//   m_b = m_0 + sum_i l_i (F_i,max - F_i(m_0)) / sum_i l_i s_i       cylinders on common volumes that move one
//                                                                    coordinate together                         (2)
// l: lever arms on the coordinate, from the range of the ports' mobility W (math/range_projector.h). In (2) all F_i,max
// are those of one command, and the split of F(m_0) and s between the cylinders has no effect.
//
// Refused by name: a carrying cylinder on a common volume whose pressure no valve holds at stall (cylinders or motors
// in series), since the load of the other one decides on it; and cylinders on common volumes that move several
// coordinates together, or one with a cylinder on volumes of its own.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/description/largest_force.h"

namespace slew::analysis {

struct StaticLoad {
  std::span<const double> W;      // mobility of the ports, row-major
  std::span<const double> F;      // N or Nm, with the payload at `mass`
  std::span<const double> slope;  // m/s2, by port; below kNoShare it does not carry the payload
  double mass = 0;                // kg, m_0
};

struct PortLimit {
  bool carries = false;
  LargestForce largest{};           // where it carries
  double load = 0;                  // kg, (1) or (2)
  std::vector<std::size_t> with{};  // the other cylinders of (2); empty: (1)
};

struct PortLimits {
  std::vector<PortLimit> ports;
  std::string refusal;  // why there are no loads; empty: there are
};

// a cylinder whose force changes by less with 1 kg does not carry the load: a hundred thousandth of its weight
inline constexpr double kNoShare = 1e-4;  // m/s2

[[nodiscard]] PortLimits find_port_limits(LargestForces& largest, const StaticLoad& load);

}  // namespace slew::analysis
