// SPDX-License-Identifier: Apache-2.0
// Fields and rules that the definitions of several components share.
#pragma once

#include <string>
#include <string_view>

#include "core/field.h"
#include "core/problem.h"

namespace slew::hydraulics {

[[nodiscard]] constexpr FieldOptions port_options(std::string_view doc) {
  return {.presence = Presence::required, .reference = "volume", .doc = doc};
}
[[nodiscard]] constexpr FieldOptions nominal_flow_options(std::string_view doc) {
  return {.dimension = Dimension::volume_flow,
          .range = kPositive,
          .presence = Presence::required,
          .change = Change::live,
          .doc = doc};
}
inline constexpr FieldOptions kNominalPressureDrop{
    .dimension = Dimension::pressure, .range = kPositive, .doc = "pressure drop of nominal_flow"};
[[nodiscard]] constexpr FieldOptions step_response_options(std::string_view doc) {
  return {.dimension = Dimension::time, .range = kPositive, .change = Change::live, .doc = doc};
}

// A rule: two ports are connected to two volumes. path: of the second one's key. Absent ports are not compared.
void check_distinct(const std::string& path, const std::string& first, const std::string& second, Problems& errors);

// The same between all of port_1, port_2 and port_3.
template <typename Def>
void check_three_ports(const Def& def, Problems& errors) {
  check_distinct(def.name + ".port_2", def.port_1, def.port_2, errors);
  check_distinct(def.name + ".port_3", def.port_1, def.port_3, errors);
  check_distinct(def.name + ".port_3", def.port_2, def.port_3, errors);
}

}  // namespace slew::hydraulics
