// SPDX-License-Identifier: Apache-2.0
// From a scene to what io_node needs: channels, script, parameter directory, asset manifest, roles.
#pragma once

#include <cstdint>
#include <string>

#include "io_node/io_config.h"
#include "scene/scene.h"

namespace slew::io_node {

enum class Recording : std::uint8_t { required, none };

// Roles that take part: io always, mechanics with bodies, hydraulics with components, the recorder when recording.
[[nodiscard]] std::uint32_t required_roles(const scene::Scene& scene, Recording recording) noexcept;

// The session's settings are those of the scene, with its overrides.
[[nodiscard]] IoConfig make_config(const scene::Scene& scene, std::string session_name, Recording recording);

}  // namespace slew::io_node
