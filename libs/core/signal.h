// SPDX-License-Identifier: Apache-2.0
// A signal over one step as straight pieces; a tick carries one value for it.
#pragma once

#include <vector>

namespace slew {

struct SignalPiece {
  double share;       // part of the step's length, 0 < share <= 1; the shares of a step add up to 1
  double begin, end;  // a straight line from one to the other; the next piece may begin elsewhere, after a jump
};
using SignalCourse = std::vector<SignalPiece>;

// Mean value over the step; for a constant signal its value, bit for bit.
class SignalMean {
 public:
  void add(double share, double begin, double end) noexcept {
    if (!has_begun_) base_ = begin;
    has_begun_ = true;
    excess_ += share * (0.5 * (begin + end) - base_);
  }
  [[nodiscard]] double value() const noexcept { return base_ + excess_; }

 private:
  bool has_begun_ = false;
  double base_ = 0, excess_ = 0;
};

}  // namespace slew
