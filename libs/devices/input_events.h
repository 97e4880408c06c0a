// SPDX-License-Identifier: Apache-2.0
// Events of Linux input devices from the bytes of /dev/input/event*, and the kernel's names of axes and buttons.
//
// An event has 24 bytes on a 64-bit kernel: seconds, microseconds (8 bytes each), type, code (2 each), value (4).
// Source: Linux, Documentation/input/event-codes.rst, input.rst.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace slew::devices {

struct InputEvent {
  std::int64_t time_us = 0;  // clock of the device file; CLOCK_REALTIME unless EVIOCSCLOCKID has changed it
  std::uint16_t type = 0;    // EV_SYN, EV_KEY, EV_ABS, ...
  std::uint16_t code = 0;
  std::int32_t value = 0;
};

inline constexpr std::size_t kInputEventBytes = 24;

// Appends the whole events at the begin of the bytes. Result: bytes that were used; the rest is the begin of an event.
std::size_t read_events(std::span<const std::byte> bytes, std::vector<InputEvent>& events);

// Code of "ABS_X", "BTN_TRIGGER", "BTN_TRIGGER_HAPPY12", ...
[[nodiscard]] std::optional<std::uint16_t> axis_code(std::string_view name);
[[nodiscard]] std::optional<std::uint16_t> button_code(std::string_view name);
// The names, for suggestions.
[[nodiscard]] std::vector<std::string_view> axis_names();
[[nodiscard]] std::vector<std::string_view> button_names();

}  // namespace slew::devices
