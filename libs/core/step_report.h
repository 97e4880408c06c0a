// What a step has to say: flags and counters instead of prints and exceptions.
#pragma once

#include <cstdint>

namespace slew {

enum class StepFlag : std::uint32_t {
  not_converged = 1u << 0,   // an iteration reached its limit; the residual was accepted
  step_budget = 1u << 1,     // the sub-step budget of H was used up; the last step was accepted with its error
  limit_hit = 1u << 2,       // a joint limit or an end stop is in contact
  clamp_active = 1u << 3,    // a quantity was held at a bound of its validity (pressure floor, input range)
  late_input = 1u << 4,      // a partner's sample was replaced by its continued copy
  overrun = 1u << 5,         // the deadline passed
  non_finite = 1u << 6,      // the state became NaN or infinite: latched, outputs are the last good ones
  coupling_creates_energy = 1u << 7,
  cavitating = 1u << 8,
  relief_open = 1u << 9
};

// offender: index (in the owner's variables or elements, see Subsystem::offender_name) of the first one that raised a
// serious flag; -1 for none.
struct StepReport {
  std::uint32_t flags = 0;
  std::int32_t offender = -1;
  std::uint32_t substeps = 0;
  std::uint32_t iterations = 0;
  double residual = 0;

  void raise(StepFlag flag) noexcept { flags |= static_cast<std::uint32_t>(flag); }
  [[nodiscard]] bool has(StepFlag flag) const noexcept { return (flags & static_cast<std::uint32_t>(flag)) != 0; }
  [[nodiscard]] bool has_failed() const noexcept { return has(StepFlag::non_finite); }
};

}  // namespace slew
