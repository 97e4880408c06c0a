// SPDX-License-Identifier: Apache-2.0
// Area of a telescopic cylinder over its stroke. Its stages have the areas A_1 > A_2 > ... > A_n and end at the strokes
// X_1 < X_2 < ... < X_n. One pressure acts on all of them, so that under a pushing load the largest area moves first on
// the way out, the smallest first on the way in, and the stroke alone states which stage moves:
//   A(x) = A_i for X_(i-1) < x < X_i                                                                          (1)
//   V(x) = int_0^x A dx                                      oil, continuous                                  (2)
//   A = A_i + (A_(i+1) - A_i) (3 t^2 - 2 t^3),  t = (x - X_i)/w + 1/2,  within w/2 of X_i                     (3)
// (3) is the elasticity of the stage's stop: with p_1 A_1 = F = p_2 A_2 the pressure rises from p_1 to
// p_2 = p_1 A_1/A_2 while the stroke passes it. F = p A(x) and (2) keep p dV = F dx: the step creates no energy.
// Source: balances of force and oil. Not covered: masses of the stages, their own friction, loads that pull.
#pragma once

#include <cstddef>
#include <vector>

#include "core/field.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {

class StagedArea {
 public:
  // stages: X_i [m], A_i [m2]; transition: w [m], > 0 and below every stage's length.
  StagedArea(const Table& stages, double transition) : w_(transition) {
    double begin = 0, content = 0;
    for (const auto& [end, area] : stages) {
      stages_.push_back({begin, area, content});
      content += area * (end - begin);
      begin = end;
    }
  }

  // A [m2] and dA/dx [m].
  [[nodiscard]] ValueSlope area_at(double x) const noexcept {
    const std::size_t i = stage_at(x);
    const Step step = step_at(i, x);
    if (step.size == 0) return {stages_[i].area, 0};
    const double t = step.share;
    return {step.lower + step.size * t * t * (3 - 2 * t), 6 * step.size * t * (1 - t) / w_};
  }
  // V [m3]; negative below 0.
  [[nodiscard]] double content_at(double x) const noexcept {
    const std::size_t i = stage_at(x);
    const Step step = step_at(i, x);
    if (step.size == 0) return stages_[i].content + stages_[i].area * (x - stages_[i].begin);
    const double t = step.share, way = w_ * t;
    // from the beginning of the step, w/2 before the end of the stage below
    return step.content - 0.5 * w_ * step.lower + step.lower * way + step.size * way * t * t * (1 - 0.5 * t);
  }
  // Number of the stage that moves at x, 1 for the largest.
  [[nodiscard]] int number_at(double x) const noexcept { return static_cast<int>(stage_at(x)) + 1; }
  [[nodiscard]] double largest() const noexcept { return stages_.front().area; }

 private:
  struct Stage {
    double begin, area, content;  // m, m2, m3 at its beginning
  };
  // Step between two stages: t of (3), area below it, its size, content at its middle.
  struct Step {
    double share = 0, lower = 0, size = 0, content = 0;
  };
  [[nodiscard]] std::size_t stage_at(double x) const noexcept {
    std::size_t i = 0;
    while (i + 1 < stages_.size() && x >= stages_[i + 1].begin) ++i;
    return i;
  }
  [[nodiscard]] Step step_at(std::size_t i, double x) const noexcept {
    const bool is_after = i > 0 && x - stages_[i].begin < 0.5 * w_;
    const bool is_before = i + 1 < stages_.size() && stages_[i + 1].begin - x < 0.5 * w_;
    if (!is_after && !is_before) return {};
    const Stage &below = stages_[is_after ? i - 1 : i], &above = stages_[is_after ? i : i + 1];
    return {(x - above.begin) / w_ + 0.5, below.area, above.area - below.area, above.content};
  }

  std::vector<Stage> stages_;
  double w_;
};

}  // namespace slew::hydraulics
