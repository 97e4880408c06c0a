// SPDX-License-Identifier: Apache-2.0
#include "analysis/parameter_sweep/variation.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>

#include "core/failure.h"
#include "scene/expression.h"
#include "scene/number.h"

namespace slew::analysis {
namespace {

[[noreturn]] void refuse_variation(const std::string& option, const std::string& why) {
  throw Failure(ExitCode::bad_input, fmt::format("{}: {}; nothing was run; write PATH=FROM..TO:COUNT, such as "
                                                 "'Bag.mass=200kg..1500kg:50', or PATH=VALUE,VALUE,...",
                                                 option, why));
}

// Uniform in [0, 1) and whole numbers from the generator's bits: the distributions of the standard library differ
// between its makers.
class Generator {
 public:
  explicit Generator(std::uint64_t seed) : engine_(seed) {}
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  // 0 to count - 1; the remainder prefers small numbers by less than count / 2^64
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(engine_() % count); }

 private:
  std::mt19937_64 engine_;
};

std::vector<std::size_t> permutation(std::size_t count, Generator& generator) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[generator.below(i)]);
  return order;
}

void read_range(const std::string& option, const std::string& values, std::size_t dots, Sampling sampling,
                Variation& variation) {
  const std::size_t colon = values.rfind(':');
  const std::string_view all = values;
  const scene::NumberText from = scene::split_number(all.substr(0, dots));
  const scene::NumberText to =
      scene::split_number(all.substr(dots + 2, colon == std::string::npos ? colon : colon - dots - 2));
  for (const scene::NumberText& end : {from, to}) {
    if (!end.is_number) refuse_variation(option, end.problem.what);
  }
  if (!from.rest.empty() && from.rest != to.rest) {
    refuse_variation(option, fmt::format("the ends are in '{}' and '{}', one unit is needed", from.rest, to.rest));
  }
  variation.unit = to.rest;
  variation.range = {static_cast<double>(from.value), static_cast<double>(to.value), 0};
  if (variation.range->from == variation.range->to) refuse_variation(option, "both ends are the same value");
  if (colon == std::string::npos) {
    if (sampling == Sampling::grid) refuse_variation(option, "a grid needs the number of values behind ':'");
    return;
  }
  if (sampling != Sampling::grid) {
    refuse_variation(option, "a count belongs to --sample grid; --samples gives the rows of random and lhs");
  }
  int& count = variation.range->count;
  const char* end = values.data() + values.size();
  const auto [rest, error] = std::from_chars(values.data() + colon + 1, end, count);
  if (error != std::errc() || rest != end || count < 2 || count > static_cast<int>(kMostSweepRows)) {
    refuse_variation(option, fmt::format("'{}' is no count of 2 to {}", values.substr(colon + 1), kMostSweepRows));
  }
}

void read_numbers(Variation& variation) {
  scene::UnitSystem units;
  scene::Exponents exponent{};
  for (const std::string& value : variation.list) {
    const scene::NamedQuantity found = scene::quantity_of(value, units);
    const bool is_first = variation.numbers.empty();
    if (!found.quantity || (!is_first && found.quantity->exponent != exponent)) {
      variation.numbers.clear();
      return;
    }
    exponent = found.quantity->exponent;
    variation.numbers.push_back(found.quantity->value);
  }
  variation.unit = scene::si_unit_of(exponent);
}

std::vector<Settings> grid_rows(std::span<const Variation> variations) {
  std::vector<Settings> rows = {{}};
  for (const Variation& variation : variations) {
    const std::vector<std::string> values = grid_values(variation);
    if (rows.size() * values.size() > kMostSweepRows) {
      throw Failure(ExitCode::bad_input,
                    fmt::format("the grid has more than {} rows; nothing was run; give fewer values, or use "
                                "--sample lhs --samples N",
                                kMostSweepRows));
    }
    std::vector<Settings> longer;
    for (const Settings& row : rows) {
      for (const std::string& value : values) {
        longer.push_back(row);
        longer.back().emplace_back(variation.path, value);
      }
    }
    rows = std::move(longer);
  }
  return rows;
}

}  // namespace

std::string Variation::value_at(double part) const {
  if (!range) {
    const auto index = static_cast<std::size_t>(part * static_cast<double>(list.size()));
    return list[std::min(index, list.size() - 1)];
  }
  // exact at both ends
  const double value = part < 1 ? range->from + (range->to - range->from) * part : range->to;
  return unit.empty() ? fmt::format("{}", value) : fmt::format("{} {}", value, unit);
}

std::vector<std::string> grid_values(const Variation& variation) {
  if (!variation.range) return variation.list;
  std::vector<std::string> values;
  for (int i = 0; i < variation.range->count; ++i) {
    values.push_back(variation.value_at(static_cast<double>(i) / (variation.range->count - 1)));
  }
  return values;
}

Variation parse_variation(const std::string& text, Sampling sampling, const std::string& option) {
  const std::string place = option + " " + text;
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) refuse_variation(place, "'=' is missing");
  const std::string values = text.substr(equals + 1);
  Variation variation{.path = text.substr(0, equals), .unit = ""};
  if (const std::size_t dots = values.find(".."); dots != std::string::npos) {
    read_range(place, values, dots, sampling, variation);
    return variation;
  }
  try {
    variation.list = parse_axis(text).values;
  } catch (const Failure&) {
    refuse_variation(place, "there is no list of values");
  }
  read_numbers(variation);
  return variation;
}

std::vector<Settings> sweep_rows(std::span<const Variation> variations, Sampling sampling, std::size_t samples,
                                 std::uint64_t seed) {
  if (sampling == Sampling::grid) return grid_rows(variations);
  std::vector<Settings> rows(samples);
  Generator generator(seed);
  for (const Variation& variation : variations) {
    std::vector<std::size_t> part_of_row;
    if (sampling == Sampling::lhs) part_of_row = permutation(samples, generator);
    for (std::size_t i = 0; i < samples; ++i) {
      const double u = generator.uniform();
      const double part =
          sampling == Sampling::lhs ? (static_cast<double>(part_of_row[i]) + u) / static_cast<double>(samples) : u;
      rows[i].emplace_back(variation.path, variation.value_at(part));
    }
  }
  return rows;
}

std::optional<double> number_of(const Variation& variation, const std::string& value) {
  if (variation.range) return static_cast<double>(scene::split_number(value).value);
  if (variation.numbers.empty()) return std::nullopt;
  const auto at = std::find(variation.list.begin(), variation.list.end(), value);
  return variation.numbers[static_cast<std::size_t>(at - variation.list.begin())];
}

}  // namespace slew::analysis
