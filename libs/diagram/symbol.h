// SPDX-License-Identifier: Apache-2.0
// Symbol of one hydraulic component after ISO 1219-1: lines, ports, name and main figures.
//
// Coordinates in px, x to the right, y down, from the upper left corner of the symbol. A line leaves a symbol upwards
// or downwards, in the lane x of its port; the part between the symbol and the lane belongs to the line.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hydraulics/component_def.h"

namespace slew::diagram {

enum class Role : std::uint8_t {
  inlet,         // flow from the supply, or either end of a restriction
  outlet,        // flow to the load
  back,          // flow to the tank
  pilot,         // pressure without flow
  load_sensing,  // reads the load-sensing pressure of the component `net`
  sensed,        // load-sensing pressure of the component itself
  shaft,         // turned by the component `net`
  drive          // shaft that the component turns
};
enum class Side : std::uint8_t { top, bottom, either };

struct Port {
  std::string key{};  // of the scene: "port_a"
  std::string net{};  // volume, or component of load-sensing pressures and shafts
  Role role = Role::inlet;
  Side side = Side::bottom;
  double lane = 0;                // x of the lane
  double from_x = 0, from_y = 0;  // begin of the line on the symbol
};

// Place of a component in the diagram.
enum class Place : std::uint8_t {
  prime_mover,  // below the pumps
  supply,       // at the bottom
  through,      // above its inlets, below its outlets
  shunt,        // beside what it relieves
  selector,     // of load-sensing pressures, beside the pumps
  store,        // oil at one volume
  actuator      // at the top
};

struct Symbol {
  double width = 0, height = 0;
  std::string drawing{};  // SVG elements
  std::vector<Port> ports{};
  Place place = Place::through;
  bool is_turned = false;  // drawn upside down: its first port is at the top
};

// The symbol of a component by its type and its choices. Pre-condition: has_symbol().
[[nodiscard]] Symbol symbol_of(const hydraulics::ComponentDef& def);

[[nodiscard]] bool has_symbol(std::string_view type) noexcept;

// A fixed volume above the pressure of a tank, as a source.
[[nodiscard]] Symbol fixed_pressure_symbol(const std::string& volume);

// Exchanges top and bottom.
void turn_over(Symbol& symbol);

// Main figures of a component: "140 cm3/rev", "270 bar".
[[nodiscard]] std::vector<std::string> figures_of(const hydraulics::ComponentDef& def);

}  // namespace slew::diagram
