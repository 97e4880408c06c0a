// SPDX-License-Identifier: Apache-2.0
#include "diagram/arrange.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace slew::diagram {
namespace {

constexpr double kBlockGap = 16, kGapGap = 4;  // px, between blocks, and beside a gap
constexpr double kCrossing = 60;               // px of line that a crossing is worth
constexpr double kSnap = 40;                   // px, longest way of a block to make a line straight
constexpr int kSweeps = 24, kSwapRounds = 6;

// A port in a channel.
struct Pin {
  std::size_t block = 0;
  double lane = 0;  // in the block
  std::size_t net = 0;
};

class Arrangement {
 public:
  explicit Arrangement(Graph& graph)
      : blocks_(graph.blocks),
        rows_(static_cast<std::size_t>(graph.rows)),
        channels_(static_cast<std::size_t>(graph.rows) + 1),
        nets_(graph.nets.size()) {
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      rows_[static_cast<std::size_t>(blocks_[i].row)].push_back(i);
      for (const BlockPort& port : blocks_[i].ports) {
        if (port.net_index == kTankNet) continue;
        const auto channel = static_cast<std::size_t>(graph.channel_of(blocks_[i], port));
        channels_[channel].push_back({i, port.lane, port.net_index});
      }
    }
    for (std::size_t row = 0; row < rows_.size(); ++row) pack(row);
  }

  void run() {
    double best = cost();
    std::vector<double> places = places_now();
    auto order = rows_;
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (std::size_t i = 0; i < rows_.size(); ++i) sort_row(sweep % 2 == 0 ? i : rows_.size() - 1 - i);
      settle();
      if (const double now = cost(); now < best) best = now, places = places_now(), order = rows_;
    }
    rows_ = order;
    restore(places);
    swap_neighbours(best);
    settle();
    for (Block& block : blocks_) block.x = std::round(block.x);
    for (std::size_t row = 0; row < rows_.size(); ++row) snap(row);
    for (std::size_t row = rows_.size(); row-- > 0;) snap(row);
  }

 private:
  [[nodiscard]] double x_of(const Pin& pin) const noexcept { return blocks_[pin.block].x + pin.lane; }
  [[nodiscard]] double distance(std::size_t left, std::size_t right) const noexcept {
    return blocks_[left].width + (blocks_[left].is_gap() || blocks_[right].is_gap() ? kGapGap : kBlockGap);
  }
  [[nodiscard]] std::vector<double> places_now() const {
    std::vector<double> places;
    for (const Block& block : blocks_) places.push_back(block.x);
    return places;
  }
  void restore(const std::vector<double>& places) {
    for (std::size_t i = 0; i < blocks_.size(); ++i) blocks_[i].x = places[i];
  }
  void pack(std::size_t row) {
    for (std::size_t k = 1; k < rows_[row].size(); ++k) {
      const std::size_t left = rows_[row][k - 1];
      blocks_[rows_[row][k]].x = blocks_[left].x + distance(left, rows_[row][k]);
    }
  }

  struct Target {
    double x = 0, weight = 0;
  };
  // Mean place at which the block's ports stand opposite to the ports that they are connected to.
  [[nodiscard]] std::vector<Target> targets() const {
    std::vector<Target> targets(blocks_.size());
    for (const std::vector<Pin>& channel : channels_) {
      std::vector<double> sum(nets_), count(nets_);
      for (const Pin& pin : channel) sum[pin.net] += x_of(pin), count[pin.net] += 1;
      for (const Pin& pin : channel) {
        const double others = count[pin.net] - 1;
        if (others < 1) continue;
        const double mean = (sum[pin.net] - x_of(pin)) / others, weight = 1 / others;
        Target& target = targets[pin.block];
        target.x += weight * (mean - pin.lane);
        target.weight += weight;
      }
    }
    for (std::size_t i = 0; i < targets.size(); ++i) {
      targets[i].x = targets[i].weight > 0 ? targets[i].x / targets[i].weight : blocks_[i].x;
      targets[i].weight = std::max(targets[i].weight, 0.02);
    }
    return targets;
  }
  void sort_row(std::size_t row) {
    const std::vector<Target> all = targets();
    const auto middle = [&](std::size_t i) { return all[i].x + blocks_[i].symbol.width / 2; };
    std::stable_sort(rows_[row].begin(), rows_[row].end(),
                     [&](std::size_t a, std::size_t b) { return middle(a) < middle(b); });
    place(row, all);
  }
  // Pools neighbours that would overlap to their weighted mean.
  void place(std::size_t row, const std::vector<Target>& all) {
    struct Pool {
      double mean, weight;
      std::size_t first;
    };
    const std::vector<std::size_t>& order = rows_[row];
    std::vector<double> offset(order.size(), 0);
    for (std::size_t k = 1; k < order.size(); ++k) offset[k] = offset[k - 1] + distance(order[k - 1], order[k]);
    std::vector<Pool> pools;
    for (std::size_t k = 0; k < order.size(); ++k) {
      pools.push_back({all[order[k]].x - offset[k], all[order[k]].weight, k});
      while (pools.size() > 1 && pools[pools.size() - 2].mean > pools.back().mean) {
        const Pool last = pools.back();
        pools.pop_back();
        Pool& pool = pools.back();
        pool.mean = (pool.mean * pool.weight + last.mean * last.weight) / (pool.weight + last.weight);
        pool.weight += last.weight;
      }
    }
    for (std::size_t p = 0; p < pools.size(); ++p) {
      const std::size_t end = p + 1 < pools.size() ? pools[p + 1].first : order.size();
      for (std::size_t k = pools[p].first; k < end; ++k) blocks_[order[k]].x = pools[p].mean + offset[k];
    }
  }
  void settle() {
    constexpr int kRounds = 6;
    for (int round = 0; round < kRounds; ++round) {
      for (std::size_t i = 0; i < rows_.size(); ++i) place(round % 2 == 0 ? i : rows_.size() - 1 - i, targets());
    }
  }

  // Length of the lines along the channels, and their crossings where the better one of two nets is below.
  [[nodiscard]] double cost() const {
    double cost = 0;
    for (std::size_t c = 0; c < channels_.size(); ++c) cost += channel_cost(c);
    double left = 0, right = 0;
    for (const Block& block : blocks_) left = std::min(left, block.x), right = std::max(right, block.x + block.width);
    return cost + 0.5 * (right - left);
  }
  [[nodiscard]] double channel_cost(std::size_t c) const {
    struct Extent {
      double low = 1e9, high = -1e9;
      std::vector<double> up{}, down{};  // places of lines to the row above and to that below
    };
    std::vector<Extent> extents(nets_);
    std::vector<std::size_t> there;
    for (const Pin& pin : channels_[c]) {
      Extent& extent = extents[pin.net];
      if (extent.low > extent.high) there.push_back(pin.net);
      extent.low = std::min(extent.low, x_of(pin));
      extent.high = std::max(extent.high, x_of(pin));
      (static_cast<std::size_t>(blocks_[pin.block].row) == c ? extent.up : extent.down).push_back(x_of(pin));
    }
    double cost = 0;
    for (std::size_t i = 0; i < there.size(); ++i) {
      const Extent& a = extents[there[i]];
      cost += a.high - a.low;
      for (std::size_t k = 0; k < i; ++k) {
        const Extent& b = extents[there[k]];
        const auto inside = [](const std::vector<double>& lines, const Extent& other) {
          return static_cast<double>(
              std::count_if(lines.begin(), lines.end(), [&](double x) { return other.low < x && x < other.high; }));
        };
        cost += kCrossing * std::min(inside(a.up, b) + inside(b.down, a), inside(b.up, a) + inside(a.down, b));
      }
    }
    return cost;
  }
  void swap_neighbours(double best) {
    for (int round = 0; round < kSwapRounds; ++round) {
      bool has_changed = false;
      for (std::size_t row = 0; row < rows_.size(); ++row) {
        for (std::size_t k = 1; k < rows_[row].size(); ++k) {
          const std::vector<double> places = places_now();
          std::swap(rows_[row][k - 1], rows_[row][k]);
          place(row, targets());
          place(row, targets());
          if (const double now = cost(); now < best - 1e-6) {
            best = now;
            has_changed = true;
          } else {
            std::swap(rows_[row][k - 1], rows_[row][k]);
            restore(places);
          }
        }
      }
      if (!has_changed) break;
      const std::vector<double> places = places_now();
      settle();
      if (const double now = cost(); now < best)
        best = now;
      else
        restore(places);
    }
  }

  // Moves blocks of a row by a little where that makes lines straight.
  void snap(std::size_t row) {
    const std::vector<std::size_t>& order = rows_[row];
    for (std::size_t k = 0; k < order.size(); ++k) {
      const std::size_t block = order[k];
      const double least = k == 0 ? -kSnap : blocks_[order[k - 1]].x + distance(order[k - 1], block) - blocks_[block].x;
      const double most =
          k + 1 == order.size() ? kSnap : blocks_[order[k + 1]].x - distance(block, order[k + 1]) - blocks_[block].x;
      double best = 0;
      int straight = count_straight(block, 0);
      for (const double way : ways(block)) {
        if (way < std::max(least, -kSnap) || way > std::min(most, kSnap)) continue;
        if (const int found = count_straight(block, way); found > straight) straight = found, best = way;
      }
      blocks_[block].x += best;
    }
  }
  template <typename Visit>
  void for_opposite(std::size_t block, Visit&& visit) const {
    for (const std::vector<Pin>& channel : channels_) {
      for (const Pin& own : channel) {
        if (own.block != block) continue;
        for (const Pin& other : channel) {
          if (other.net == own.net && blocks_[other.block].row != blocks_[block].row) visit(own, other);
        }
      }
    }
  }
  [[nodiscard]] std::vector<double> ways(std::size_t block) const {
    std::vector<double> ways;
    for_opposite(block, [&](const Pin& own, const Pin& other) { ways.push_back(x_of(other) - x_of(own)); });
    std::sort(ways.begin(), ways.end(), [](double a, double b) { return std::fabs(a) < std::fabs(b); });
    return ways;
  }
  [[nodiscard]] int count_straight(std::size_t block, double way) const {
    int count = 0;
    for_opposite(block, [&](const Pin& own, const Pin& other) {
      if (std::fabs(x_of(other) - x_of(own) - way) < 0.5) ++count;
    });
    return count;
  }

  std::vector<Block>& blocks_;
  std::vector<std::vector<std::size_t>> rows_;  // from the left
  std::vector<std::vector<Pin>> channels_;
  std::size_t nets_;
};

}  // namespace

void arrange(Graph& graph) {
  Arrangement(graph).run();
}

}  // namespace slew::diagram
