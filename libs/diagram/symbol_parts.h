// SPDX-License-Identifier: Apache-2.0
// What the symbols of all families share. Internal to the library.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "diagram/pen.h"
#include "diagram/symbol.h"

namespace slew::diagram {

// Members of a component by the keys of its field table: empty and 0 for keys that the type does not have.
[[nodiscard]] std::string text_of(const hydraulics::ComponentDef& def, std::string_view key);
[[nodiscard]] double number_of(const hydraulics::ComponentDef& def, std::string_view key);
[[nodiscard]] bool is_set(const hydraulics::ComponentDef& def, std::string_view key);

// A port whose line leaves straight from the symbol's edge.
[[nodiscard]] inline Port straight(const hydraulics::ComponentDef& def, std::string_view key, Role role, Side side,
                                   double x, double y) {
  return {.key = std::string(key),
          .net = text_of(def, key),
          .role = role,
          .side = side,
          .lane = x,
          .from_x = x,
          .from_y = y};
}
// A pilot port at the symbol's side: the line goes to its lane first. Nothing where the scene names no volume.
void add_pilot(Symbol& symbol, const hydraulics::ComponentDef& def, std::string_view key, double lane, Point from,
               Role role = Role::pilot);

struct SymbolRow {
  std::string_view type;
  Symbol (*draw)(const hydraulics::ComponentDef& def);
};
[[nodiscard]] std::span<const SymbolRow> supply_symbols() noexcept;
[[nodiscard]] std::span<const SymbolRow> actuator_symbols() noexcept;
[[nodiscard]] std::span<const SymbolRow> directional_symbols() noexcept;
[[nodiscard]] std::span<const SymbolRow> pressure_symbols() noexcept;
[[nodiscard]] std::span<const SymbolRow> flow_symbols() noexcept;

}  // namespace slew::diagram
