// SPDX-License-Identifier: Apache-2.0
// A sub-step in parts, shorter ones where something begins or ends in it. Internal to the library.
#pragma once

#include <algorithm>
#include <span>

namespace slew::multibody {

// A part that is refused is tried again as a quarter of it, down to 1/1024 of the sub-step; the part after one that is
// taken is four times as long.
class StepParts {
 public:
  // smallest: in 1/1024 of the sub-step h; after `most` divisions no part is divided
  StepParts(double h, int smallest, int most) noexcept : h_(h), smallest_(smallest), most_(most) {}

  [[nodiscard]] double length() const noexcept { return share() * h_; }
  [[nodiscard]] bool is_whole() const noexcept { return part_ == kParts; }
  [[nodiscard]] int taken() const noexcept { return taken_; }

  // Means of the rows' forces, continued along their lines, over this part.
  void put_mean(std::span<const double> mean, std::span<const double> slope, std::span<double> part) const noexcept {
    const double later = h_ * (static_cast<double>(done_) / kParts + 0.5 * share() - 0.5);
    for (std::size_t k = 0; k < mean.size(); ++k) part[k] = mean[k] + later * slope[k];
  }

  [[nodiscard]] bool may_divide() const noexcept { return part_ > smallest_ && divisions_ < most_; }
  void divide() noexcept {
    ++divisions_;
    part_ = std::max(smallest_, part_ / kDivision);
  }
  // To the next part; false: the sub-step is at its end.
  [[nodiscard]] bool take() noexcept {
    ++taken_;
    done_ += part_;
    part_ = std::min(kDivision * part_, kParts - done_);
    return part_ > 0;
  }

 private:
  static constexpr int kParts = 1024, kDivision = 4;

  [[nodiscard]] double share() const noexcept { return static_cast<double>(part_) / kParts; }

  double h_;  // s
  int smallest_, most_;
  int done_ = 0, part_ = kParts, divisions_ = 0, taken_ = 0;
};

// The smallest part, and the most divisions, of an implicit rule.
inline constexpr int kSmallestPart = 1, kMostDivisions = 32;

}  // namespace slew::multibody
