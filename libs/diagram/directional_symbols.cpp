// SPDX-License-Identifier: Apache-2.0
// Directional valves: a box for each position of the spool.
#include <array>

#include "diagram/symbol_parts.h"

namespace slew::diagram {
namespace {

using hydraulics::ComponentDef;

constexpr double kPosition = 46, kPositionHeight = 34;              // of one position
constexpr double kFirstPort = 9, kBypassPort = 23, kLastPort = 37;  // ports in a box: P or A, bypass, T or B
constexpr double kBoxesLeft = 20, kBoxesTop = 10;                   // of the boxes in the symbol

struct Edges {
  bool pa = false, bt = false, pb = false, at = false;
};

// one position, its left border at x
void draw_position(Pen& pen, double x, const Edges& open) {
  const double top = kBoxesTop, bottom = kBoxesTop + kPositionHeight;
  pen.box({x, top}, kPosition, kPositionHeight);
  const bool has_p = open.pa || open.pb, has_t = open.at || open.bt;
  if (open.pa) pen.arrow({x + kFirstPort, bottom}, {x + kFirstPort, top});
  if (open.bt) pen.arrow({x + kLastPort, top}, {x + kLastPort, bottom});
  if (open.pb) pen.arrow({x + kFirstPort, bottom}, {x + kLastPort, top});
  if (open.at) pen.arrow({x + kFirstPort, top}, {x + kLastPort, bottom});
  if (!has_p) pen.blocked({x + kFirstPort, bottom}, -7);
  if (!has_t) pen.blocked({x + kLastPort, bottom}, -7);
  if (!open.pa && !open.at) pen.blocked({x + kFirstPort, top}, 7);
  if (!open.bt && !open.pb) pen.blocked({x + kLastPort, top}, 7);
}

// lines along the boxes: any place between the positions can be held
void draw_proportional(Pen& pen, double boxes) {
  for (const double y : {kBoxesTop - 4, kBoxesTop + kPositionHeight + 4})
    pen.line({kBoxesLeft, y}, {kBoxesLeft + boxes * kPosition, y});
}

// solenoid outside of x, to the left or to the right, with its adjustment; spring beyond
void draw_solenoid(Pen& pen, double x, double way) {
  const double from = way < 0 ? x - 14 : x;
  pen.box({from, kBoxesTop + 16}, 14, 16);
  pen.line({from + 3, kBoxesTop + 29}, {from + 11, kBoxesTop + 19});
  pen.adjustable({from + 1, kBoxesTop + 34}, {from + 14, kBoxesTop + 14});
}

void draw_end_springs(Pen& pen, double boxes) {
  const double right = kBoxesLeft + boxes * kPosition;
  pen.spring({kBoxesLeft, kBoxesTop + 8}, {kBoxesLeft - 16, kBoxesTop + 8});
  pen.spring({right, kBoxesTop + 8}, {right + 16, kBoxesTop + 8});
}

struct PortKey {
  std::string_view key;
  double x;
  Role role;
  Side side;
};

// x: of the box at rest. Lines between the boxes and the ports.
void add_ports(Symbol& symbol, Pen& pen, const ComponentDef& def, double x, std::span<const PortKey> keys) {
  for (const PortKey& key : keys) {
    const bool is_top = key.side == Side::top;
    const double edge = is_top ? kBoxesTop : kBoxesTop + kPositionHeight, end = is_top ? 0 : symbol.height;
    pen.line({x + key.x, edge}, {x + key.x, end});
    symbol.ports.push_back(straight(def, key.key, key.role, key.side, x + key.x, end));
  }
}

constexpr PortKey kFourPorts[] = {{"port_p", kFirstPort, Role::inlet, Side::bottom},
                                  {"port_t", kLastPort, Role::back, Side::bottom},
                                  {"port_a", kFirstPort, Role::outlet, Side::top},
                                  {"port_b", kLastPort, Role::outlet, Side::top}};

Symbol l90ls_symbol(const ComponentDef& def) {
  constexpr double kCompensatorTop = 56;
  Symbol symbol{.width = 2 * kBoxesLeft + 3 * kPosition, .height = 92};
  Pen pen;
  const double rest = kBoxesLeft + kPosition;
  draw_position(pen, kBoxesLeft, {.pa = true, .bt = true});
  draw_position(pen, rest, {});
  draw_position(pen, rest + kPosition, {.pb = true, .at = true});
  draw_proportional(pen, 3);
  draw_end_springs(pen, 3);
  draw_solenoid(pen, kBoxesLeft, -1);
  draw_solenoid(pen, kBoxesLeft + 3 * kPosition, 1);
  add_ports(symbol, pen, def, rest, std::span(kFourPorts).subspan(1));
  // compensator in P: load pressure and spring open it, the pressure before the spool closes it
  const double x = rest + kFirstPort;
  pen.line({x, kBoxesTop + kPositionHeight}, {x, kCompensatorTop});
  pen.box({x - 11, kCompensatorTop}, 22, 22);
  pen.arrow({x, kCompensatorTop + 22}, {x, kCompensatorTop});
  pen.line({x, kCompensatorTop + 22}, {x, symbol.height});
  pen.spring({x - 11, kCompensatorTop + 16}, {x - 25, kCompensatorTop + 16}, 3);
  pen.dashed(fmt::format("M{:g} {:g}h7v-17h-7", x + 11, kCompensatorTop + 11));
  symbol.ports.insert(symbol.ports.begin(), straight(def, "port_p", Role::inlet, Side::bottom, x, symbol.height));
  // load-sensing line: from the spool to the compensator, and out
  const double lane = kBoxesLeft + 14;
  pen.dashed(
      fmt::format("M{0:g} {1:g}V{2:g}H{3:g}", lane, kBoxesTop + kPositionHeight + 4, kCompensatorTop + 6, x - 11));
  symbol.ports.push_back({.key = "",
                          .net = def.name,
                          .role = Role::sensed,
                          .side = Side::bottom,
                          .lane = lane,
                          .from_x = lane,
                          .from_y = kCompensatorTop + 6});
  symbol.drawing = pen.take();
  return symbol;
}

// complementary edges: half open at rest
Symbol four_way_symbol(const ComponentDef& def) {
  Symbol symbol{.width = 2 * kBoxesLeft + 3 * kPosition, .height = 56};
  Pen pen;
  const double rest = kBoxesLeft + kPosition, middle = kBoxesTop + kPositionHeight / 2;
  draw_position(pen, kBoxesLeft, {.pa = true, .bt = true});
  pen.box({rest, kBoxesTop}, kPosition, kPositionHeight);
  for (const double x : {kFirstPort, kLastPort})
    pen.line({rest + x, kBoxesTop}, {rest + x, kBoxesTop + kPositionHeight});
  pen.line({rest + kFirstPort, middle}, {rest + kLastPort, middle});
  draw_position(pen, rest + kPosition, {.pb = true, .at = true});
  draw_proportional(pen, 3);
  draw_end_springs(pen, 3);
  draw_solenoid(pen, kBoxesLeft, -1);
  draw_solenoid(pen, kBoxesLeft + 3 * kPosition, 1);
  add_ports(symbol, pen, def, rest, kFourPorts);
  symbol.drawing = pen.take();
  return symbol;
}

enum class Bypass { none, to_return, inside, own_ports };

// Box of the rest position. The bypass goes from C or P to T, or straight from C to D.
void draw_rest(Pen& pen, double x, Bypass bypass) {
  const double bottom = kBoxesTop + kPositionHeight;
  if (bypass == Bypass::none) return draw_position(pen, x, {});
  pen.box({x, kBoxesTop}, kPosition, kPositionHeight);
  for (const double port : {kFirstPort, kLastPort}) pen.blocked({x + port, kBoxesTop}, 7);
  if (bypass != Bypass::inside) pen.blocked({x + kFirstPort, bottom}, -7);
  if (bypass == Bypass::own_ports) {
    pen.blocked({x + kLastPort, bottom}, -7);
    return pen.arrow({x + kBypassPort, bottom}, {x + kBypassPort, kBoxesTop});
  }
  pen.path(fmt::format("M{:g} {:g}v-14H{:g}v14", x + (bypass == Bypass::inside ? kFirstPort : kBypassPort), bottom,
                       x + kLastPort));
}

Bypass bypass_of(const ComponentDef& def) {
  if (!is_set(def, "bypass_area")) return Bypass::none;
  const std::string c = text_of(def, "port_c"), d = text_of(def, "port_d");
  if (!d.empty() && d != text_of(def, "port_t")) return Bypass::own_ports;
  return !c.empty() && c != text_of(def, "port_p") ? Bypass::to_return : d.empty() ? Bypass::inside : Bypass::own_ports;
}

// Positions that the edges with an area give: two where the spool works one way only. The bypass has ports of its own
// where the scene names a volume for it.
Symbol spool_symbol(const ComponentDef& def) {
  const Bypass bypass = bypass_of(def);
  const Edges forward{.pa = is_set(def, "area_pa"), .bt = is_set(def, "area_bt")};
  const Edges backward{.pb = is_set(def, "area_pb"), .at = is_set(def, "area_at")};
  Symbol symbol{.width = 2 * kBoxesLeft + 3 * kPosition, .height = 56};
  Pen pen;
  const double rest = kBoxesLeft + kPosition;
  draw_position(pen, kBoxesLeft, forward);
  draw_rest(pen, rest, bypass);
  draw_position(pen, rest + kPosition, backward);
  draw_proportional(pen, 3);
  draw_end_springs(pen, 3);
  draw_solenoid(pen, kBoxesLeft, -1);
  draw_solenoid(pen, kBoxesLeft + 3 * kPosition, 1);
  add_ports(symbol, pen, def, rest, kFourPorts);
  constexpr PortKey kBypassPorts[] = {{"port_c", kBypassPort, Role::inlet, Side::bottom},
                                      {"port_d", kBypassPort, Role::outlet, Side::top}};
  if (bypass == Bypass::own_ports || bypass == Bypass::to_return) {
    add_ports(symbol, pen, def, rest, std::span(kBypassPorts).first(bypass == Bypass::own_ports ? 2 : 1));
    for (Port& port : symbol.ports) {
      if (port.net.empty()) port.net = text_of(def, "port_p");  // C is P where only D is named
    }
  }
  symbol.drawing = pen.take();
  return symbol;
}

constexpr SymbolRow kDirectionalRows[] = {
    {"l90ls_valve", l90ls_symbol}, {"four_way_valve", four_way_symbol}, {"spool_valve", spool_symbol}};

}  // namespace

std::span<const SymbolRow> directional_symbols() noexcept {
  return kDirectionalRows;
}

}  // namespace slew::diagram
