// SPDX-License-Identifier: Apache-2.0
// Converts reduced bodies of libs/flex for libs/multibody, which are independent of each other. source: for messages.
#pragma once

#include <string>

#include "flex/finite_segments.h"
#include "flex/reduction.h"
#include "multibody/flexible/modal_body.h"
#include "multibody/flexible/segmented_def.h"

namespace slew::scene {

// Allocates.
[[nodiscard]] multibody::ModalBody modal_body(const flex::Reduction& reduction, std::string source);

// The same in finite segments. Throws flex::InputError as finite_segments() does. Allocates.
[[nodiscard]] multibody::SegmentChain segment_chain(const flex::Reduction& reduction, int segments, std::string source);

}  // namespace slew::scene
