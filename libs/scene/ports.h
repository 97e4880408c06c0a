// Power ports of a scene: each actuator of the circuit with the force element it drives.
#pragma once

#include <string>
#include <vector>

#include "core/problem.h"
#include "coupling/port_levels.h"
#include "scene/scene.h"

namespace slew::scene {

// Fills scene.ports in component order. Problems: the element's kind does not fit the actuator, the friction
// curve is none that the line force takes, too many ports. Pre-condition: all names are resolved.
void make_ports(Scene& scene, Problems& problems);

// What build_model() is told to make rows of: the ports' force elements in port order, then the joints with friction
// or limits.
[[nodiscard]] std::vector<std::string> row_names(const Scene& scene);

// Coupling levels of the ports, as the scene states them.
[[nodiscard]] coupling::PortLevels port_levels(const Scene& scene);

// Pistons that the poses of the scene put into an end stop: they would throw the machine. Pre-condition: no problem
// with ports and rows.
void check_start(const Scene& scene, Problems& problems);

}  // namespace slew::scene
