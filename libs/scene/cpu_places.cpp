// SPDX-License-Identifier: Apache-2.0
#include "scene/cpu_places.h"

#include <algorithm>
#include <charconv>
#include <string_view>

#include <fmt/format.h>

#include "core/node_names.h"

namespace slew::scene {
namespace {

constexpr int kMostCpus = 1024;

std::string_view without_spaces(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

Status wrong(std::string_view item, const std::string& what) {
  return Status::error(ExitCode::bad_input, "'" + std::string(item) + "' " + what);
}

}  // namespace

Status parse_cpu_places(const std::string& text, std::vector<CpuPlace>& places) {
  places.clear();
  std::string_view rest = without_spaces(text);
  while (!rest.empty()) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    const std::string_view item = without_spaces(rest.substr(0, comma));
    rest = comma < rest.size() ? rest.substr(comma + 1) : std::string_view();
    const std::size_t equals = item.find('=');
    if (equals == std::string_view::npos) return wrong(item, "is no role=number");
    const std::string_view role = without_spaces(item.substr(0, equals)),
                           number = without_spaces(item.substr(equals + 1));
    if (std::find(std::begin(kNodeNames), std::end(kNodeNames), role) == std::end(kNodeNames)) {
      return wrong(role, fmt::format("is no role: {}", fmt::join(kNodeNames, ", ")));
    }
    int cpu = -1;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), cpu);
    if (error != std::errc() || end != number.data() + number.size() || cpu < 0 || cpu >= kMostCpus) {
      return wrong(number, "is no number of a processor");
    }
    if (std::any_of(places.begin(), places.end(), [&](const CpuPlace& place) { return place.role == role; })) {
      return wrong(role, "stands there twice");
    }
    places.push_back({std::string(role), cpu});
  }
  return Status::ok();
}

}  // namespace slew::scene
