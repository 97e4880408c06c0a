// SPDX-License-Identifier: Apache-2.0
// Check valves, restrictions, filters, coolers, flow dividers: what stands in a line; walls that lose heat.
#include "diagram/symbol_parts.h"

namespace slew::diagram {
namespace {

using hydraulics::ComponentDef;

constexpr double kLineHeight = 44;

// port 1 below, port 2 above, both at x
void add_line_ports(Symbol& symbol, const ComponentDef& def, double x) {
  symbol.ports.insert(symbol.ports.begin(), {straight(def, "port_1", Role::inlet, Side::bottom, x, symbol.height),
                                             straight(def, "port_2", Role::outlet, Side::top, x, 0)});
}

Symbol check_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 28, .height = kLineHeight};
  Pen pen;
  pen.check({14, 26});
  pen.spring({14, 19}, {14, 6}, 3);
  pen.line({14, 6}, {14, 0});
  pen.line({14, 33}, {14, kLineHeight});
  add_line_ports(symbol, def, 14);
  symbol.drawing = pen.take();
  return symbol;
}

Symbol throttle_check_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 64, .height = 54};
  Pen pen;
  pen.envelope({2, 4}, 60, 46);
  pen.check({16, 30});
  pen.path("M16 23V10H46V46H16V37M31 0V10M31 46V54");
  pen.throttle({46, 28});
  pen.adjustable({35, 38}, {57, 18});
  add_line_ports(symbol, def, 31);
  symbol.drawing = pen.take();
  return symbol;
}

Symbol pilot_check_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 48, .height = 54};
  Pen pen;
  pen.envelope({8, 5}, 32, 44);
  pen.check({24, 28});
  pen.spring({24, 21}, {24, 9}, 3);
  pen.line({24, 9}, {24, 0});
  pen.line({24, 35}, {24, 54});
  pen.dashed("M8 42H18V32");
  add_pilot(symbol, def, "port_3", 3, {8, 42});
  if (!text_of(def, "port_4").empty()) pen.dashed("M40 42H30V32");
  add_pilot(symbol, def, "port_4", 45, {40, 42});
  add_line_ports(symbol, def, 24);
  symbol.drawing = pen.take();
  return symbol;
}

Symbol double_pilot_check_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 92, .height = 60};
  Pen pen;
  pen.envelope({4, 5}, 84, 50);
  for (const double x : {24.0, 68.0}) {
    pen.check({x, 26});
    pen.line({x, 0}, {x, 19});
    pen.line({x, 33}, {x, 60});
  }
  // each is opened by the other line's valve side
  pen.dashed("M24 48H50V32H60");
  pen.dashed("M68 42H42V32H32");
  symbol.ports = {straight(def, "port_a1", Role::inlet, Side::bottom, 24, 60),
                  straight(def, "port_a2", Role::outlet, Side::top, 24, 0),
                  straight(def, "port_b1", Role::inlet, Side::bottom, 68, 60),
                  straight(def, "port_b2", Role::outlet, Side::top, 68, 0)};
  symbol.drawing = pen.take();
  return symbol;
}

// plate that a spring holds open, its port 2 at the load
Symbol hose_burst_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 44, .height = 54};
  Pen pen;
  pen.envelope({4, 5}, 36, 44);
  pen.circle({22, 20}, 5.5);
  pen.path("M13 33L22 42L31 33M22 14.5V0M22 42V54M12 13V27M32 13V27");
  pen.spring({22, 25.5}, {22, 40}, 3);
  add_line_ports(symbol, def, 22);
  symbol.drawing = pen.take();
  return symbol;
}

Symbol compensated_orifice_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 66, .height = 56};
  Pen pen;
  pen.box({12, 10}, 40, 36);
  pen.line({32, 0}, {32, 56});
  pen.throttle({32, 30});
  pen.arrow({44, 44}, {44, 12}, 5);  // compensated for the load
  pen.adjustable({20, 42}, {43, 17});
  symbol.ports = {straight(def, "port_p", Role::inlet, Side::bottom, 32, 56),
                  straight(def, "port_a", Role::outlet, Side::top, 32, 0)};
  symbol.ports.push_back({.key = "port_t",
                          .net = text_of(def, "port_t"),
                          .role = Role::pilot,
                          .side = Side::bottom,
                          .lane = 14,
                          .from_x = 14,
                          .from_y = 46});
  symbol.ports.push_back(
      {.key = "", .net = def.name, .role = Role::sensed, .side = Side::either, .lane = 60, .from_x = 52, .from_y = 28});
  symbol.drawing = pen.take();
  return symbol;
}

Symbol bleed_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 28, .height = kLineHeight};
  Pen pen;
  pen.line({14, 0}, {14, kLineHeight});
  pen.throttle({14, 22});
  add_line_ports(symbol, def, 14);
  symbol.drawing = pen.take();
  return symbol;
}

// sharp-edged: independent of the viscosity
Symbol orifice_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 36, .height = kLineHeight};
  Pen pen;
  pen.line({18, 0}, {18, kLineHeight});
  pen.path("M9 14L15 22L9 30M27 14L21 22L27 30");
  pen.adjustable({6, 36}, {31, 9});
  add_line_ports(symbol, def, 18);
  symbol.drawing = pen.take();
  return symbol;
}

Symbol laminar_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 28, .height = kLineHeight};
  Pen pen;
  pen.line({14, 0}, {14, kLineHeight});
  pen.path("M6 10Q11 12 11 16V28Q11 32 6 34M22 10Q17 12 17 16V28Q17 32 22 34");
  add_line_ports(symbol, def, 14);
  symbol.drawing = pen.take();
  return symbol;
}

Symbol filter_symbol(const ComponentDef& def) {
  const bool has_bypass = is_set(def, "bypass_flow");
  Symbol symbol{.width = has_bypass ? 72.0 : 44.0, .height = 56};
  Pen pen;
  pen.path("M22 10L40 28L22 46L4 28Z");
  pen.line({22, 0}, {22, 10});
  pen.line({22, 46}, {22, 56});
  pen.dashed("M4 28H40");
  if (has_bypass) {
    pen.check({58, 30});
    pen.path("M22 6H58V23M58 37V50H22");
  }
  add_line_ports(symbol, def, 22);
  symbol.drawing = pen.take();
  return symbol;
}

// heat leaves the oil: arrows point out of the square
Symbol cooler_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 64, .height = 56};
  Pen pen;
  pen.path("M32 10L50 28L32 46L14 28Z");
  pen.line({32, 0}, {32, 56});
  pen.arrow({38, 28}, {60, 28});
  pen.arrow({26, 28}, {4, 28});
  add_line_ports(symbol, def, 32);
  symbol.drawing = pen.take();
  return symbol;
}

// wall of a volume with an arrow through it
Symbol heat_loss_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 44, .height = 44, .place = Place::store};
  Pen pen;
  pen.path("M4 8H32V30H4Z");
  pen.arrow({20, 19}, {42, 19});
  pen.line({18, 30}, {18, 44});
  symbol.ports.push_back(straight(def, "port_1", Role::inlet, Side::bottom, 18, 44));
  symbol.drawing = pen.take();
  return symbol;
}

// pipe whose length matters
Symbol line_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 28, .height = kLineHeight};
  Pen pen;
  pen.box({8, 6}, 12, 32);
  pen.line({14, 0}, {14, kLineHeight});
  add_line_ports(symbol, def, 14);
  symbol.drawing = pen.take();
  return symbol;
}

void add_branch_ports(Symbol& symbol, const ComponentDef& def, double common, double left, double right) {
  symbol.ports = {straight(def, "port_1", Role::inlet, Side::bottom, common, symbol.height),
                  straight(def, "port_2", Role::outlet, Side::top, left, 0),
                  straight(def, "port_3", Role::outlet, Side::top, right, 0)};
}

Symbol flow_divider_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 84, .height = 60};
  Pen pen;
  pen.box({6, 8}, 72, 44);
  for (const double x : {24.0, 60.0}) {
    pen.throttle({x, 24});
    pen.line({x, 0}, {x, 42});
  }
  pen.path("M24 42H60M42 42V60");
  add_branch_ports(symbol, def, 42, 24, 60);
  symbol.drawing = pen.take();
  return symbol;
}

// two gear units on one shaft
Symbol gear_flow_divider_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 96, .height = 66};
  Pen pen;
  for (const double x : {24.0, 72.0}) {
    pen.circle({x, 28}, 14);
    pen.filled(fmt::format("M{:g} 14L{:g} 21L{:g} 21Z", x, x - 4, x + 4));
    pen.line({x, 0}, {x, 14});
    pen.line({x, 42}, {x, 54});
  }
  pen.path("M38 26H58M38 30H58M24 54H72M48 54V66");
  add_branch_ports(symbol, def, 48, 24, 72);
  symbol.drawing = pen.take();
  return symbol;
}

// ball between the seats of both inlets
Symbol shuttle_valve_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 72, .height = 52};
  Pen pen;
  pen.box({6, 10}, 60, 28);
  pen.circle({24, 26}, 5.5);
  pen.path("M12 20L18 26L12 32M60 20L54 26L60 32M36 26V0M12 26V52M60 26V52M30 26H54");
  symbol.ports = {straight(def, "port_1", Role::inlet, Side::bottom, 12, 52),
                  straight(def, "port_2", Role::inlet, Side::bottom, 60, 52),
                  straight(def, "port_3", Role::outlet, Side::top, 36, 0)};
  symbol.drawing = pen.take();
  return symbol;
}

// spool of three places, shut in the middle, piloted by both sides
Symbol flushing_valve_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 96, .height = 52};
  Pen pen;
  for (const double x : {12.0, 36.0, 60.0}) pen.box({x, 12}, 24, 28);
  pen.arrow({18, 40}, {24, 12}, 5);
  pen.arrow({78, 40}, {72, 12}, 5);
  pen.path("M30 40V35M27 35H33M66 40V35M63 35H69M42 40V35M39 35H45M54 40V35M51 35H57M48 12V17M45 17H51");
  pen.path("M0 26L3 20L6 32L9 20L12 26M96 26L93 20L90 32L87 20L84 26M42 40V52M54 40V52M48 12V0");
  symbol.ports = {straight(def, "port_1", Role::inlet, Side::bottom, 42, 52),
                  straight(def, "port_2", Role::inlet, Side::bottom, 54, 52),
                  straight(def, "port_3", Role::outlet, Side::top, 48, 0)};
  symbol.drawing = pen.take();
  return symbol;
}

constexpr SymbolRow kFlowRows[] = {{"check_valve", check_symbol},
                                   {"throttle_check_valve", throttle_check_symbol},
                                   {"pilot_check_valve", pilot_check_symbol},
                                   {"double_pilot_check_valve", double_pilot_check_symbol},
                                   {"hose_burst_valve", hose_burst_symbol},
                                   {"compensated_orifice", compensated_orifice_symbol},
                                   {"bleed", bleed_symbol},
                                   {"orifice", orifice_symbol},
                                   {"laminar_restriction", laminar_symbol},
                                   {"filter", filter_symbol},
                                   {"cooler", cooler_symbol},
                                   {"heat_loss", heat_loss_symbol},
                                   {"line", line_symbol},
                                   {"flow_divider", flow_divider_symbol},
                                   {"gear_flow_divider", gear_flow_divider_symbol},
                                   {"shuttle_valve", shuttle_valve_symbol},
                                   {"flushing_valve", flushing_valve_symbol}};

}  // namespace

std::span<const SymbolRow> flow_symbols() noexcept {
  return kFlowRows;
}

}  // namespace slew::diagram
