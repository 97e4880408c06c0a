// SPDX-License-Identifier: Apache-2.0
// Messages of a device on CAN: those that the scene carries, and found by a frame.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "device_node/can_bus.h"
#include "devices/can_message.h"
#include "devices/j1939.h"
#include "scene/devices.h"

namespace slew::device_node {

struct SignalPlace {
  std::size_t message = 0, signal = 0;
  std::optional<devices::JoystickAxis> axis{};  // in place of the signal
};

// The scene was checked: throws Failure (bad_input) with the first problem otherwise.
[[nodiscard]] std::vector<devices::CanMessage> read_messages(const scene::CanBusDef& bus, scene::CanFlow flow);
[[nodiscard]] SignalPlace place_of(const std::vector<devices::CanMessage>& messages, const std::string& name);
[[nodiscard]] devices::ReservedCodes codes_of(const scene::CanBusDef& bus) noexcept;
// The message of a frame: by its identifier, with J1939 by its parameter group from any source.
[[nodiscard]] std::optional<std::size_t> find_frame(const std::vector<devices::CanMessage>& messages,
                                                    const scene::CanBusDef& bus, const CanFrame& frame);

}  // namespace slew::device_node
