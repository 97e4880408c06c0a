// SPDX-License-Identifier: Apache-2.0
// Valves that act on pressures: relief, reducing and counterbalance valves, compensators, shuttles.
#include "diagram/symbol_parts.h"

namespace slew::diagram {
namespace {

using hydraulics::ComponentDef;

// Box of 28 x 28 px with its left upper corner at a point, an arrow upwards or downwards inside.
constexpr double kValveBox = 28;

void draw_relief(Pen& pen) {
  pen.box({16, 12}, kValveBox, kValveBox);
  pen.line({30, 0}, {30, 12});
  pen.line({30, 40}, {30, 52});
  pen.arrow({37, 12}, {37, 40});  // closed at rest: the arrow stands beside the line
}

void draw_relief_with_spring(Pen& pen) {
  draw_relief(pen);
  pen.spring({44, 26}, {60, 26});
  pen.adjustable({46, 34}, {60, 17});
}

// the solenoid of a proportional valve stands beside its spring
void draw_relief_of(Pen& pen, const ComponentDef& def) {
  if (!is_set(def, "proportional")) return draw_relief_with_spring(pen);
  draw_relief(pen);
  pen.spring({44, 18}, {60, 18});
  pen.box({44, 24}, 14, 14);
  pen.line({47, 35}, {55, 27});
  pen.adjustable({45, 41}, {60, 21});
}

Symbol relief_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 64, .height = 52, .place = Place::shunt};
  Pen pen;
  draw_relief_of(pen, def);
  const std::string pilot = text_of(def, "port_3");
  pen.filled("M16 26L10 22L10 30Z");  // stage that is piloted
  if (pilot.empty() || pilot == text_of(def, "port_1")) {
    pen.dashed("M30 6H6V26H10");
  } else {
    add_pilot(symbol, def, "port_3", 4, {10, 26});
  }
  symbol.ports.push_back(straight(def, "port_1", Role::inlet, Side::top, 30, 0));
  symbol.ports.push_back(straight(def, "port_2", Role::back, Side::bottom, 30, 52));
  symbol.drawing = pen.take();
  return symbol;
}

Symbol direct_relief_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 64, .height = 52, .place = Place::shunt};
  Pen pen;
  draw_relief_of(pen, def);
  pen.dashed("M30 6H8V26H16");
  symbol.ports.push_back(straight(def, "port_1", Role::inlet, Side::top, 30, 0));
  symbol.ports.push_back(straight(def, "port_2", Role::back, Side::bottom, 30, 52));
  symbol.drawing = pen.take();
  return symbol;
}

// opened by the pressure of another line
Symbol unloading_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 64, .height = 52, .place = Place::shunt};
  Pen pen;
  draw_relief_with_spring(pen);
  add_pilot(symbol, def, "port_3", 4, {16, 26});
  pen.dashed("M10 26H16");
  symbol.ports.push_back(straight(def, "port_1", Role::inlet, Side::top, 30, 0));
  symbol.ports.push_back(straight(def, "port_2", Role::back, Side::bottom, 30, 52));
  symbol.drawing = pen.take();
  return symbol;
}

Symbol reducing_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 66, .height = 52};
  Pen pen;
  pen.box({16, 12}, kValveBox, kValveBox);
  pen.line({25, 0}, {25, 12});
  pen.line({25, 40}, {25, 52});
  pen.arrow({25, 40}, {25, 12});
  pen.line({38, 40}, {38, 52});
  pen.blocked({38, 40}, -7);
  pen.dashed("M25 6H6V26H16");
  pen.spring({44, 26}, {60, 26});
  pen.adjustable({46, 34}, {60, 17});
  symbol.ports.push_back(straight(def, "port_1", Role::inlet, Side::bottom, 25, 52));
  symbol.ports.push_back(straight(def, "port_2", Role::outlet, Side::top, 25, 0));
  symbol.ports.push_back(straight(def, "port_3", Role::back, Side::bottom, 38, 52));
  symbol.drawing = pen.take();
  return symbol;
}

Symbol counterbalance_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 100, .height = 66};
  Pen pen;
  pen.envelope({12, 6}, 84, 54);
  // check valve for the flow to the load, valve beside it for the flow back
  pen.check({26, 34});
  pen.line({26, 12}, {26, 27});
  pen.line({26, 41}, {26, 54});
  pen.box({48, 20}, kValveBox, kValveBox);
  pen.line({62, 12}, {62, 20});
  pen.line({62, 48}, {62, 54});
  pen.arrow({69, 20}, {69, 48});
  pen.path("M26 12H62M26 54H62M44 0V12M44 54V66");
  pen.spring({76, 34}, {92, 34});
  pen.adjustable({78, 43}, {92, 24});
  pen.dashed("M62 16H42V28H48");
  add_pilot(symbol, def, "port_3", 4, {12, 48});
  pen.dashed("M12 48H36V40H48");
  if (!text_of(def, "port_4").empty()) pen.dashed("M84 38V66");
  add_pilot(symbol, def, "port_4", 84, {84, 66});
  symbol.ports.insert(symbol.ports.begin(), straight(def, "port_2", Role::outlet, Side::top, 44, 0));
  symbol.ports.insert(symbol.ports.begin(), straight(def, "port_1", Role::inlet, Side::bottom, 44, 66));
  if (symbol.ports.back().key == "port_4") symbol.ports.back().side = Side::bottom;
  symbol.drawing = pen.take();
  return symbol;
}

// own load pressure and spring against the shared one
Symbol post_compensator_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 78, .height = 52};
  Pen pen;
  pen.box({22, 12}, kValveBox, kValveBox);
  pen.line({36, 0}, {36, 12});
  pen.line({36, 40}, {36, 52});
  pen.arrow({36, 40}, {36, 12});
  pen.dashed("M36 46H14V34H22");
  pen.spring({50, 32}, {66, 32}, 3);
  add_pilot(symbol, def, "shared_ls", 72, {50, 20}, Role::load_sensing);
  symbol.ports.insert(symbol.ports.begin(), straight(def, "port_2", Role::outlet, Side::top, 36, 0));
  symbol.ports.insert(symbol.ports.begin(), straight(def, "port_1", Role::inlet, Side::bottom, 36, 52));
  symbol.ports.push_back(
      {.key = "", .net = def.name, .role = Role::sensed, .side = Side::either, .lane = 4, .from_x = 36, .from_y = 6});
  symbol.ports.push_back({.key = "port_t",
                          .net = text_of(def, "port_t"),
                          .role = Role::pilot,
                          .side = Side::bottom,
                          .lane = 58,
                          .from_x = 58,
                          .from_y = 35});
  symbol.drawing = pen.take();
  return symbol;
}

Symbol priority_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 104, .height = 56};
  Pen pen;
  const double top = 12, bottom = 42;
  for (const double x : {20.0, 50.0}) pen.box({x, top}, 30, bottom - top);
  pen.arrow({28, bottom}, {28, top});
  pen.blocked({42, top}, 7);
  pen.arrow({58, bottom}, {72, top});
  pen.blocked({58, top}, 7);
  for (const double y : {top - 4, bottom + 4}) pen.line({20, y}, {80, y});
  // at rest all oil goes to the priority line; the spring and the load pressure stand at the right
  pen.path("M28 0V12M42 0V12M28 42V56");
  pen.dashed("M28 6H12V27H20");
  pen.spring({80, 33}, {96, 33}, 3);
  add_pilot(symbol, def, "ls_port", 98, {80, 20}, Role::load_sensing);
  symbol.ports.insert(symbol.ports.begin(), straight(def, "port_3", Role::outlet, Side::top, 42, 0));
  symbol.ports.insert(symbol.ports.begin(), straight(def, "port_2", Role::outlet, Side::top, 28, 0));
  symbol.ports.insert(symbol.ports.begin(), straight(def, "port_1", Role::inlet, Side::bottom, 28, 56));
  symbol.ports.push_back({.key = "port_t",
                          .net = text_of(def, "port_t"),
                          .role = Role::pilot,
                          .side = Side::bottom,
                          .lane = 88,
                          .from_x = 88,
                          .from_y = 36});
  symbol.drawing = pen.take();
  return symbol;
}

Symbol shuttle_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 64, .height = 38, .place = Place::selector};
  Pen pen;
  pen.box({14, 14}, 36, 22);
  pen.circle({32, 25}, 5);
  pen.path("M20 25L24 19M20 25L24 31M44 25L40 19M44 25L40 31M32 20V14M14 25H20M50 25H44");
  for (const auto& [key, lane, x] : {std::tuple("port_1", 4.0, 14.0), std::tuple("port_2", 60.0, 50.0)}) {
    symbol.ports.push_back({.key = key,
                            .net = text_of(def, key),
                            .role = Role::load_sensing,
                            .side = Side::top,
                            .lane = lane,
                            .from_x = x,
                            .from_y = 25});
  }
  symbol.ports.push_back(
      {.key = "", .net = def.name, .role = Role::sensed, .side = Side::top, .lane = 32, .from_x = 32, .from_y = 14});
  symbol.drawing = pen.take();
  return symbol;
}

constexpr SymbolRow kPressureRows[] = {{"relief_valve", relief_symbol},
                                       {"direct_relief_valve", direct_relief_symbol},
                                       {"unloading_valve", unloading_symbol},
                                       {"reducing_valve", reducing_symbol},
                                       {"counterbalance_valve", counterbalance_symbol},
                                       {"post_compensator", post_compensator_symbol},
                                       {"priority_valve", priority_symbol},
                                       {"ls_shuttle", shuttle_symbol}};

}  // namespace

std::span<const SymbolRow> pressure_symbols() noexcept {
  return kPressureRows;
}

}  // namespace slew::diagram
