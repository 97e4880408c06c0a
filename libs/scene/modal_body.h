// A reduced body of libs/flex as the mechanics takes it.
#pragma once

#include <string>

#include "flex/reduction.h"
#include "multibody/flexible/modal_body.h"

namespace slew::scene {

// source: for messages. Allocates.
[[nodiscard]] multibody::ModalBody modal_body(const flex::Reduction& reduction, std::string source);

}  // namespace slew::scene
