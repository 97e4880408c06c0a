// SPDX-License-Identifier: Apache-2.0
// Micro-steps of the port problem in which a stop begins or ends to push, or throws back.
#include <algorithm>
#include <cmath>

#include "coupling/port_dynamics.h"

namespace slew::coupling {
namespace {

// Parts of a micro-step about a stop. Entering and leaving a spring in one part omits (omega part)^2 / 2 of the speed:
// kTouch is a thousandth.
constexpr double kPart = 8;
constexpr double kTouch = 0.05;
constexpr double kLeast = 1.0 / 8192, kMost = 1.0 / 64;  // bounds of the shortest part, in micro-steps
// longest part in an oscillation, times omega: 1e-4 of the amplitude per part
constexpr double kInSwing = 0.3;
// damping ratio above which a stop throws back less than 3 % of the speed
constexpr double kMostDamping = 3;
constexpr double kRounding = 1e-9;

}  // namespace

// (3); its force counts as from the start on, as its way does
void PortDynamics::take_euler(const Span& span, RowLaws& laws, PortStep& report) noexcept {
  set_weight(span.length, laws);
  for (std::size_t i = 0; i < rows_; ++i) {
    x_base_[i] = x_[i];
    v_base_[i] = v_stage_[i] = v_[i];
    z_base_[i] = z_[i];
  }
  report.has_converged &= solve_stage(span.length, span.end, laws, report);
  add(span.length, {span.end, span.begin, span.begin, true}, f_, pressure_force_, v_stage_);
  for (std::size_t i = 0; i < rows_ && has_memory_; ++i) laws.carry(i, v_stage_[i], span.length);
  move(report);
}

void PortDynamics::take_in_parts(const Span& span, RowLaws& laws, PortStep& report) noexcept {
  double done = 0, length = span.length / kPart;
  for (bool is_last = false; !is_last;) {
    const double rest = span.length - done;
    const double finest = span.length * std::clamp(kTouch / (std::sqrt(swing_rate_) * span.length), kLeast, kMost);
    const bool is_tried = tries_left_-- > 0;
    is_last = !is_tried || length >= rest * (1 - kRounding);
    if (is_last) length = rest;
    const double begin = span.begin + done;
    const Span part{begin, length, begin + kGamma * length, begin + length};
    if (is_tried) set_weight(kGamma * length, laws);
    if (!is_tried || !try_stages(part, laws, report)) {
      if (is_tried && length > finest) {
        length = std::max(std::min(length / kPart, allowed_), finest);
        is_last = false;
        continue;
      }
      // a spring that is still too stiff for the part returns less energy than it received
      report.has_converged &= !is_tried || length <= allowed_;
      take_euler(part, laws, report);
    }
    done += length;
    length *= 2;
  }
  // length of the next parts
  set_weight(kGamma * span.length, laws);
}

// True if the same stops pushed from the start to the end, and the step is short against the oscillation of a stop that
// throws back.
bool PortDynamics::follows_stops(const Span& span, const RowLaws& laws) noexcept {
  bool is_concerned = is_at_stop_;
  for (std::size_t i = 0; i < rows_; ++i) {
    is_concerned =
        is_concerned || law_first_[i].stop != 0 || law_[i].stop != 0 || jump_first_[i] != 0 || is_at_jump_[i] != 0;
  }
  if (!is_concerned) return true;
  for (std::size_t i = 0; i < rows_; ++i) v_base_[i] = z_[i] - partner_[i].D * (v_[i] - partner_[i].v_ref);
  laws.evaluate_all(rows_, v_base_.data(), x_.data(), v_.data(), law_start_.data());
  bool is_same = true;
  swing_rate_ = 0;
  allowed_ = kUnbounded;
  for (std::size_t i = 0; i < rows_; ++i) {
    const auto side = [](const RowForce& law) { return (law.stop > 0) - (law.stop < 0); };
    const int start = side(law_start_[i]);
    is_same =
        is_same && start == side(law_first_[i]) && start == side(law_[i]) && jump_first_[i] == 0 && is_at_jump_[i] == 0;
    for (const RowForce* law : {&law_start_[i], &law_first_[i], &law_[i]}) {
      swing_rate_ = std::max(swing_rate_, -law->d_x * W_[i * rows_ + i]);
    }
    if (start != 0) allowed_ = std::min(allowed_, longest_in_swing(i, span.begin));
  }
  return is_same && span.length <= allowed_;
}

// True if a stop that pushes at the start throws back: the amplitude of the oscillation exceeds the depth at rest in
// the spring. With the acceleration a, sqrt(a^2 + (omega v)^2) >= |W f_stop - a|.
double PortDynamics::longest_in_swing(std::size_t row, double time) const noexcept {
  const RowForce& law = law_start_[row];
  const double W = W_[row * rows_ + row], omega = std::sqrt(-law.d_x * W);
  if (!(omega > 0) || -law.d_v * W > 2 * kMostDamping * omega) return kUnbounded;
  double a = a_free_[row] + time * a_free_rate_[row];
  for (std::size_t j = 0; j < rows_; ++j) a += W_[row * rows_ + j] * law_start_[j].force;
  return std::hypot(a, omega * v_[row]) >= std::fabs(W * law.stop - a) ? kInSwing / omega : kUnbounded;
}

}  // namespace slew::coupling
