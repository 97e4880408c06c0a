// SPDX-License-Identifier: Apache-2.0
#include "io_node/input_shape.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace slew::io_node {
namespace {

// (1), and the mean over the step
class Ramp {
 public:
  Ramp(double start, double most) : value_(start), most_(most) {}

  void follow(double share, double begin, double end) noexcept {
    if (!(share > 0)) return;
    if (std::isinf(most_)) {
      add(share, begin, end);
      return;
    }
    const double slope = (end - begin) / share;
    if (const double gap = begin - value_; gap != 0) {
      const double rate = std::copysign(most_, gap);
      const double closing = rate - slope;
      const double meets = gap * closing > 0 ? gap / closing : share;
      if (meets >= share) {
        add(share, value_, value_ + rate * share);
        return;
      }
      begin += slope * meets;
      add(meets, value_, begin);
      share -= meets;
    }
    add(share, begin, std::fabs(slope) <= most_ ? end : begin + std::copysign(most_, slope) * share);
  }
  [[nodiscard]] double value() const noexcept { return value_; }
  [[nodiscard]] double mean() const noexcept { return std::clamp(mean_.value(), -1.0, 1.0); }

 private:
  void add(double share, double begin, double end) noexcept {
    mean_.add(share, begin, end);
    value_ = end;
  }
  double value_, most_;
  SignalMean mean_;
};

// The piece without what lies in the dead zone, which is cut to 0.
void follow_outside(double zone, const SignalPiece& piece, Ramp& ramp) noexcept {
  const double change = piece.end - piece.begin;
  const auto at = [&](double part) { return part >= 1 ? piece.end : piece.begin + change * part; };
  // where the line enters and leaves it
  std::array<double, 4> parts{0, 1, 1, 1};
  if (change != 0 && zone > 0) {
    const double first = (-zone - piece.begin) / change, second = (zone - piece.begin) / change;
    parts[1] = std::clamp(std::min(first, second), 0.0, 1.0);
    parts[2] = std::clamp(std::max(first, second), 0.0, 1.0);
  }
  for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
    const double from = parts[i], to = parts[i + 1];
    const bool is_cut = std::fabs(at(0.5 * (from + to))) < zone;
    ramp.follow((to - from) * piece.share, is_cut ? 0 : at(from), is_cut ? 0 : at(to));
  }
}

}  // namespace

ShapedStep shape_step(std::span<const SignalPiece> raw, double dead_zone, double most, double start) noexcept {
  SignalMean raw_mean;
  Ramp ramp(start, most);
  for (const SignalPiece& piece : raw) {
    raw_mean.add(piece.share, piece.begin, piece.end);
    follow_outside(dead_zone, piece, ramp);
  }
  return {std::clamp(raw_mean.value(), -1.0, 1.0), ramp.mean(), ramp.value()};
}

}  // namespace slew::io_node
