// SPDX-License-Identifier: Apache-2.0
// The varied values of a parameter sweep, and the rows that choose one value of each.
//
//   Bag.mass=200kg..1500kg:50      50 values at equal distances, both ends included (grid); without a count a range
//                                  from which random and lhs draw
//   L=2m,2.5m,3m                   the values themselves
//
// The path is that of `--set`: a value of the scene, or a parameter of the scene language. Both ends of a range are in
// one unit, and its values are formed in this unit.
// Samples: random takes independent uniform values; lhs (Latin hypercube: McKay, Beckman, Conover 1979, Technometrics
// 21, p. 239) divides each range into as many equal parts as there are rows and takes one value in each part, in
// random order. The same seed gives the same rows on every machine.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/tradeoff/grid.h"

namespace slew::analysis {

inline constexpr std::size_t kMostSweepRows = 100'000;

enum class Sampling { grid, random, lhs };

struct Variation {
  struct Range {
    double from = 0, to = 0;  // in the unit
    int count = 0;            // of a grid; 0: none
  };

  std::string path;
  std::string unit;                 // of the numbers: that of the range, or SI for a list; empty: a number
  std::optional<Range> range{};     // none: a list
  std::vector<std::string> list{};  // values as texts
  std::vector<double> numbers{};    // of the list in the unit; empty: words, or of several dimensions

  // Value at this part of the range, 0 to 1, or of the list, as a text for --set.
  [[nodiscard]] std::string value_at(double part) const;
};

// Values of the grid along this variation, as texts for --set.
[[nodiscard]] std::vector<std::string> grid_values(const Variation& variation);

// option: that of the command line which the text belongs to. Throws Failure (bad_input).
[[nodiscard]] Variation parse_variation(const std::string& text, Sampling sampling,
                                        const std::string& option = "--vary");

// Rows in order; of a grid the last variation changes fastest. samples: rows of random and lhs. Throws Failure
// (bad_input) for more than kMostSweepRows.
[[nodiscard]] std::vector<Settings> sweep_rows(std::span<const Variation> variations, Sampling sampling,
                                               std::size_t samples, std::uint64_t seed);

// The number of a row's value in the variation's unit, "200 kg": 200; none: a word.
[[nodiscard]] std::optional<double> number_of(const Variation& variation, const std::string& value);

}  // namespace slew::analysis
