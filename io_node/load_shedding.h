// SPDX-License-Identifier: Apache-2.0
// Data that a session omits while it overruns (docs/realtime.md).
//
// The level rises by one when 5 of 100 judged steps overran, and falls by one after 2000 without an overrun; a session
// without a flex node has no level `view`. The flags of a tick state the level of its step; a node then publishes its
// block of variables without values.
#pragma once

#include <cstdint>
#include <string>

#include "core/time.h"
#include "scene/defs.h"

namespace slew::io_node {

// The session has a flex node, or none.
enum class View : std::uint8_t { none, flex };

// Controllers compute with the variables, or none does.
enum class Steering : std::uint8_t { none, controllers };

class LoadShedding {
 public:
  static constexpr std::uint64_t kWindow = 100;  // judged steps
  static constexpr std::uint64_t kTooMany = 5;   // overruns in it
  static constexpr std::uint64_t kCalm = 2000;   // judged steps

  LoadShedding(scene::ShedLoad most, View view) : most_(most), view_(view) {}

  // n: the next step; judged, overruns: numbers of steps so far. An event if the level changes, else empty.
  [[nodiscard]] std::string look(StepIndex n, std::uint64_t judged, std::uint64_t overruns, Steering steering);
  [[nodiscard]] scene::ShedLoad level() const noexcept { return level_; }

 private:
  [[nodiscard]] std::string change_to(scene::ShedLoad level, StepIndex n, const std::string& why);

  [[nodiscard]] scene::ShedLoad beside(scene::ShedLoad level, int direction) const noexcept;

  scene::ShedLoad most_;
  View view_;
  scene::ShedLoad level_ = scene::ShedLoad::none;
  std::uint64_t window_from_ = 0, overruns_from_ = 0;  // begin of the present window
  std::uint64_t calm_from_ = 0, calm_overruns_ = 0;    // judged steps and overruns at the last overrun
};

}  // namespace slew::io_node
