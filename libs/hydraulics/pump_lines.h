// SPDX-License-Identifier: Apache-2.0
// Which volumes are joined whatever the signals are, and warnings about pumps whose line has no relief.
//
// A pump's line is its outlet and every volume connected to it at any control signal: through orifices, bleeds, laminar
// restrictions, lines, filters, flow dividers, compensated orifices, four-way valves without gain, from the inlets of
// shuttle valves to their outlet, past a priority valve, and through check valves, those of counterbalance and hose
// burst valves too, in their free direction; through relief, shock and counterbalance valves that are set below the end
// of the oil law, if their pilot is on the line; by what has a nominal flow only if it passes the pump's flow below
// that end. The line is relieved where it reaches a fixed volume, a pressure source or the pump's own inlet. A flow
// divider leads there if both of its branches do, or if the least opening of its spool passes the pump's flow. Leaks do
// not count: they pass the pump's flow only at pressures far beyond any limit. A pressure controller of the pump does
// not count either: it acts at its setting and after its delay.
#pragma once

#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/problem.h"
#include "hydraulics/hydraulics_def.h"

namespace slew::hydraulics {

// What the components of a circuit add by ComponentDef::add_lines().
struct PumpLines {
  struct Connection {
    std::string a, b;                                       // volumes
    double flow = std::numeric_limits<double>::infinity();  // m3/s, the most that passes below the end of the oil's law
    bool is_one_way = false;                                // from a to b only
    std::string pilot{};                                    // volume whose pressure opens it; empty: a
  };
  // From the common port into both branches, or into none.
  struct Divider {
    std::string common, branch_2, branch_3;  // volumes
  };
  struct Pump {
    std::string name, outlet, inlet;  // component, volumes
    std::string key = "port_a";       // field that a warning names
    double flow = 0;                  // m3/s, the most that it delivers
    double pressure = 0;              // Pa above tank, at which its controller ends; infinite: it has none
  };
  // A valve that opens its volume to another one from a pressure on, whatever the signals are.
  struct Limit {
    std::string valve, volume, outlet;
    double setting = 0;  // Pa above the outlet
  };
  struct Accumulator {
    std::string name, volume;
    double precharge = 0;  // Pa absolute
  };
  double oil_density = 0;          // kg/m3
  std::vector<Connection> open{};  // volumes that are connected whatever the signals, by valves from a pressure on
  std::vector<Divider> dividers{};
  std::set<std::string> held{};                                     // volumes at a given pressure
  std::vector<std::pair<std::string, std::string>> open_at_rest{};  // volumes beside a valve that flow alone shuts
  std::set<std::string> supply{};  // volumes that begin at the pump pressure in an equilibrium start
  std::vector<Pump> pumps{};
  std::vector<Limit> limits{};
  std::vector<Accumulator> accumulators{};
};

// Pre-condition: a def whose references are valid.
[[nodiscard]] PumpLines lines_of(const HydraulicsDef& def);

// Pairs of volumes between which oil passes both ways at rest: open connections without a pilot, hose-burst valves,
// flow dividers.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> open_passages(const PumpLines& lines);

// By volume: a number that it shares with all volumes that open passages join it to; -1: a fixed volume. Pre-condition:
// a validated def.
[[nodiscard]] std::vector<int> joined_by_passages(const HydraulicsDef& def);

// One warning for each such pump. Pre-condition: validate() found no error so far.
void find_unrelieved_pumps(const HydraulicsDef& def, Problems& warnings);

}  // namespace slew::hydraulics
