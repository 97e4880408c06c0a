// SPDX-License-Identifier: Apache-2.0
// Converts a reduced body of libs/flex for the mechanics.
#pragma once

#include <string>

#include "flex/reduction.h"
#include "multibody/flexible/modal_body.h"

namespace slew::scene {

// source: for messages. Allocates.
[[nodiscard]] multibody::ModalBody modal_body(const flex::Reduction& reduction, std::string source);

}  // namespace slew::scene
