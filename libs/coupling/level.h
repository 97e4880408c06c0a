// SPDX-License-Identifier: Apache-2.0
// Coupling level: the part of the partner's behaviour that a subsystem uses inside a communication step (coupling
// study, section 2).
#pragma once

#include <cstdint>

namespace slew::coupling {

enum class Level : std::uint8_t {
  hold,    // held pressure force, held speed, volume corrected at the exchange, friction local
  linear,  // mechanics uses the hydraulics' linearisation; hydraulics holds the speed
  two,     // both sides integrate against the partner's reduced model
  tlm      // the chambers are transmission lines with one step of delay
};
inline constexpr int kLevels = 4;

// Levels at which both sides use the partner's reduced model.
[[nodiscard]] constexpr bool is_balanced(Level level) noexcept {
  return level == Level::linear || level == Level::two;
}

// The level stated for a port: one of its own, or the session's.
enum class PortLevel : std::uint8_t { session, hold, linear, two, tlm };

// Pre-condition: not `session`.
[[nodiscard]] constexpr Level level_of(PortLevel port) noexcept {
  return static_cast<Level>(static_cast<int>(port) - 1);
}

enum class Quality : std::uint8_t { ok, extrapolated, degraded, invalid };

}  // namespace slew::coupling
