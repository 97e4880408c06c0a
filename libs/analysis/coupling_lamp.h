// SPDX-License-Identifier: Apache-2.0
// Texts for the lamps of the coupling: the errors that they stand for, and the changes that make them green.
#pragma once

#include <string>
#include <string_view>

#include "coupling/indicator.h"
#include "scene/scene.h"

namespace slew::analysis {

// eta: coupling_eta of a port.
[[nodiscard]] coupling::Lamp lamp_of(double eta) noexcept;
[[nodiscard]] std::string_view lamp_text(coupling::Lamp lamp) noexcept;

// "0.8 %" of the force's range; empty for a green lamp.
[[nodiscard]] std::string usual_force_error(double eta);
// "force off by about 0.8 %, 6 % in one run of 20; ..."; empty for a green lamp. port: its number in the scene.
[[nodiscard]] std::string explain_lamp(double eta, std::size_t port, const scene::Scene& scene);

}  // namespace slew::analysis
