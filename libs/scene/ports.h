// SPDX-License-Identifier: Apache-2.0
// Power ports of a scene: each actuator of the circuit with the force element it drives.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/problem.h"
#include "coupling/port_levels.h"
#include "scene/scene.h"

namespace slew::scene {

// Fills scene.ports in component order. Problems: the element's kind does not fit the actuator, the line force cannot
// use the friction curve, too many ports. Pre-condition: all names are resolved.
void make_ports(Scene& scene, Problems& problems);

// Why this port cannot have the level; empty: it can. Text that is a constant.
[[nodiscard]] std::string_view obstacle_of(const PortDef& port, coupling::Level level) noexcept;

// Rows for build_model(): the ports' force elements in port order, then the joints with friction or limits.
[[nodiscard]] std::vector<std::string> row_names(const Scene& scene);

// Coupling levels of the ports in the scene.
[[nodiscard]] coupling::PortLevels port_levels(const Scene& scene);

// Reports pistons that start inside an end stop by the scene's poses, which would throw the machine, and motors whose
// angle cannot count full turns. Pre-condition: no problem with ports and rows.
void check_start(const Scene& scene, Problems& problems);

}  // namespace slew::scene
