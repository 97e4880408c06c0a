// SPDX-License-Identifier: Apache-2.0
// One curve over time: plain numbers with a name and a unit, from any source.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace slew::plotting {

struct Series {
  std::string name;            // "Cyl_Lift.force"
  std::string unit;            // "kN", as it shall be shown; empty: dimensionless
  std::vector<double> time;    // s, ascending; a step back (a reset of the session) starts a new line
  std::vector<double> values;  // as many as times, in the unit; NaN and infinity are gaps
  double spacing = 0;          // s from one sample to the next where none is missing; 0: unknown
};

// Pairs of time and value.
[[nodiscard]] std::size_t size_of(const Series& curve) noexcept;

// Leaves the instants that every curve has. Variables of one node come in several messages, and any of them may be
// missing.
void keep_common_instants(std::span<Series> curves);

// Whether samples are missing between this one and the one in front of it. Pre-condition: i > 0.
[[nodiscard]] bool is_gap(const Series& curve, std::size_t i) noexcept;

// Puts NaN in the place of the first of missing samples, so that no line is drawn over them.
void part_at_gaps(std::span<Series> curves);

}  // namespace slew::plotting
