// SPDX-License-Identifier: Apache-2.0
// Loads that follow a table of the time: their share in the rows' free accelerations over a sub-step is computed before
// the sub-step.
#pragma once

#include <cstddef>
#include <vector>

#include "mechanics_node/mechanism.h"

namespace slew::mechanics_node {

class TimedLoads {
 public:
  // Allocates; nothing else does.
  explicit TimedLoads(const Mechanism& mechanism);

  // Before a sub-step of h [s]. Evaluates the mechanism.
  void look_ahead(Mechanism& mechanism, double h) noexcept;

  // Change of a row's free acceleration over the sub-step by the loads alone, as the integrator will see it: to add to
  // a_free [m/s2 or rad/s2], and its rate [1/s of it].
  struct Course {
    double start = 0, rate = 0;
  };
  [[nodiscard]] Course course(std::size_t row, double a_free, double h) const noexcept {
    return has_course_ ? course_of(row, a_free, h) : Course{};
  }
  // Change of the row's free acceleration over the sub-step by the loads alone, at its end.
  [[nodiscard]] double change(std::size_t row) const noexcept { return exist_ ? end_[row] - begin_[row] : 0.0; }

 private:
  [[nodiscard]] Course course_of(std::size_t row, double a_free, double h) const noexcept;

  bool exist_;
  bool has_course_;                           // the integrator evaluates loads within the sub-step
  bool is_rk4_;                               // it also evaluates the middle of the sub-step
  std::vector<double> begin_, middle_, end_;  // by row, a_free of the motion at the start under the loads of the time
};

}  // namespace slew::mechanics_node
