// SPDX-License-Identifier: Apache-2.0
#include "io_node/load_shedding.h"

#include <algorithm>

namespace slew::io_node {

using scene::ShedLoad;

namespace {

const char* left_out(ShedLoad level) {
  switch (level) {
    case ShedLoad::none:
      return "nothing is left out";
    case ShedLoad::view:
      return "the values of the flex node's variables are left out";
    case ShedLoad::variables:
      return "the values of the variables of all physics nodes are left out";
  }
  return "";
}

}  // namespace

// the next level (direction 1) or the one before (-1)
ShedLoad LoadShedding::beside(ShedLoad level, int direction) const noexcept {
  const auto next = static_cast<ShedLoad>(static_cast<int>(level) + direction);
  return next == ShedLoad::view && view_ == View::none ? static_cast<ShedLoad>(static_cast<int>(next) + direction)
                                                       : next;
}

std::string LoadShedding::change_to(ShedLoad level, StepIndex n, const std::string& why) {
  level_ = level;
  return "session.shed: at step " + std::to_string(n) + " " + why + ": from now on " + left_out(level);
}

std::string LoadShedding::look(StepIndex n, std::uint64_t judged, std::uint64_t overruns, Steering steering) {
  if (overruns != calm_overruns_) {
    calm_overruns_ = overruns;
    calm_from_ = judged;
  }
  // a controller needs its variables
  const ShedLoad of_controllers = view_ == View::none ? ShedLoad::none : ShedLoad::view;
  const ShedLoad most = steering == Steering::controllers ? std::min(most_, of_controllers) : most_;
  if (level_ > most) return change_to(most, n, "a controller steers");
  if (judged - window_from_ >= kWindow) {
    const std::uint64_t late = overruns - overruns_from_;
    window_from_ = judged;
    overruns_from_ = overruns;
    if (late >= kTooMany && beside(level_, 1) <= most) {
      return change_to(beside(level_, 1), n,
                       std::to_string(late) + " of the last " + std::to_string(kWindow) + " steps overran");
    }
  }
  if (level_ != ShedLoad::none && judged - calm_from_ >= kCalm) {
    calm_from_ = judged;
    return change_to(beside(level_, -1), n, "none of the last " + std::to_string(kCalm) + " steps overran");
  }
  return "";
}

}  // namespace slew::io_node
