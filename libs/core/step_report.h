// SPDX-License-Identifier: Apache-2.0
// Report of a step: flags and counters instead of prints and exceptions.
#pragma once

#include <cstdint>

namespace slew {

enum class StepFlag : std::uint32_t {
  not_converged = 1u << 0,  // an iteration reached its limit; the residual was accepted
  step_budget = 1u << 1,    // the sub-step budget of H was used up; the rest went on at looser tolerances
  limit_hit = 1u << 2,      // a joint limit or an end stop is in contact
  clamp_active = 1u << 3,   // a quantity was held at a bound of its validity (pressure floor, input range)
  late_input = 1u << 4,     // the partner's sample was older than the validity of the copy of its model
  overrun = 1u << 5,        // the deadline passed; reserved, io counts slips instead
  non_finite = 1u << 6,     // the state became NaN or infinite: latched, outputs are the last good ones
  coupling_creates_energy = 1u << 7,
  cavitating = 1u << 8,
  relief_open = 1u << 9,
  large_deflection = 1u << 10,  // a flexible body is bent beyond the validity of its theory
  ended = 1u << 11,             // a rule ends the session (coupling alarm, diverging mechanics): latched
  beyond_oil_law = 1u << 12     // a pressure is above the validity of the oil law
};

struct StepReport {
  std::uint32_t flags = 0;     // StepFlag bits
  std::int32_t offender = -1;  // state or volume that raised the most serious flag (Subsystem::offender_name); -1: none
  std::uint32_t substeps = 0;  // accepted sub-steps of H
  std::uint32_t iterations = 0;  // mechanics: Newton iterations of all stages; hydraulics: sub-steps tried
  double residual = 0;  // mechanics: largest speed residual [m/s or rad/s]; hydraulics: largest error over tolerance

  void raise(StepFlag flag) noexcept { flags |= static_cast<std::uint32_t>(flag); }
  [[nodiscard]] bool has(StepFlag flag) const noexcept { return (flags & static_cast<std::uint32_t>(flag)) != 0; }
  // The session ends with this step.
  [[nodiscard]] bool has_failed() const noexcept { return has(StepFlag::non_finite) || has(StepFlag::ended); }
};

}  // namespace slew
