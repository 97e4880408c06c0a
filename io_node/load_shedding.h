// What a session that overruns leaves out, and when it has it again (docs/realtime.md).
//
// One level more when 5 of 100 judged steps overran, one less after 2000 without an overrun; a session without a flex
// node has no view. Every tick says in its
// flags what its step is without; a node then publishes its block of variables without values.
#pragma once

#include <cstdint>
#include <string>

#include "core/time.h"
#include "scene/defs.h"

namespace slew::io_node {

// Whether there is a flex node.
enum class View : std::uint8_t { none, flex };

// Whether somebody computes with the variables.
enum class Steering : std::uint8_t { nobody, controllers };

class LoadShedding {
 public:
  static constexpr std::uint64_t kWindow = 100;  // judged steps
  static constexpr std::uint64_t kTooMany = 5;   // overruns in it
  static constexpr std::uint64_t kCalm = 2000;   // judged steps

  LoadShedding(scene::ShedLoad most, View view) : most_(most), view_(view) {}

  // n: the next step; judged, overruns: how many of the steps so far. An event when the level changes, else empty.
  [[nodiscard]] std::string look(StepIndex n, std::uint64_t judged, std::uint64_t overruns, Steering steering);
  [[nodiscard]] scene::ShedLoad level() const noexcept { return level_; }

 private:
  [[nodiscard]] std::string change_to(scene::ShedLoad level, StepIndex n, const std::string& why);

  [[nodiscard]] scene::ShedLoad beside(scene::ShedLoad level, int way) const noexcept;

  scene::ShedLoad most_;
  View view_;
  scene::ShedLoad level_ = scene::ShedLoad::none;
  std::uint64_t window_from_ = 0, overruns_from_ = 0;  // of the present window
  std::uint64_t calm_from_ = 0, calm_overruns_ = 0;    // judged steps and overruns at the last overrun
};

}  // namespace slew::io_node
