// SPDX-License-Identifier: Apache-2.0
#include "diagram/channel.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace slew::diagram {
namespace {

constexpr double kClear = 7;                        // px, least distance of lines of two nets
constexpr double kChipClear = 8, kPieceClear = 12;  // px, beside a name, between two pieces on a track
constexpr double kTrack = 14, kChipTrack = 36;      // px, heights of tracks
constexpr double kEdge = 12, kEmpty = 18;           // px, beside the rows; height of a channel without tracks
constexpr int kTouching = 1000;                     // cost of lines that touch, over that of a crossing

template <typename Visit>
void for_lines(const ChannelNet& net, Visit&& visit) {
  for (const auto* lines : {&net.up, &net.down}) {
    for (const ChannelLine& line : *lines) visit(line);
  }
}

int count_inside(const std::vector<ChannelLine>& lines, const ChannelNet& other) {
  return static_cast<int>(std::count_if(lines.begin(), lines.end(), [&](const ChannelLine& line) {
    return other.low() < line.x && line.x < other.high();
  }));
}

// The lines of b from above that stand near a line of a from below: they touch where a is above b.
const ChannelLine* touching_line(const ChannelNet& above, const ChannelNet& below) {
  for (const ChannelLine& line : below.up) {
    for (const ChannelLine& other : above.down) {
      if (std::fabs(line.x - other.x) < kClear) return &line;
    }
  }
  return nullptr;
}

// The first one's track is below the second one's.
int cost_of(const ChannelNet& below, const ChannelNet& above) {
  int cost = count_inside(below.up, above) + count_inside(above.down, below);
  if (touching_line(above, below) != nullptr) cost += kTouching;
  return cost;
}

// Order from the bottom with few crossings: each net at its best place until none moves.
std::vector<ChannelNet*> ordered(std::vector<ChannelNet>& nets) {
  std::vector<ChannelNet*> order;
  for (ChannelNet& net : nets) {
    if (net.needs_track()) order.push_back(&net);
  }
  constexpr int kRounds = 8;
  for (int round = 0; round < kRounds; ++round) {
    bool has_moved = false;
    for (std::size_t from = 0; from < order.size(); ++from) {
      ChannelNet* moved = order[from];
      std::vector<ChannelNet*> rest = order;
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(from));
      int cost = 0;  // of the place at the bottom
      for (const ChannelNet* other : rest) cost += cost_of(*moved, *other);
      int now = 0, best = 0;
      std::vector<int> costs = {cost};
      for (const ChannelNet* other : rest) costs.push_back(cost += cost_of(*other, *moved) - cost_of(*moved, *other));
      now = costs[from];
      best = *std::min_element(costs.begin(), costs.end());
      if (best >= now) continue;
      const auto place = std::min_element(costs.begin(), costs.end()) - costs.begin();
      rest.insert(rest.begin() + place, moved);
      order = std::move(rest);
      has_moved = true;
    }
    if (!has_moved) break;
  }
  return order;
}

bool overlap(const ChannelNet& a, const ChannelNet& b) {
  return a.low() < b.high() + kPieceClear && b.low() < a.high() + kPieceClear;
}

}  // namespace

double ChannelNet::low() const noexcept {
  double low = chip ? chip->left : 1e9;
  for_lines(*this, [&](const ChannelLine& line) { low = std::min(low, line.x); });
  return low;
}

double ChannelNet::high() const noexcept {
  double high = chip ? chip->right : -1e9;
  for_lines(*this, [&](const ChannelLine& line) { high = std::max(high, line.x); });
  return high;
}

ChannelNet& Channel::net(std::size_t index) {
  for (ChannelNet& one : nets_) {
    if (one.net == index) return one;
  }
  nets_.push_back({.net = index});
  return nets_.back();
}

const ChannelNet* Channel::find(std::size_t index) const noexcept {
  for (const ChannelNet& one : nets_) {
    if (one.net == index) return &one;
  }
  return nullptr;
}

void Channel::place_chip(std::size_t index, double width) {
  ChannelNet& own = net(index);
  const double low = own.low(), high = own.high(), middle = (low + high) / 2;
  const auto is_free = [&](double left) {
    bool is_clear = true;
    for (const ChannelNet& other : nets_) {
      if (other.net == index) continue;
      for_lines(other, [&](const ChannelLine& line) {
        if (left - kChipClear < line.x && line.x < left + width + kChipClear) is_clear = false;
      });
    }
    return is_clear;
  };
  // px of way that covering a line of its own, or standing outside of the line, is worth
  constexpr double kStep = 2, kCovered = 30, kOutside = 3;
  double best = 1e18, place = high + kChipClear;
  for (double left = low - 3 * width - 400; left < high + 3 * width + 400; left += kStep) {
    double cost = std::fabs(left + width / 2 - middle) / 4;
    cost += kOutside * (std::max(0.0, low - left) + std::max(0.0, left + width - high));
    for_lines(own, [&](const ChannelLine& line) {
      if (left - kChipClear < line.x && line.x < left + width + kChipClear) cost += kCovered;
    });
    if (cost >= best || !is_free(left)) continue;
    best = cost;
    place = left;
  }
  own.chip = ChannelNet::Span{std::round(place), std::round(place) + width};
}

std::optional<std::size_t> Channel::choose_tracks() {
  const std::vector<ChannelNet*> order = ordered(nets_);
  for (std::size_t i = 0; i < order.size(); ++i) {
    ChannelNet& own = *order[i];
    own.track = 0;
    for (std::size_t k = 0; k < i; ++k) {
      const ChannelNet& below = *order[k];
      if (const ChannelLine* line = touching_line(own, below)) return line->block;
      // above those that it would meet, and those whose lines it has to let pass
      const bool has_order = overlap(own, below) || touching_line(below, own) != nullptr;
      if (has_order) own.track = std::max(own.track, below.track + 1);
    }
  }
  return std::nullopt;
}

double Channel::set_heights(double top) {
  int tracks = 0;
  for (const ChannelNet& one : nets_) tracks = std::max(tracks, one.track + 1);
  std::vector<double> heights(static_cast<std::size_t>(tracks), kTrack);
  for (const ChannelNet& one : nets_) {
    if (one.chip) heights[static_cast<std::size_t>(one.track)] = kChipTrack;
  }
  double height = tracks == 0 ? kEmpty : 2 * kEdge;
  for (const double one : heights) height += one;
  const double bottom = top + height;
  middle_ = top + height / 2;
  for (ChannelNet& one : nets_) {
    if (one.track < 0) continue;
    double y = bottom - kEdge;
    for (int below = 0; below < one.track; ++below) y -= heights[static_cast<std::size_t>(below)];
    one.track_y = y - heights[static_cast<std::size_t>(one.track)] / 2;
  }
  return bottom;
}

}  // namespace slew::diagram
