#include "io_node/load_shedding.h"

#include <algorithm>

namespace slew::io {
namespace {

const char* left_out(Shed level) {
  switch (level) {
    case Shed::none:
      return "nothing is left out";
    case Shed::view:
      return "the values of the flex node's variables are left out";
    case Shed::variables:
      return "the values of the variables of all physics nodes are left out";
  }
  return "";
}

}  // namespace

// the next level (way 1) or the one before (-1)
Shed LoadShedding::beside(Shed level, int way) const noexcept {
  const auto next = static_cast<Shed>(static_cast<int>(level) + way);
  return next == Shed::view && view_ == View::none ? static_cast<Shed>(static_cast<int>(next) + way) : next;
}

std::string LoadShedding::change_to(Shed level, StepIndex n, const std::string& why) {
  level_ = level;
  return "session.shed: at step " + std::to_string(n) + " " + why + ": from now on " + left_out(level);
}

std::string LoadShedding::look(StepIndex n, std::uint64_t judged, std::uint64_t overruns, Steering steering) {
  if (overruns != calm_overruns_) {
    calm_overruns_ = overruns;
    calm_from_ = judged;
  }
  // a controller needs its variables, whatever was left out before it came
  const Shed of_controllers = view_ == View::none ? Shed::none : Shed::view;
  const Shed most = steering == Steering::controllers ? std::min(most_, of_controllers) : most_;
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
  if (level_ != Shed::none && judged - calm_from_ >= kCalm) {
    calm_from_ = judged;
    return change_to(beside(level_, -1), n, "none of the last " + std::to_string(kCalm) + " steps overran");
  }
  return "";
}

}  // namespace slew::io
