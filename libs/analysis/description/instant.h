// SPDX-License-Identifier: Apache-2.0
// A scene at an instant of its own manoeuvre, for `slewring describe`.
#pragma once

#include <string>

#include "analysis/comparison/played_scene.h"
#include "core/dimension.h"
#include "hydraulics_node/hydraulics_subsystem.h"
#include "mechanics_node/mechanics_subsystem.h"

namespace slew::analysis {

// "5 s", "20 deg", or a bare number in SI. Throws Failure (bad_input) that begins with the option's name.
[[nodiscard]] double read_option(const std::string& option, const std::string& text, Dimension dimension);

// Runs the scene on to the first step boundary at or after `at` [s]. Throws Failure when it fails before.
void play_to(PlayedScene& played, double at);

// Null: the scene has none.
[[nodiscard]] const mechanics_node::MechanicsSubsystem* mechanics_of(const PlayedScene& played);
[[nodiscard]] const hydraulics_node::HydraulicsSubsystem* hydraulics_of(const PlayedScene& played);

}  // namespace slew::analysis
