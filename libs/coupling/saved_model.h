// SPDX-License-Identifier: Apache-2.0
// Identity of the model that a saved state belongs to.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>

#include "core/element_variable.h"
#include "core/state_hash.h"

namespace slew::coupling {

// Digest of the names of all variables, in their order, and of the choices that determine the fields of the state. It
// excludes the numbers of a scene.
[[nodiscard]] inline std::uint64_t saved_model(std::span<const ElementVariable> variables,
                                               std::initializer_list<std::int64_t> choices) noexcept {
  StateHash hash;
  for (const ElementVariable& variable : variables) hash.add_bytes(variable.name.data(), variable.name.size());
  for (const std::int64_t choice : choices) hash.add(choice);
  return hash.digest();
}

}  // namespace slew::coupling
