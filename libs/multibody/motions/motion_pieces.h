// SPDX-License-Identifier: Apache-2.0
// Pieces of a sub-step in which a prescribed motion is faster than the integrator resolves. Internal to the library.
//
// A rule sees p'' at its stages only. What hangs on the driven joint takes the rule's sum over p'' for the change of
// p', and keeps the difference as a speed:
//   x = sum(b_i h p''(t_i)) - (p'(t + h) - p'(t))                                                        (1)
// A jump J of p''' at a share s of a sub-step (ends of a ramp, points of a table) adds J h^2 e(s) to x: of rk4 e from
// -1/24 to 1/96, of the trapezoid from -1/12 to 1/24. Two opposite jumps at the worst places leave kink J h^2 with kink
// = 5/96 and 1/8, other rules below that of the trapezoid. With the range R of p' around a jump
//   kink J h^2 <= kLargestError R                                                                         (2)
// A ramp by D in T has J = 60 D/T^3 and R = 1.875 D/T: h <= T/13 of rk4, T/20 of other rules. A harmonic motion has no
// jumps: with 10 and 16 sub-steps a period (1) is 5e-5 and 1.3e-2 of its speed.
// A sub-step beyond that is cut at the jumps and divided evenly between them. Others stay whole, with the same bits.
// A jump of p'' (MotionJump) within a sub-step would leave up to a half of h p'' as a speed: every sub-step is cut
// there. A stage at the end of a piece takes p'' before the jump, one at its start that behind it (Workspace::until).
#pragma once

#include <span>
#include <vector>

#include "multibody/motions/motion_law.h"

namespace slew::multibody {

struct Drive;

// Longest sub-steps of a rule.
struct MotionResolution {
  double kink = 0;        // of (2)
  double per_ramp = 0;    // sub-steps of a ramp
  double per_period = 0;  // sub-steps of a period
};
inline constexpr MotionResolution kResolutionOfRungeKutta{5.0 / 96, 13, 10};
inline constexpr MotionResolution kResolutionOfOtherRules{1.0 / 8, 20, 16};

// Most pieces of a sub-step: what is left for the last one is taken whole, and reported as not converged.
inline constexpr int kMostMotionPieces = 64;

// Longest sub-step of (2) by interval of the law's table, for kink = 1; empty: no table. Allocates.
[[nodiscard]] std::vector<double> table_resolution(const MotionLaw& law);

// Time from `time` [s] to the first jump of p'' within `rest` [s], its end excluded; `rest`: none.
[[nodiscard]] double time_to_jump(std::span<const Drive> drives, double time, double rest) noexcept;
// True if p'' of a law jumps at `time`.
[[nodiscard]] bool is_jump_at(std::span<const Drive> drives, double time) noexcept;

// True if a law needs shorter sub-steps than h between `time` and `time + h` [s].
[[nodiscard]] bool is_motion_fast(const MotionLaw& law, const MotionResolution& resolution, double time,
                                  double h) noexcept;
[[nodiscard]] bool is_motion_fast(std::span<const Drive> drives, const MotionResolution& resolution, double time,
                                  double h) noexcept;

// Length of the piece at `time` of a sub-step of h of which `rest` is left [s]; `piece` is that of other laws.
[[nodiscard]] double motion_piece(const MotionLaw& law, const MotionResolution& resolution, double time, double rest,
                                  double h, double piece) noexcept;
[[nodiscard]] double motion_piece(std::span<const Drive> drives, const MotionResolution& resolution, double time,
                                  double rest, double h) noexcept;

// A motion that no sub-step of h resolves in kMostMotionPieces.
struct FastMotion {
  bool is_found = false;
  double time = 0;     // s, start of the sub-step
  double longest = 0;  // s, sub-step that suits
};
[[nodiscard]] FastMotion find_fast_motion(const MotionLaw& law, const MotionResolution& resolution, double h);

}  // namespace slew::multibody
