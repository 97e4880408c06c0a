// What a subsystem held at the ports at the beginning of its last steps: its own coordinate and its copy of what the
// partner states. A sample of step s that comes at step n is compared with the copy of step s, not of step n, and the
// difference is carried to now (coupling study, section 6):
//   correction = sample - copy(s),  copy(k) += correction for all k from s to n                      (1)
// Without (1) the way that the copy went since s would count as an error, and be taken back once more at every step.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/state_bytes.h"
#include "core/time.h"

namespace slew::coupling {

// A partner's sample that is older than this is no longer compared with anything.
inline constexpr StepIndex kRememberedSteps = 128;

// From here on a copy of the partner's model that is continued over the time t is good for little: omega t of the
// fastest oscillation at the ports (study, section 6: unstable at about 0.6 for constant delays).
inline constexpr double kDegradedAbove = 0.5;
// Up to here a session may work with samples that are always late (study, section 6: without friction 0.3 to 0.4).
inline constexpr double kMostLate = 0.3;

class OwnPast {
 public:
  explicit OwnPast(std::size_t ports);

  void clear() noexcept;
  // The beginning of step n, which is the latest from now on: two values by port.
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
  std::vector<double> values_;  // by slot: first and second of each port
};

}  // namespace slew::coupling
