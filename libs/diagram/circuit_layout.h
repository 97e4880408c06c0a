// SPDX-License-Identifier: Apache-2.0
// The diagram of a hydraulic circuit, laid out: symbols in rows, supply below and actuators on top, orthogonal lines in
// the channels between the rows.
//
// Lines run in channels, and pass a row in gaps: they never cross a symbol or a text. Two nets never share a piece of
// line; where they cross there is no dot. Lengths in px, y down.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "diagram/pen.h"
#include "diagram/symbol.h"
#include "hydraulics/hydraulics_def.h"

namespace slew::diagram {

enum class NetKind : std::uint8_t { volume, load_sensing, shaft };
enum class LineKind : std::uint8_t { supply, working, tank, pilot, shaft };

struct Net {
  NetKind kind = NetKind::volume;
  std::string name{};  // volume, or component that the pressure or the torque belongs to
  LineKind line = LineKind::working;
  int level = -1;  // components between it and the supply
  std::vector<std::string> figures{};
};

inline constexpr std::size_t kTankNet = static_cast<std::size_t>(-1);

struct BlockPort : Port {
  std::size_t net_index = kTankNet;  // kTankNet: a tank's symbol stands at the port
};

struct Box {
  double left = 0, top = 0, right = 0, bottom = 0;
};

struct Block {
  std::string name{};  // component; volume of a fixed pressure; empty: a gap that a net passes
  Symbol symbol{};     // its ports are in `ports`
  std::vector<BlockPort> ports{};
  std::vector<std::string> lines{};  // name, figures, input
  bool is_volume = false;
  bool has_values = false;  // a line for values is kept free
  int row = 0;
  double width = 0;     // with the texts at its right
  double x = 0, y = 0;  // of the symbol

  [[nodiscard]] bool is_gap() const noexcept { return name.empty(); }
  [[nodiscard]] Box box() const noexcept;
  [[nodiscard]] Box symbol_box() const noexcept { return {x, y, x + symbol.width, y + symbol.height}; }
  // Where the line of a port begins, and its lane.
  [[nodiscard]] Point begin(const Port& port) const noexcept { return {x + port.from_x, y + port.from_y}; }
  [[nodiscard]] double lane(const Port& port) const noexcept { return x + port.lane; }
};

struct Segment {
  Point a{}, b{};  // horizontal or vertical
  std::size_t net = 0;
  LineKind kind = LineKind::working;
};

// Name and pressure of a volume, on its line.
struct Chip {
  std::size_t net = 0;
  Box box{};
};

struct TankSign {
  std::string volume{};
  Point port{};  // end of the symbol's line
  Side side = Side::bottom;
  bool is_pilot = false;
  double way = 1;  // of a line that turns from the top: to the right or to the left, away from other ports
};

struct CircuitLayout {
  double width = 0, height = 0;
  std::vector<Net> nets;
  std::vector<Block> blocks;
  std::vector<Segment> segments;
  std::vector<std::pair<std::size_t, Point>> dots;  // by net
  std::vector<Chip> chips;
  std::vector<TankSign> tanks;
};

// An input that moves a component.
struct ControlledBy {
  std::string component, input;
};

// Pre-condition: has_symbol() of every component's type.
[[nodiscard]] CircuitLayout lay_out(const hydraulics::HydraulicsDef& circuit,
                                    const std::vector<ControlledBy>& inputs = {});

inline constexpr double kTextLine = 12.5;  // px, distance of two lines of text
inline constexpr double kTextGap = 6;      // px, between a symbol and its text

}  // namespace slew::diagram
