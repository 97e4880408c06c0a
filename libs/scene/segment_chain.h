// SPDX-License-Identifier: Apache-2.0
// Converts finite segments of libs/flex for libs/multibody, which are independent of each other.
#pragma once

#include <string>

#include "flex/finite_segments.h"
#include "multibody/flexible/segmented_def.h"

namespace slew::scene {

// source: for messages. Throws flex::InputError as finite_segments() does. Allocates.
[[nodiscard]] multibody::SegmentChain segment_chain(const flex::Reduction& reduction, int segments, std::string source);

}  // namespace slew::scene
