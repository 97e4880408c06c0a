// A multibody parameter as one number, the handle of coupling::ParameterRamps.
#pragma once

#include "multibody/model/parameters.h"

namespace slew::mechanics {

[[nodiscard]] inline int handle_of(multibody::Parameter parameter) noexcept {
  return (static_cast<int>(parameter.kind) << 24) | (parameter.element << 8) | parameter.member;
}

[[nodiscard]] inline multibody::Parameter parameter_of(int handle) noexcept {
  return {static_cast<multibody::ParameterKind>(handle >> 24), (handle >> 8) & 0xffff, handle & 0xff};
}

}  // namespace slew::mechanics
