// SPDX-License-Identifier: Apache-2.0
#include "device_node/can_messages.h"

#include "core/failure.h"

namespace slew::device_node {

std::vector<devices::CanMessage> read_messages(const scene::CanBusDef& bus, scene::CanFlow flow) {
  Problems problems;
  std::vector<devices::CanMessage> messages = can_messages(bus, flow, problems);
  if (!problems.empty()) throw Failure(ExitCode::bad_input, problems[0].path + ": " + problems[0].what);
  return messages;
}

SignalPlace place_of(const std::vector<devices::CanMessage>& messages, const std::string& name) {
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const std::string& message = messages[i].name;
    if (!name.starts_with(message + ".")) continue;
    const std::string_view signal_name = std::string_view(name).substr(message.size() + 1);
    if (const auto signal = find_signal(messages[i], signal_name)) return {i, *signal};
    if (const auto axis = devices::find_joystick_axis(messages[i], signal_name)) return {i, axis->position, axis};
  }
  throw Failure(ExitCode::bad_input, "the definition has no signal '" + name + "'");
}

devices::ReservedCodes codes_of(const scene::CanBusDef& bus) noexcept {
  return bus.protocol == scene::CanProtocol::j1939 ? devices::ReservedCodes::j1939 : devices::ReservedCodes::none;
}

std::optional<std::size_t> find_frame(const std::vector<devices::CanMessage>& messages, const scene::CanBusDef& bus,
                                      const CanFrame& frame) {
  const bool is_j1939 = bus.protocol == scene::CanProtocol::j1939;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    if (messages[i].is_extended != frame.is_extended) continue;
    if (messages[i].id == frame.id) return i;
    if (is_j1939 && frame.is_extended && devices::split_j1939(messages[i].id).pgn == devices::split_j1939(frame.id).pgn)
      return i;
  }
  return std::nullopt;
}

}  // namespace slew::device_node
