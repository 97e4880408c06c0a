// SPDX-License-Identifier: Apache-2.0
// Pumps, sources, the engine, accumulators and lines.
#include "diagram/symbol_parts.h"

namespace slew::diagram {
namespace {

using hydraulics::ComponentDef;

// Circle of a machine with its axis at (x, 27), lines to the ports above and below.
constexpr double kMachineRadius = 20, kMachineAxis = 27, kMachineHeight = 54;

void draw_pump(Pen& pen, double x) {
  pen.circle({x, kMachineAxis}, kMachineRadius);
  pen.filled(fmt::format("M{:g} 7L{:g} 18L{:g} 18Z", x, x + 7, x - 7));
  pen.line({x, 0}, {x, kMachineAxis - kMachineRadius});
  pen.line({x, kMachineAxis + kMachineRadius}, {x, kMachineHeight});
}

// shaft to the right, a line of its own to the engine
void add_shaft(Symbol& symbol, Pen& pen, const ComponentDef& def, double x) {
  for (const double y : {kMachineAxis - 2, kMachineAxis + 2}) pen.line({x, y}, {x + 10, y});
  if (text_of(def, "engine").empty()) return;
  symbol.ports.push_back({.key = "engine",
                          .net = text_of(def, "engine"),
                          .role = Role::shaft,
                          .side = Side::bottom,
                          .lane = x + 14,
                          .from_x = x + 10,
                          .from_y = kMachineAxis});
}

Symbol pump_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 76, .height = kMachineHeight, .place = Place::supply};
  Pen pen;
  draw_pump(pen, 38);
  const bool is_over_centre = number_of(def, "minimum_swash") < 0;
  if (is_over_centre) pen.filled("M38 47L45 36L31 36Z");
  const bool has_pilot = !text_of(def, "control_port").empty();
  if (has_pilot || is_set(def, "swash_per_signal") || is_set(def, "maximum_pressure") || is_set(def, "maximum_power")) {
    pen.adjustable({20, 49}, {57, 6});
  }
  if (has_pilot) {
    pen.dashed("M2 49L20 49");
    add_pilot(symbol, def, "control_port", 2, {2, 49});
  }
  add_shaft(symbol, pen, def, 58);
  symbol.ports.push_back(straight(def, "port_a", Role::outlet, Side::top, 38, 0));
  symbol.ports.push_back(
      straight(def, "port_b", is_over_centre ? Role::outlet : Role::back, Side::bottom, 38, kMachineHeight));
  if (!text_of(def, "port_c").empty()) {
    pen.dashed("M51 42L54 46V54");
    symbol.ports.push_back(straight(def, "port_c", Role::pilot, Side::bottom, 54, kMachineHeight));
  }
  symbol.drawing = pen.take();
  return symbol;
}

Symbol ls_pump_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 90, .height = kMachineHeight, .place = Place::supply};
  Pen pen;
  draw_pump(pen, 52);
  pen.adjustable({34, 49}, {71, 6});
  // controller: a spool between load-sensing pressure and spring
  pen.box({8, 19}, 18, 16);
  pen.arrow({12, 31}, {22, 23}, 4);
  pen.line({26, 27}, {32, 27});
  add_shaft(symbol, pen, def, 72);
  symbol.ports.push_back(straight(def, "port_a", Role::outlet, Side::top, 52, 0));
  symbol.ports.push_back(straight(def, "port_b", Role::back, Side::bottom, 52, kMachineHeight));
  add_pilot(symbol, def, "ls_port", 2, {8, 27}, Role::load_sensing);
  symbol.drawing = pen.take();
  return symbol;
}

Symbol engine_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 46, .height = 40, .place = Place::prime_mover};
  Pen pen;
  pen.box({3, 10}, 40, 30);
  pen.path("M15 33L15 18L23 28L31 18L31 33");
  for (const double x : {21.0, 25.0}) pen.line({x, 0}, {x, 10});
  symbol.ports.push_back(
      {.key = "", .net = def.name, .role = Role::drive, .side = Side::top, .lane = 23, .from_x = 23, .from_y = 0});
  symbol.drawing = pen.take();
  return symbol;
}

Symbol flow_source_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 48, .height = kMachineHeight, .place = Place::supply};
  Pen pen;
  pen.circle({24, kMachineAxis}, kMachineRadius);
  pen.line({24, 0}, {24, 7});
  pen.line({24, 47}, {24, kMachineHeight});
  pen.arrow({24, 41}, {24, 13}, 9);
  symbol.ports.push_back(straight(def, "port_2", Role::outlet, Side::top, 24, 0));
  symbol.ports.push_back(straight(def, "port_1", Role::back, Side::bottom, 24, kMachineHeight));
  symbol.drawing = pen.take();
  return symbol;
}

Symbol pressure_source_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 48, .height = 47, .place = Place::supply};
  Pen pen;
  pen.circle({24, kMachineAxis}, kMachineRadius);
  pen.filled("M24 9L34 29L14 29Z");
  pen.line({24, 0}, {24, 7});
  symbol.ports.push_back(straight(def, "port_1", Role::outlet, Side::top, 24, 0));
  symbol.drawing = pen.take();
  return symbol;
}

Symbol accumulator_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 32, .height = 60, .place = Place::store};
  Pen pen;
  pen.path("M6 14A10 10 0 0 1 26 14L26 40A10 10 0 0 1 6 40Z");
  pen.line({6, 27}, {26, 27});
  pen.path("M12 22L20 22L16 14Z");
  pen.line({16, 50}, {16, 60});
  symbol.ports.push_back(straight(def, "port_1", Role::inlet, Side::bottom, 16, 60));
  symbol.drawing = pen.take();
  return symbol;
}

// flexible line between two connections; the model is a volume without a pressure loss, at one net
Symbol hose_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 44, .height = 36, .place = Place::store};
  Pen pen;
  pen.path("M6 8Q22 34 38 8");
  pen.filled("M3 8a3 3 0 1 0 6 0a3 3 0 1 0 -6 0Z");
  pen.filled("M35 8a3 3 0 1 0 6 0a3 3 0 1 0 -6 0Z");
  pen.line({6, 8}, {6, 36});
  symbol.ports.push_back(straight(def, "volume", Role::inlet, Side::bottom, 6, 36));
  symbol.drawing = pen.take();
  return symbol;
}

constexpr SymbolRow kSupplyRows[] = {{"pump", pump_symbol},
                                     {"ls_pump", ls_pump_symbol},
                                     {"engine", engine_symbol},
                                     {"flow_source", flow_source_symbol},
                                     {"pressure_source", pressure_source_symbol},
                                     {"accumulator", accumulator_symbol},
                                     {"hose", hose_symbol}};

}  // namespace

std::span<const SymbolRow> supply_symbols() noexcept {
  return kSupplyRows;
}

}  // namespace slew::diagram
