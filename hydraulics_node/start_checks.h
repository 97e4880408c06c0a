// SPDX-License-Identifier: Apache-2.0
// Checks of a session's start: a machine that the circuit, its solver or the exchange cannot follow is refused with the
// reason.
#pragma once

#include <span>
#include <string_view>

#include "core/status.h"
#include "coupling/port_levels.h"
#include "coupling/samples.h"
#include "hydraulics/circuit.h"
#include "hydraulics/circuit_integrator.h"
#include "scene/scene.h"

namespace slew::hydraulics_node {

// The pressures that hold the actuators at rest with the forces F [N] and the mobility W of the ports: the circuit must
// be able to have them.
[[nodiscard]] Status check_pressures(const scene::Scene& scene, const hydraulics::Circuit& circuit,
                                     std::span<const double> F, std::span<const double> W, std::span<const double> x);

// An explicit solver at the start state; owner: name of the fastest state. Later the solver's limit is flagged.
[[nodiscard]] Status check_stability(const hydraulics::ExplicitStability& stability, std::string_view owner);

// The oscillation of the machine on its oil against the exchange interval; the limit is lower where samples are always
// late by a step at least.
[[nodiscard]] Status check_coupling(const scene::Scene& scene, const coupling::PortMatrix& W,
                                    const coupling::ActuatorSample& published, const coupling::PortLevels& levels);

}  // namespace slew::hydraulics_node
