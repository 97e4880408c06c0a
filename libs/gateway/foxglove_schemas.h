// SPDX-License-Identifier: Apache-2.0
// JSON schemas of the messages that Foxglove and Lichtblick recognise by name (foxglove-sdk, schemas/jsonschema), with
// the members that the gateway sends.
#pragma once

#include <string>

namespace slew::gateway {

[[nodiscard]] std::string frame_transforms_schema();
[[nodiscard]] std::string scene_update_schema();
[[nodiscard]] std::string log_schema();

}  // namespace slew::gateway
