// Whether a pair meets on the way between two instants that a search looked at.
//
// The way is taken as straight, the turn as one step at its middle, and is looked at in pieces of at most half the
// thickness of both shapes together (ContactPair::half_thickness), so that nothing passes between two looks unseen.
// Real-time safe with own kernels; cost bounded by kMostLooks. Not covered: a corner that cuts less deep than the
// pieces are long; ways that curve strongly within one sub-step.
#pragma once

#include <span>

#include "contact/contact_model.h"

namespace slew::contact {

inline constexpr int kMostLooks = 128;

struct Meeting {
  enum class Kind { none, found, too_fast };  // too_fast: near, but longer than kMostLooks pieces
  Kind kind = Kind::none;
  math::Vec3 n_W{};   // found: normal at the first look that found an overlap, from B to A
  math::Vec3 p_W{};   // found: a point of the overlap there
  double share = 0;   // found: of the way, where that was
  double travel = 0;  // m, of A's middle seen from B
};

// Poses of the frames at both ends; the last look is at the end itself. A way shorter than the pieces is not looked at
// but at its end.
[[nodiscard]] Meeting sweep(const ContactModel& model, std::size_t pair, std::span<const Pose> from,
                            std::span<const Pose> to, ContactSet& scratch) noexcept;

}  // namespace slew::contact
