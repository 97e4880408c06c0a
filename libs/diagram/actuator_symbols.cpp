// SPDX-License-Identifier: Apache-2.0
// Cylinders and motors.
#include "diagram/symbol_parts.h"

namespace slew::diagram {
namespace {

using hydraulics::ComponentDef;

constexpr double kBarrel = 88, kBarrelTop = 4, kBarrelBottom = 30, kCylinderHeight = 38;  // of a cylinder
constexpr double kRodAxis = (kBarrelTop + kBarrelBottom) / 2;

enum class Rods { one, both };

// left: x of the barrel; piston in the middle of the stroke
void draw_cylinder(Pen& pen, double left, Rods rods) {
  pen.box({left, kBarrelTop}, kBarrel, kBarrelBottom - kBarrelTop);
  for (const double x : {36.0, 42.0}) pen.line({left + x, kBarrelTop}, {left + x, kBarrelBottom});
  for (const double y : {kRodAxis - 3, kRodAxis + 3}) {
    pen.line({left + 42, y}, {left + kBarrel + 20, y});
    if (rods == Rods::both) pen.line({left - 20, y}, {left + 36, y});
  }
  pen.line({left + kBarrel + 20, kRodAxis - 3}, {left + kBarrel + 20, kRodAxis + 3});
  if (rods == Rods::both) pen.line({left - 20, kRodAxis - 3}, {left - 20, kRodAxis + 3});
  for (const double x : {10.0, kBarrel - 10}) pen.line({left + x, kBarrelBottom}, {left + x, kCylinderHeight});
}

void add_chambers(Symbol& symbol, const ComponentDef& def, double a, double b) {
  symbol.ports.push_back(straight(def, "port_a", Role::inlet, Side::bottom, a, kCylinderHeight));
  symbol.ports.push_back(straight(def, "port_b", Role::inlet, Side::bottom, b, kCylinderHeight));
}

Symbol double_acting_symbol(const ComponentDef& def) {
  Symbol symbol{.width = kBarrel + 24, .height = kCylinderHeight, .place = Place::actuator};
  Pen pen;
  draw_cylinder(pen, 2, Rods::one);
  add_chambers(symbol, def, 12, kBarrel - 8);
  symbol.drawing = pen.take();
  return symbol;
}

Symbol double_rod_symbol(const ComponentDef& def) {
  Symbol symbol{.width = kBarrel + 44, .height = kCylinderHeight, .place = Place::actuator};
  Pen pen;
  draw_cylinder(pen, 22, Rods::both);
  add_chambers(symbol, def, 32, kBarrel + 12);
  symbol.drawing = pen.take();
  return symbol;
}

// the open side stands at the volume of port B
Symbol single_acting_symbol(const ComponentDef& def) {
  Symbol symbol{.width = kBarrel + 24, .height = kCylinderHeight, .place = Place::actuator};
  Pen pen;
  pen.box({2, kBarrelTop}, kBarrel, kBarrelBottom - kBarrelTop);
  pen.box({40, kRodAxis - 7}, kBarrel - 18, 14);
  for (const double x : {12.0, kBarrel - 8}) pen.line({x, kBarrelBottom}, {x, kCylinderHeight});
  add_chambers(symbol, def, 12, kBarrel - 8);
  symbol.drawing = pen.take();
  return symbol;
}

// three tubes in each other; the open side stands at the volume of port B
Symbol telescopic_symbol(const ComponentDef& def) {
  Symbol symbol{.width = kBarrel + 24, .height = kCylinderHeight, .place = Place::actuator};
  Pen pen;
  pen.box({2, kBarrelTop}, 60, kBarrelBottom - kBarrelTop);
  pen.box({26, kRodAxis - 9}, 60, 18);
  pen.box({50, kRodAxis - 5}, 60, 10);
  for (const double x : {12.0, kBarrel - 8}) pen.line({x, x < 60 ? kBarrelBottom : kRodAxis + 9}, {x, kCylinderHeight});
  add_chambers(symbol, def, 12, kBarrel - 8);
  symbol.drawing = pen.take();
  return symbol;
}

// double piston with a rack under its pinion
Symbol slew_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 108, .height = 52, .place = Place::actuator};
  Pen pen;
  pen.box({2, 18}, 104, 26);
  for (const double x : {24.0, 30.0, 78.0, 84.0}) pen.line({x, 18}, {x, 44});
  pen.path("M30 28L34 33L38 28L42 33L46 28L50 33L54 28L58 33L62 28L66 33L70 28L74 33L78 28");
  pen.line({30, 38}, {78, 38});
  pen.circle({54, 15}, 13);
  pen.filled("M52 15a2 2 0 1 0 4 0a2 2 0 1 0 -4 0Z");
  for (const double x : {12.0, 96.0}) pen.line({x, 44}, {x, 52});
  symbol.ports.push_back(straight(def, "port_a", Role::inlet, Side::bottom, 12, 52));
  symbol.ports.push_back(straight(def, "port_b", Role::inlet, Side::bottom, 96, 52));
  symbol.drawing = pen.take();
  return symbol;
}

Symbol motor_symbol(const ComponentDef& def) {
  const bool has_brake = !text_of(def, "brake_port").empty();
  const double x = has_brake ? 66 : 40;  // of the shaft's axis
  Symbol symbol{.width = x + 46, .height = 64, .place = Place::actuator};
  Pen pen;
  pen.circle({x, 34}, 20);
  pen.filled(fmt::format("M{0:g} 25L{1:g} 14L{2:g} 14Z", x, x + 7, x - 7));
  pen.filled(fmt::format("M{0:g} 43L{1:g} 54L{2:g} 54Z", x, x + 7, x - 7));
  pen.line({x, 54}, {x, 64});
  pen.path(fmt::format("M{0:g} 14L{0:g} 5L{1:g} 5L{1:g} 64", x, x + 40));
  if (is_set(def, "variable")) pen.adjustable({x - 18, 55}, {x + 19, 13});
  for (const double y : {32.0, 36.0}) pen.line({has_brake ? 28 : x - 34, y}, {x - 20, y});
  symbol.ports.push_back(straight(def, "port_a", Role::inlet, Side::bottom, x, 64));
  symbol.ports.push_back(straight(def, "port_b", Role::inlet, Side::bottom, x + 40, 64));
  if (!text_of(def, "port_c").empty()) {
    pen.dashed(fmt::format("M{:g} 48L{:g} 55V64", x + 14, x + 22));
    symbol.ports.push_back(straight(def, "port_c", Role::pilot, Side::bottom, x + 22, 64));
  }
  if (has_brake) {
    // spring-applied, released by pressure
    pen.box({14, 24}, 14, 20);
    pen.spring({21, 24}, {21, 8}, 3);
    add_pilot(symbol, def, "brake_port", 4, {14, 34});
  }
  symbol.drawing = pen.take();
  return symbol;
}

constexpr SymbolRow kActuatorRows[] = {{"double_acting_cylinder", double_acting_symbol},
                                       {"double_rod_cylinder", double_rod_symbol},
                                       {"single_acting_cylinder", single_acting_symbol},
                                       {"telescopic_cylinder", telescopic_symbol},
                                       {"slew_cylinder", slew_symbol},
                                       {"hydraulic_motor", motor_symbol}};

}  // namespace

std::span<const SymbolRow> actuator_symbols() noexcept {
  return kActuatorRows;
}

}  // namespace slew::diagram
