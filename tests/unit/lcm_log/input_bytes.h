// SPDX-License-Identifier: Apache-2.0
// An input_t as the code that lcm-gen generates encodes it.
#pragma once

#include <slewring/input_t.hpp>
#include <span>
#include <string>
#include <vector>

namespace slew::lcm_log {

inline std::vector<std::byte> bytes_of(const slewring::input_t& message) {
  std::vector<std::byte> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

inline slewring::input_t lift(std::int64_t sequence, double value) {
  slewring::input_t message;
  message.controller = "joystick";
  message.sender = 7;
  message.sequence = sequence;
  message.channel = "Input_Lift";
  message.value = value;
  message.based_on_step = -1;
  return message;
}

}  // namespace slew::lcm_log
