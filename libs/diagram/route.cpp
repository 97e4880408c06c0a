// SPDX-License-Identifier: Apache-2.0
#include "diagram/route.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "diagram/arrange.h"
#include "diagram/channel.h"

namespace slew::diagram {
namespace {

constexpr double kMargin = 16;      // px, around the picture
constexpr double kTankHeight = 24;  // px, below a port
constexpr double kHookHeight = 26;  // px, above a port
constexpr double kNudge = 9;        // px
constexpr int kMostNudges = 200;

std::vector<Channel> channels_of(const Graph& graph) {
  std::vector<Channel> channels(static_cast<std::size_t>(graph.rows) + 1);
  for (std::size_t i = 0; i < graph.blocks.size(); ++i) {
    const Block& block = graph.blocks[i];
    for (const BlockPort& port : block.ports) {
      if (port.net_index == kTankNet) continue;
      Channel& channel = channels[static_cast<std::size_t>(graph.channel_of(block, port))];
      ChannelNet& net = channel.net(port.net_index);
      (port.side == Side::bottom ? net.up : net.down).push_back({block.lane(port), i});
    }
  }
  return channels;
}

// Half of the height of a row over its middle line, and below.
struct RowExtent {
  double above = 0, below = 0;
};
std::vector<RowExtent> row_extents(const Graph& graph) {
  std::vector<RowExtent> rows(static_cast<std::size_t>(graph.rows));
  for (const Block& block : graph.blocks) {
    RowExtent& row = rows[static_cast<std::size_t>(block.row)];
    double above = block.symbol.height / 2, below = above;
    for (const BlockPort& port : block.ports) {
      if (port.net_index != kTankNet) continue;
      if (port.side == Side::top)
        above = std::max(above, block.symbol.height / 2 - port.from_y + kHookHeight);
      else
        below = std::max(below, port.from_y - block.symbol.height / 2 + kTankHeight);
    }
    const Box box = block.box();
    above = std::max(above, block.y + block.symbol.height / 2 - box.top);
    below = std::max(below, box.bottom - block.y - block.symbol.height / 2);
    row.above = std::max(row.above, above);
    row.below = std::max(row.below, below);
  }
  return rows;
}

class Router {
 public:
  explicit Router(Graph graph) : graph_(std::move(graph)) {}

  CircuitLayout run() {
    for (int nudge = 0; nudge < kMostNudges; ++nudge) {
      channels_ = channels_of(graph_);
      choose_chips();
      std::optional<std::size_t> touching;
      for (Channel& channel : channels_) {
        touching = channel.choose_tracks();
        if (touching) break;
      }
      if (!touching) break;
      move_right(*touching);
    }
    set_heights();
    for (std::size_t net = 0; net < graph_.nets.size(); ++net) draw(net);
    add_tanks();
    layout_.nets = std::move(graph_.nets);
    layout_.blocks = std::move(graph_.blocks);
    std::erase_if(layout_.blocks, [](const Block& block) { return block.is_gap(); });
    fit();
    return std::move(layout_);
  }

 private:
  // The block and all that stands right of it in its row.
  void move_right(std::size_t moved) {
    const Block first = graph_.blocks[moved];
    for (Block& block : graph_.blocks) {
      if (block.row == first.row && block.x >= first.x) block.x += kNudge;
    }
  }
  // The name of a volume stands in the channel where its line is longest.
  void choose_chips() {
    for (std::size_t net = 0; net < graph_.nets.size(); ++net) {
      if (graph_.nets[net].kind != NetKind::volume || is_named(net)) continue;
      Channel* best = nullptr;
      double longest = -1;
      for (Channel& channel : channels_) {
        const ChannelNet* found = channel.find(net);
        if (found != nullptr && found->high() - found->low() > longest) {
          longest = found->high() - found->low();
          best = &channel;
        }
      }
      if (best != nullptr) best->place_chip(net, chip_width(graph_.nets[net]));
    }
  }
  // A fixed pressure has its name beside its symbol.
  [[nodiscard]] bool is_named(std::size_t net) const {
    return std::any_of(graph_.blocks.begin(), graph_.blocks.end(),
                       [&](const Block& block) { return block.is_volume && block.name == graph_.nets[net].name; });
  }
  static double chip_width(const Net& net) {
    double width = kChipValue;
    width = std::max(width, name_width(net.name));
    for (const std::string& figure : net.figures) width = std::max(width, figure_width(figure));
    return std::ceil(width + 10);
  }
  // y of rows and tracks, from the top
  void set_heights() {
    const std::vector<RowExtent> rows = row_extents(graph_);
    double y = 0;
    for (std::size_t c = channels_.size(); c-- > 0;) {
      y = channels_[c].set_heights(y);
      if (c == 0) break;
      const RowExtent& row = rows[c - 1];
      for (Block& block : graph_.blocks) {
        if (static_cast<std::size_t>(block.row) == c - 1) {
          block.y = std::round(y + row.above) - std::floor(block.symbol.height / 2);
        }
      }
      y += std::ceil(row.above + row.below);
    }
  }

  void add_segment(std::size_t net, Point a, Point b, LineKind kind) {
    if (std::fabs(a.x - b.x) + std::fabs(a.y - b.y) > 0) layout_.segments.push_back({a, b, net, kind});
  }
  [[nodiscard]] LineKind kind_of(const Port& port, std::size_t net) const noexcept {
    return port.role == Role::pilot ? LineKind::pilot : graph_.nets[net].line;
  }
  void draw(std::size_t net) {
    for (Channel& channel : channels_) {
      const ChannelNet* found = channel.find(net);
      if (found == nullptr || !found->track_y) continue;
      const LineKind kind = graph_.nets[net].line;
      add_segment(net, {found->low(), *found->track_y}, {found->high(), *found->track_y}, kind);
      if (found->chip) {
        const double half = found->chip_height() / 2;
        layout_.chips.push_back(
            {net, {found->chip->left, *found->track_y - half, found->chip->right, *found->track_y + half}});
      }
      add_dots(net, *found);
    }
    for (const Block& block : graph_.blocks) {
      for (const BlockPort& port : block.ports) {
        if (port.net_index == net) draw_port(net, block, port);
      }
    }
  }
  // From the symbol to its lane, and on to the track; where the net has none in the channel, to the port opposite.
  void draw_port(std::size_t net, const Block& block, const BlockPort& port) {
    const LineKind kind = kind_of(port, net);
    const Point begin = block.begin(port), turn{block.lane(port), begin.y};
    add_segment(net, begin, turn, kind);
    const Channel& channel = channels_[static_cast<std::size_t>(graph_.channel_of(block, port))];
    const ChannelNet* found = channel.find(net);
    const double end = found->track_y.value_or(channel.middle());
    add_segment(net, turn, {turn.x, end}, kind);
  }
  void add_dots(std::size_t net, const ChannelNet& found) {
    std::vector<double> places;
    for (const auto* lines : {&found.up, &found.down}) {
      for (const ChannelLine& line : *lines) places.push_back(line.x);
    }
    std::sort(places.begin(), places.end());
    places.erase(std::unique(places.begin(), places.end()), places.end());
    for (const double x : places) {
      const auto has = [&](const std::vector<ChannelLine>& lines) {
        return std::any_of(lines.begin(), lines.end(), [&](const ChannelLine& line) { return line.x == x; });
      };
      const int ways = has(found.up) + has(found.down) + (x > found.low()) + (x < found.high());
      if (found.chip && found.chip->left <= x && x <= found.chip->right) continue;
      if (ways > 2) layout_.dots.push_back({net, {x, *found.track_y}});
    }
  }
  void add_tanks() {
    for (const Block& block : graph_.blocks) {
      for (const BlockPort& port : block.ports) {
        if (port.net_index != kTankNet) continue;
        const bool has_right = std::any_of(block.ports.begin(), block.ports.end(), [&](const BlockPort& other) {
          return other.side == port.side && other.lane > port.lane;
        });
        layout_.tanks.push_back(
            {port.net, block.begin(port), port.side, port.role == Role::pilot, has_right ? -1.0 : 1.0});
      }
    }
  }
  // Moves the picture so that it begins at the margin.
  void fit() {
    double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
    const auto hold = [&](const Box& box) {
      left = std::min(left, box.left), right = std::max(right, box.right);
      top = std::min(top, box.top), bottom = std::max(bottom, box.bottom);
    };
    for (const Block& block : layout_.blocks) hold(block.box());
    for (const Chip& chip : layout_.chips) hold(chip.box);
    for (const Segment& one : layout_.segments) {
      hold({std::min(one.a.x, one.b.x), std::min(one.a.y, one.b.y), std::max(one.a.x, one.b.x),
            std::max(one.a.y, one.b.y)});
    }
    for (const TankSign& tank : layout_.tanks)
      hold({tank.port.x - 24, tank.port.y, tank.port.x + 24, tank.port.y + kTankHeight});
    const double dx = kMargin - std::floor(left), dy = kMargin - std::floor(top);
    const auto move = [&](Point& point) { point.x += dx, point.y += dy; };
    for (Block& block : layout_.blocks) block.x += dx, block.y += dy;
    for (Segment& one : layout_.segments) move(one.a), move(one.b);
    for (auto& [net, point] : layout_.dots) move(point);
    for (TankSign& tank : layout_.tanks) move(tank.port);
    for (Chip& chip : layout_.chips) {
      chip.box = {chip.box.left + dx, chip.box.top + dy, chip.box.right + dx, chip.box.bottom + dy};
    }
    layout_.width = std::ceil(right + dx + kMargin);
    layout_.height = std::ceil(bottom + dy + kMargin);
  }

  static constexpr double kChipValue = 58;  // px, room for a pressure

  Graph graph_;
  std::vector<Channel> channels_;
  CircuitLayout layout_;
};

}  // namespace

CircuitLayout route(Graph graph) {
  return Router(std::move(graph)).run();
}

Box Block::box() const noexcept {
  const double middle = y + symbol.height / 2;
  const double text = kTextLine * static_cast<double>(lines.size() + (has_values ? 1 : 0)) / 2;
  return {x, std::min(y, middle - text), x + width, std::max(y + symbol.height, middle + text)};
}

CircuitLayout lay_out(const hydraulics::HydraulicsDef& circuit, const std::vector<ControlledBy>& inputs) {
  Graph graph = build_graph(circuit, inputs);
  arrange(graph);
  return route(std::move(graph));
}

}  // namespace slew::diagram
