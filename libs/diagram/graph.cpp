// SPDX-License-Identifier: Apache-2.0
#include "diagram/graph.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "core/display.h"
#include "plotting/svg_text.h"

namespace slew::diagram {
namespace {

using hydraulics::HydraulicsDef;
using hydraulics::VolumeDef;

constexpr double kTankBelow = 5e5;                                // Pa absolute: a fixed volume below it is a tank
constexpr double kValuesWidth = 84;                               // px, of the line for values
constexpr double kNameSize = 12.0 / 12, kFigureSize = 10.0 / 12;  // of text_width()'s letters

bool is_tank(const VolumeDef& volume) noexcept {
  return volume.fixed && volume.initial_pressure < kTankBelow;
}

NetKind kind_of(Role role) noexcept {
  switch (role) {
    case Role::load_sensing:
    case Role::sensed:
      return NetKind::load_sensing;
    case Role::shaft:
    case Role::drive:
      return NetKind::shaft;
    default:
      return NetKind::volume;
  }
}

// Blocks and nets of a circuit, before their rows.
class GraphBuilder {
 public:
  explicit GraphBuilder(const HydraulicsDef& circuit) {
    for (const VolumeDef& volume : circuit.volumes) volumes_.emplace(volume.name, &volume);
  }

  void add_component(const hydraulics::ComponentDef& def, const std::vector<ControlledBy>& inputs) {
    Block block{.name = def.name, .symbol = symbol_of(def), .ports = {}, .lines = {def.name}};
    for (std::string& figure : figures_of(def)) block.lines.push_back(std::move(figure));
    for (const ControlledBy& input : inputs) {
      if (input.component == def.name) block.lines.push_back("< " + input.input);
    }
    block.has_values = block.symbol.place != Place::store || def.type_name() != "hose";
    add(std::move(block));
  }
  void add_fixed_pressure(const VolumeDef& volume) {
    if (!volume.fixed || is_tank(volume) || !index_.contains({NetKind::volume, volume.name})) return;
    add({.name = volume.name,
         .symbol = fixed_pressure_symbol(volume.name),
         .ports = {},
         .lines = {volume.name, chosen_text(volume.initial_pressure, "Pa")},
         .is_volume = true});
  }
  Graph take() {
    drop_unread();
    for (Block& block : graph_.blocks) orient(block);
    return std::move(graph_);
  }

 private:
  void add(Block block) {
    double text = block.has_values ? kValuesWidth : 0;
    for (std::size_t i = 0; i < block.lines.size(); ++i) {
      text = std::max(text, i == 0 ? name_width(block.lines[i]) : figure_width(block.lines[i]));
    }
    block.width = block.symbol.width + kTextGap + text;
    for (const Port& port : block.symbol.ports) block.ports.push_back({port, net_of(port)});
    block.symbol.ports.clear();
    graph_.blocks.push_back(std::move(block));
  }
  std::size_t net_of(const Port& port) {
    const NetKind kind = kind_of(port.role);
    const auto volume = volumes_.find(port.net);
    if (kind == NetKind::volume && volume != volumes_.end() && is_tank(*volume->second)) return kTankNet;
    const auto [place, is_new] = index_.emplace(std::pair(kind, port.net), graph_.nets.size());
    if (is_new) {
      Net net{.kind = kind, .name = port.net};
      if (kind == NetKind::volume && volume != volumes_.end() && volume->second->rigid_volume > 0) {
        net.figures.push_back(chosen_text(volume->second->rigid_volume, "m3"));
      }
      graph_.nets.push_back(std::move(net));
    }
    return place->second;
  }
  // Removes ports of load-sensing pressures that no component reads, and their nets' lines.
  void drop_unread() {
    std::vector<std::size_t> count(graph_.nets.size());
    for (const Block& block : graph_.blocks) {
      for (const BlockPort& port : block.ports) {
        if (port.net_index != kTankNet) ++count[port.net_index];
      }
    }
    for (Block& block : graph_.blocks) {
      std::erase_if(block.ports, [&](const BlockPort& port) {
        return (port.role == Role::sensed || port.role == Role::drive) && count[port.net_index] < 2;
      });
    }
  }
  // A component between a line and the tank stands beside the line, with the tank below.
  static void orient(Block& block) {
    if (block.symbol.place != Place::through) return;
    const auto flows = [&](Role role) {
      return std::count_if(block.ports.begin(), block.ports.end(),
                           [&](const BlockPort& port) { return port.role == role; });
    };
    if (flows(Role::inlet) != 1 || flows(Role::outlet) != 1 || flows(Role::back) != 0) return;
    for (const BlockPort& port : block.ports) {
      if (port.net_index != kTankNet || (port.role != Role::inlet && port.role != Role::outlet)) continue;
      block.symbol.place = Place::shunt;
      if (port.role == Role::outlet) turn_block(block);
      return;
    }
  }

 public:
  static void turn_block(Block& block) {
    for (BlockPort& port : block.ports) block.symbol.ports.push_back(port);
    turn_over(block.symbol);
    for (std::size_t i = 0; i < block.ports.size(); ++i) static_cast<Port&>(block.ports[i]) = block.symbol.ports[i];
    block.symbol.ports.clear();
  }

 private:
  std::map<std::string, const VolumeDef*> volumes_;
  std::map<std::pair<NetKind, std::string>, std::size_t> index_;
  Graph graph_;
};

bool is_reversible(const Block& block) noexcept {
  int inlets = 0, others = 0, outlets = 0;
  for (const BlockPort& port : block.ports) {
    inlets += port.role == Role::inlet;
    outlets += port.role == Role::outlet;
    others += port.role == Role::back;
  }
  return inlets == 1 && outlets == 1 && others == 0;
}

// Distance of each volume from the supply, and rows of the blocks by it.
class Rows {
 public:
  explicit Rows(Graph& graph) : graph_(graph) {}

  void find() {
    for (const Block& block : graph_.blocks) {
      if (block.symbol.place == Place::supply) seed(block, Role::outlet, 0);
    }
    mark_returns();
    do {
      spread();
    } while (seed_rest());
    place();
  }

 private:
  [[nodiscard]] int& level(const BlockPort& port) { return graph_.nets[port.net_index].level; }
  // Least level at the ports of a role; -1: none is known.
  [[nodiscard]] int least(const Block& block, Role role) {
    int found = -1;
    for (const BlockPort& port : block.ports) {
      if (port.role != role || port.net_index == kTankNet || level(port) < 0) continue;
      found = found < 0 ? level(port) : std::min(found, level(port));
    }
    return found;
  }
  bool seed(const Block& block, Role role, int value) {
    bool has_changed = false;
    for (const BlockPort& port : block.ports) {
      if (port.role != role || port.net_index == kTankNet) continue;
      if (level(port) >= 0 && level(port) <= value) continue;
      level(port) = value;
      has_changed = true;
    }
    return has_changed;
  }
  // Lines that valves return into, and that no pump feeds, lie beside the supply.
  void mark_returns() {
    for (const Block& block : graph_.blocks) {
      for (const BlockPort& port : block.ports) {
        if (port.role != Role::back || port.net_index == kTankNet || level(port) >= 0) continue;
        level(port) = 0;
        graph_.nets[port.net_index].line = LineKind::tank;
      }
    }
  }
  void spread() {
    bool has_changed = true;
    while (has_changed) {
      has_changed = false;
      for (const Block& block : graph_.blocks) {
        if (block.symbol.place != Place::through) continue;
        const int in = least(block, Role::inlet), out = least(block, Role::outlet);
        if (in >= 0) has_changed |= seed(block, Role::outlet, in + 1);
        if (out >= 0 && is_reversible(block)) has_changed |= seed(block, Role::inlet, out + 1);
      }
    }
  }
  // A level for the first volume that no supply feeds.
  bool seed_rest() {
    for (const Role role : {Role::inlet, Role::outlet, Role::pilot}) {
      for (const Block& block : graph_.blocks) {
        for (const BlockPort& port : block.ports) {
          if (port.role != role || port.net_index == kTankNet || level(port) >= 0) continue;
          level(port) = 0;
          return true;
        }
      }
    }
    return false;
  }
  void place() {
    int top = 0;
    bool has_engine = false;
    for (Block& block : graph_.blocks) {
      const int in = least(block, Role::inlet), out = least(block, Role::outlet);
      const int lower = in < 0 ? std::max(out, 0) : out < 0 ? in : std::min(in, out);
      switch (block.symbol.place) {
        case Place::through:
          block.row = lower + 1;
          if (is_reversible(block) && out >= 0 && out < in) GraphBuilder::turn_block(block);
          break;
        case Place::shunt:
          block.row = lower;
          break;
        case Place::store:
          block.row = lower + 1;
          break;
        case Place::prime_mover:
          has_engine = true;
          block.row = -1;
          break;
        default:
          block.row = 0;
      }
      top = std::max(top, block.row + (block.symbol.place == Place::through ? 1 : 0));
    }
    int highest = 0;
    for (Block& block : graph_.blocks) {
      if (block.symbol.place == Place::actuator) block.row = top;
      if (has_engine) ++block.row;
      highest = std::max(highest, block.row);
    }
    graph_.rows = highest + 1;
  }

  Graph& graph_;
};

// Sides of the ports that may stand on either: towards the other ports of their nets.
void choose_sides(Graph& graph) {
  std::vector<std::vector<int>> channels(graph.nets.size());
  for (const Block& block : graph.blocks) {
    for (const BlockPort& port : block.ports) {
      if (port.net_index != kTankNet && port.side != Side::either) {
        channels[port.net_index].push_back(graph.channel_of(block, port));
      }
    }
  }
  for (Block& block : graph.blocks) {
    for (BlockPort& port : block.ports) {
      if (port.side != Side::either) continue;
      port.side = Side::bottom;
      if (port.net_index == kTankNet) continue;
      const std::vector<int>& others = channels[port.net_index];
      const auto distance = [&](int channel) {
        int least = others.empty() ? 0 : 1000;
        for (const int other : others) least = std::min(least, std::abs(other - channel));
        return least;
      };
      if (distance(block.row + 1) < distance(block.row)) port.side = Side::top;
      channels[port.net_index].push_back(graph.channel_of(block, port));
    }
  }
}

void add_gaps(Graph& graph) {
  constexpr double kGapWidth = 14;  // px
  std::vector<std::pair<int, int>> extent(graph.nets.size(), {1000, -1});
  for (const Block& block : graph.blocks) {
    for (const BlockPort& port : block.ports) {
      if (port.net_index == kTankNet) continue;
      auto& [low, high] = extent[port.net_index];
      low = std::min(low, graph.channel_of(block, port));
      high = std::max(high, graph.channel_of(block, port));
    }
  }
  for (std::size_t net = 0; net < graph.nets.size(); ++net) {
    for (int row = extent[net].first; row < extent[net].second; ++row) {
      Block gap{.symbol = {.width = kGapWidth}, .ports = {}, .row = row, .width = kGapWidth};
      for (const Side side : {Side::top, Side::bottom}) {
        BlockPort port;
        port.net_index = net;
        port.side = side;
        port.lane = port.from_x = kGapWidth / 2;
        gap.ports.push_back(std::move(port));
      }
      graph.blocks.push_back(std::move(gap));
    }
  }
}

// Lines by what they carry.
void choose_lines(Graph& graph) {
  std::vector<int> flows(graph.nets.size()), pilots(graph.nets.size());
  for (const Block& block : graph.blocks) {
    for (const BlockPort& port : block.ports) {
      if (port.net_index != kTankNet) ++(port.role == Role::pilot ? pilots : flows)[port.net_index];
    }
  }
  for (std::size_t i = 0; i < graph.nets.size(); ++i) {
    Net& net = graph.nets[i];
    if (net.kind == NetKind::shaft) {
      net.line = LineKind::shaft;
    } else if (net.kind == NetKind::load_sensing || (flows[i] < 2 && pilots[i] > 0)) {
      net.line = LineKind::pilot;
    } else if (net.line != LineKind::tank && net.level == 0) {
      net.line = LineKind::supply;
    }
  }
}

}  // namespace

double name_width(std::string_view text) {
  return kNameSize * plotting::text_width(text);
}

double figure_width(std::string_view text) {
  return kFigureSize * plotting::text_width(text);
}

Graph build_graph(const HydraulicsDef& circuit, const std::vector<ControlledBy>& inputs) {
  GraphBuilder builder(circuit);
  for (const auto& component : circuit.components) builder.add_component(*component, inputs);
  for (const VolumeDef& volume : circuit.volumes) builder.add_fixed_pressure(volume);
  Graph graph = builder.take();
  Rows(graph).find();
  choose_sides(graph);
  choose_lines(graph);
  add_gaps(graph);
  return graph;
}

}  // namespace slew::diagram
