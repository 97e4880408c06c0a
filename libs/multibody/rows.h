// Rows: Jacobian, coordinate, speed, free acceleration and mobility at one instant. Internal to the library.
#pragma once

#include "multibody/state.h"

namespace slew::multibody {

// Needs motion, elements and factors of the same state, and ws.udot_free.
void evaluate_rows(const Model& model, const State& state, Workspace& ws) noexcept;

// Coordinate of a joint that is cut, for its row of friction and limits.
[[nodiscard]] RowValue coordinate_of_cut(const Model& model, const Row& row, const Workspace& ws) noexcept;

// x'' of a row's coordinate with u' = 0, from the motion with u' = 0 [m/s2, rad/s2].
[[nodiscard]] double bias_of_length(const LineElement& element, const LineMotion& line, const Workspace& ws) noexcept;
[[nodiscard]] double bias_of_angle(const AngleElement& element, const AngleMotion& angle, const Workspace& ws) noexcept;

}  // namespace slew::multibody
