// SPDX-License-Identifier: Apache-2.0
#include "diagram/symbol.h"

#include <array>
#include <utility>

#include "core/display.h"
#include "diagram/symbol_parts.h"

namespace slew::diagram {
namespace {

using hydraulics::ComponentDef;
using hydraulics::member_of;

const SymbolRow* find_row(std::string_view type) noexcept {
  for (const std::span<const SymbolRow> rows :
       {supply_symbols(), actuator_symbols(), directional_symbols(), pressure_symbols(), flow_symbols()}) {
    for (const SymbolRow& row : rows) {
      if (row.type == type) return &row;
    }
  }
  return nullptr;
}

// Figures beside a symbol: the value of a field, with words before and after it.
struct Figure {
  std::string_view type, key, before = {}, after = {};
};
constexpr Figure kFigures[] = {
    {"line", "diameter"},
    {"line", "length"},
    {"flow_divider", "nominal_flow"},
    {"shuttle_valve", "nominal_flow"},
    {"flushing_valve", "nominal_flow"},
    {"unloading_valve", "cut_out_pressure", "out "},
    {"unloading_valve", "cut_in_pressure", "in "},
    {"gear_flow_divider", "displacement_2"},
    {"gear_flow_divider", "displacement_3"},
    {"hose", "diameter"},
    {"hose", "length"},
    {"hydraulic_motor", "displacement"},
    {"hydraulic_motor", "gear_ratio", "gear "},
    {"l90ls_valve", "nominal_flow_pa", "P-A "},
    {"l90ls_valve", "compensator_pressure", "comp. "},
    {"four_way_valve", "edge_area"},
    {"spool_valve", "area_pa", "P-A "},
    {"spool_valve", "area_pb", "P-B "},
    {"spool_valve", "bypass_area", "bypass "},
    {"relief_valve", "setting_pressure"},
    {"direct_relief_valve", "crack_pressure"},
    {"reducing_valve", "setting_pressure"},
    {"check_valve", "nominal_flow"},
    {"check_valve", "crack_pressure"},
    {"throttle_check_valve", "throttle_flow"},
    {"pilot_check_valve", "pilot_ratio", "", ":1"},
    {"double_pilot_check_valve", "pilot_ratio", "", ":1"},
    {"counterbalance_valve", "setting_pressure"},
    {"counterbalance_valve", "pilot_ratio", "", ":1"},
    {"hose_burst_valve", "closing_flow", "shuts at "},
    {"accumulator", "gas_volume"},
    {"accumulator", "precharge_pressure"},
    {"compensated_orifice", "area"},
    {"compensated_orifice", "compensator_pressure"},
    {"post_compensator", "spring_pressure"},
    {"priority_valve", "nominal_flow"},
    {"priority_valve", "spring_pressure"},
    {"ls_pump", "displacement"},
    {"ls_pump", "set_pressure", "margin "},
    {"ls_pump", "speed"},
    {"pump", "displacement"},
    {"pump", "speed"},
    {"pump", "maximum_pressure", "max. "},
    {"engine", "speed"},
    {"flow_source", "flow"},
    {"pressure_source", "set_pressure"},
    {"bleed", "nominal_flow"},
    {"bleed", "nominal_pressure_drop", "at "},
    {"orifice", "diameter"},
    {"laminar_restriction", "diameter"},
    {"laminar_restriction", "length"},
    {"filter", "nominal_flow"},
    {"cooler", "conductance"},
    {"heat_loss", "conductance"},
};

std::string value_text(const ComponentDef& def, std::string_view key) {
  if (find_field(def, key)->dimension == Dimension::area) return fmt::format("{:.6g} mm2", 1e6 * number_of(def, key));
  return chosen_text(number_of(def, key), info(find_field(def, key)->dimension).si_unit);
}

// bore and rod, and the stroke
std::vector<std::string> cylinder_figures(const ComponentDef& def) {
  std::string bore = fmt::format("{:.6g} mm", 1e3 * number_of(def, "piston_diameter"));
  if (is_set(def, "rod_diameter")) {
    bore =
        fmt::format("{:.6g}/{:.6g} mm", 1e3 * number_of(def, "piston_diameter"), 1e3 * number_of(def, "rod_diameter"));
  }
  const double stroke = number_of(def, "maximum_stroke") - number_of(def, "minimum_stroke");
  return {std::move(bore), fmt::format("stroke {:.6g} mm", 1e3 * stroke)};
}

// diameters of the stages, and the stroke
std::vector<std::string> telescopic_figures(const ComponentDef& def) {
  std::string diameters;
  for (const auto& stage : member_of<Table>(def, "stages")) {
    diameters += fmt::format("{}{:.6g}", diameters.empty() ? "" : "/", 1e3 * stage[1]);
  }
  const double stroke = number_of(def, "maximum_stroke") - number_of(def, "minimum_stroke");
  return {diameters + " mm", fmt::format("stroke {:.6g} mm", 1e3 * stroke)};
}

}  // namespace

std::string text_of(const ComponentDef& def, std::string_view key) {
  return member_of<std::string>(def, key);
}

double number_of(const ComponentDef& def, std::string_view key) {
  return member_of<double>(def, key);
}

bool is_set(const ComponentDef& def, std::string_view key) {
  return number_of(def, key) != 0 || !text_of(def, key).empty() || member_of<bool>(def, key);
}

void add_pilot(Symbol& symbol, const ComponentDef& def, std::string_view key, double lane, Point from, Role role) {
  std::string net = text_of(def, key);
  if (net.empty()) return;
  symbol.ports.push_back({.key = std::string(key),
                          .net = std::move(net),
                          .role = role,
                          .side = Side::either,
                          .lane = lane,
                          .from_x = from.x,
                          .from_y = from.y});
}

Symbol symbol_of(const ComponentDef& def) {
  return find_row(def.type_name())->draw(def);
}

bool has_symbol(std::string_view type) noexcept {
  return find_row(type) != nullptr;
}

Symbol fixed_pressure_symbol(const std::string& volume) {
  Pen pen;
  pen.filled("M16 8L26 26L6 26Z");
  pen.line({16, 8}, {16, 0});
  pen.line({6, 31}, {26, 31});
  Symbol symbol{.width = 32, .height = 32, .drawing = pen.take(), .place = Place::supply};
  symbol.ports.push_back(
      {.key = "", .net = volume, .role = Role::outlet, .side = Side::top, .lane = 16, .from_x = 16, .from_y = 0});
  return symbol;
}

void turn_over(Symbol& symbol) {
  symbol.is_turned = !symbol.is_turned;
  for (Port& port : symbol.ports) {
    port.from_y = symbol.height - port.from_y;
    if (port.side != Side::either) port.side = port.side == Side::top ? Side::bottom : Side::top;
  }
}

std::vector<std::string> figures_of(const ComponentDef& def) {
  if (is_set(def, "piston_diameter")) return cylinder_figures(def);
  if (find_field(def, "stages") != nullptr) return telescopic_figures(def);
  std::vector<std::string> texts;
  for (const Figure& figure : kFigures) {
    if (figure.type != def.type_name() || !is_set(def, figure.key)) continue;
    texts.push_back(fmt::format("{}{}{}", figure.before, value_text(def, figure.key), figure.after));
  }
  return texts;
}

}  // namespace slew::diagram
