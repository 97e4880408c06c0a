// SPDX-License-Identifier: Apache-2.0
// Detects a pair that meets between two searched instants.
//
// The path is taken as straight. Turn::at_middle takes the turn as one step at its middle, Turn::steady as one of
// constant speed about a fixed axis. The path is sampled in pieces of at most half the thickness of both shapes
// together (ContactPair::half_thickness), so that no contact between two samples is missed; under Turn::steady this
// holds for the point that the turn moves farthest, as far as kMostLooks pieces go. Real-time safe with own kernels;
// cost bounded by kMostLooks. Not covered: a corner that cuts less deep than the pieces are long; paths that curve
// strongly within one sub-step.
#pragma once

#include <span>

#include "contact/contact_model.h"

namespace slew::contact {

inline constexpr int kMostLooks = 128;

enum class Turn { at_middle, steady };

struct Meeting {
  enum class Kind { none, found, too_fast };  // too_fast: near, but longer than kMostLooks pieces
  Kind kind = Kind::none;
  math::Vec3 n_W{};   // found: normal at the first sample with an overlap, from B to A
  math::Vec3 p_W{};   // found: a point of the overlap there
  double share = 0;   // found: share of the path at that sample
  double travel = 0;  // m, displacement of A's middle relative to B
};

// Poses of the frames at both ends; the last sample is the end itself. A path shorter than a piece is sampled at its
// end only.
[[nodiscard]] Meeting sweep(const ContactModel& model, std::size_t pair, std::span<const Pose> from,
                            std::span<const Pose> to, ContactSet& scratch, Turn turn = Turn::at_middle) noexcept;

// Points of a pair at the end of the path of its meeting, which was the last search with this scratch. They are valid
// until the next one.
[[nodiscard]] std::span<const ManifoldPoint> points_at_end(const ContactModel& model, std::size_t pair,
                                                           const Meeting& meeting, std::span<const Pose> to,
                                                           ContactSet& scratch) noexcept;

}  // namespace slew::contact
