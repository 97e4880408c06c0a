// SPDX-License-Identifier: Apache-2.0
// History of a subsystem's values at the ports at the beginning of its last steps: its own coordinate and its copy of
// the partner's. A sample of step s that arrives at step n is compared with the copy at step s, not step n, and the
// difference is applied to all later copies (coupling study, section 6):
//   correction = sample - copy(s),  copy(k) += correction for all k from s to n                      (1)
// Without (1) the displacement of the copy since s would count as an error, and be removed again at every step.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/state_bytes.h"
#include "core/time.h"

namespace slew::coupling {

// Greatest age of a partner's sample that is still compared.
inline constexpr StepIndex kRememberedSteps = 128;

// Validity limit of a copy of the partner's model continued over the time t: omega t of the fastest oscillation at the
// ports (study, section 6: unstable at about 0.6 for constant delays).
inline constexpr double kDegradedAbove = 0.5;
// Limit of omega t for a session whose samples are always late (study, section 6: without friction 0.3 to 0.4).
inline constexpr double kMostLate = 0.3;

class OwnPast {
 public:
  explicit OwnPast(std::size_t ports);

  void clear() noexcept;
  // Records the beginning of step n, the latest step from now on: two values by port.
  void keep(StepIndex n, std::span<const double> first, std::span<const double> second) noexcept;
  [[nodiscard]] bool has(StepIndex n) const noexcept;
  // Pre-condition: has(n).
  [[nodiscard]] double first(StepIndex n, std::size_t port) const noexcept { return row(n)[2 * port]; }
  [[nodiscard]] double second(StepIndex n, std::size_t port) const noexcept { return row(n)[2 * port + 1]; }
  // Equation (1) for one port, from step `since` to the latest.
  void correct(StepIndex since, std::size_t port, double first, double second) noexcept;

  void save(StateWriter& bytes) const;
  void load(StateReader& bytes) noexcept;

 private:
  [[nodiscard]] const double* row(StepIndex n) const noexcept;

  std::size_t ports_;
  StepIndex latest_ = -1;
  std::vector<StepIndex> steps_;
  std::vector<double> values_;  // by slot: first and second value of each port
};

}  // namespace slew::coupling
