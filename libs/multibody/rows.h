// Rows: Jacobian, coordinate, speed, free acceleration and mobility at one instant. Internal to the library.
#pragma once

#include "multibody/state.h"

namespace slew::multibody {

// Needs motion, elements and factors of the same state, and ws.udot_free.
void evaluate_rows(const Model& model, const State& state, Workspace& ws) noexcept;

}  // namespace slew::multibody
