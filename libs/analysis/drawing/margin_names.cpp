// SPDX-License-Identifier: Apache-2.0
#include "analysis/drawing/margin_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "core/escaped.h"
#include "diagram/graph.h"

namespace slew::analysis {
namespace {

constexpr double kNameGap = 8;  // px, between a name and its line

// Places of one margin: near the parts' heights, at least a line apart (pooled means, as in a least-squares fit).
void spread(std::vector<MarginName*> names, double top, double height) {
  std::stable_sort(names.begin(), names.end(), [](const auto* a, const auto* b) { return a->at.y < b->at.y; });
  struct Pool {
    double mean;
    std::size_t first, count;
  };
  std::vector<Pool> pools;
  for (std::size_t i = 0; i < names.size(); ++i) {
    pools.push_back({names[i]->at.y - kMarginLine * static_cast<double>(i), i, 1});
    while (pools.size() > 1 && pools[pools.size() - 2].mean > pools.back().mean) {
      const Pool last = pools.back();
      pools.pop_back();
      Pool& pool = pools.back();
      const auto a = static_cast<double>(pool.count), b = static_cast<double>(last.count);
      pool.mean = (pool.mean * a + last.mean * b) / (a + b);
      pool.count += last.count;
    }
  }
  const double most = top + height - kMarginLine * (static_cast<double>(names.size()) - 0.5);
  for (const Pool& pool : pools) {
    const double mean = std::clamp(pool.mean, top + kMarginLine / 2, std::max(most, top + kMarginLine / 2));
    for (std::size_t i = pool.first; i < pool.first + pool.count; ++i) {
      names[i]->y = mean + kMarginLine * static_cast<double>(i);
    }
  }
}

}  // namespace

double spread_names(std::vector<MarginName>& names, double middle, double top, double height) {
  std::vector<MarginName*> order;
  for (MarginName& name : names) order.push_back(&name);
  std::stable_sort(order.begin(), order.end(), [](const auto* a, const auto* b) { return a->at.x < b->at.x; });
  // by the half of the picture, but neither margin much fuller than the other
  std::size_t left = 0;
  while (left < order.size() && order[left]->at.x < middle) ++left;
  left = std::clamp(left, order.size() * 2 / 5, order.size() - order.size() * 2 / 5);
  for (std::size_t i = 0; i < order.size(); ++i) order[i]->is_left = i < left;
  const std::vector<MarginName*> of_left(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(left));
  const std::vector<MarginName*> of_right(order.begin() + static_cast<std::ptrdiff_t>(left), order.end());
  const double needed = kMarginLine * static_cast<double>(std::max(of_left.size(), of_right.size()));
  spread(of_left, top, std::max(height, needed));
  spread(of_right, top, std::max(height, needed));
  return needed;
}

double margin_width(const std::vector<MarginName>& names) {
  double width = 0;
  for (const MarginName& name : names) width = std::max(width, diagram::name_width(name.text));
  return width + kNameGap;
}

std::string margin_group(const std::vector<MarginName>& names, double left, double right) {
  std::string out = "<g class=\"names\">\n";
  for (const MarginName& name : names) {
    const double edge = name.is_left ? left : right, turn = name.is_left ? left + 14 : right - 14;
    fmt::format_to(std::back_inserter(out), "<path class=\"leader\" d=\"M{:.1f} {:.1f}H{:.1f}L{:.1f} {:.1f}\"/>", edge,
                   name.y, turn, name.at.x, name.at.y);
    fmt::format_to(std::back_inserter(out),
                   "<text class=\"name {}{}\" data-element=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", name.style,
                   name.is_left ? " end" : "", escaped(name.element), name.is_left ? edge - 4 : edge + 4, name.y + 4,
                   escaped(name.text));
  }
  return out + "</g>\n";
}

}  // namespace slew::analysis
