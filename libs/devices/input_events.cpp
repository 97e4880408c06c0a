// SPDX-License-Identifier: Apache-2.0
#include "devices/input_events.h"

#include <linux/input-event-codes.h>
#include <linux/input.h>

#include <charconv>
#include <cstring>

namespace slew::devices {
namespace {

static_assert(sizeof(::input_event) == kInputEventBytes);

struct NamedCode {
  std::string_view name;
  std::uint16_t code;
};

constexpr NamedCode kAxes[] = {
    {"ABS_X", ABS_X},
    {"ABS_Y", ABS_Y},
    {"ABS_Z", ABS_Z},
    {"ABS_RX", ABS_RX},
    {"ABS_RY", ABS_RY},
    {"ABS_RZ", ABS_RZ},
    {"ABS_THROTTLE", ABS_THROTTLE},
    {"ABS_RUDDER", ABS_RUDDER},
    {"ABS_WHEEL", ABS_WHEEL},
    {"ABS_GAS", ABS_GAS},
    {"ABS_BRAKE", ABS_BRAKE},
    {"ABS_HAT0X", ABS_HAT0X},
    {"ABS_HAT0Y", ABS_HAT0Y},
    {"ABS_HAT1X", ABS_HAT1X},
    {"ABS_HAT1Y", ABS_HAT1Y},
    {"ABS_HAT2X", ABS_HAT2X},
    {"ABS_HAT2Y", ABS_HAT2Y},
    {"ABS_HAT3X", ABS_HAT3X},
    {"ABS_HAT3Y", ABS_HAT3Y},
    {"ABS_PRESSURE", ABS_PRESSURE},
    {"ABS_DISTANCE", ABS_DISTANCE},
    {"ABS_TILT_X", ABS_TILT_X},
    {"ABS_TILT_Y", ABS_TILT_Y},
    {"ABS_TOOL_WIDTH", ABS_TOOL_WIDTH},
    {"ABS_VOLUME", ABS_VOLUME},
    {"ABS_MISC", ABS_MISC},
};

constexpr NamedCode kButtons[] = {
    {"BTN_0", BTN_0},
    {"BTN_1", BTN_1},
    {"BTN_2", BTN_2},
    {"BTN_3", BTN_3},
    {"BTN_4", BTN_4},
    {"BTN_5", BTN_5},
    {"BTN_6", BTN_6},
    {"BTN_7", BTN_7},
    {"BTN_8", BTN_8},
    {"BTN_9", BTN_9},
    {"BTN_TRIGGER", BTN_TRIGGER},
    {"BTN_THUMB", BTN_THUMB},
    {"BTN_THUMB2", BTN_THUMB2},
    {"BTN_TOP", BTN_TOP},
    {"BTN_TOP2", BTN_TOP2},
    {"BTN_PINKIE", BTN_PINKIE},
    {"BTN_BASE", BTN_BASE},
    {"BTN_BASE2", BTN_BASE2},
    {"BTN_BASE3", BTN_BASE3},
    {"BTN_BASE4", BTN_BASE4},
    {"BTN_BASE5", BTN_BASE5},
    {"BTN_BASE6", BTN_BASE6},
    {"BTN_DEAD", BTN_DEAD},
    {"BTN_SOUTH", BTN_SOUTH},
    {"BTN_A", BTN_A},
    {"BTN_EAST", BTN_EAST},
    {"BTN_B", BTN_B},
    {"BTN_C", BTN_C},
    {"BTN_NORTH", BTN_NORTH},
    {"BTN_X", BTN_X},
    {"BTN_WEST", BTN_WEST},
    {"BTN_Y", BTN_Y},
    {"BTN_Z", BTN_Z},
    {"BTN_TL", BTN_TL},
    {"BTN_TR", BTN_TR},
    {"BTN_TL2", BTN_TL2},
    {"BTN_TR2", BTN_TR2},
    {"BTN_SELECT", BTN_SELECT},
    {"BTN_START", BTN_START},
    {"BTN_MODE", BTN_MODE},
    {"BTN_THUMBL", BTN_THUMBL},
    {"BTN_THUMBR", BTN_THUMBR},
    {"BTN_GEAR_DOWN", BTN_GEAR_DOWN},
    {"BTN_GEAR_UP", BTN_GEAR_UP},
    {"BTN_DPAD_UP", BTN_DPAD_UP},
    {"BTN_DPAD_DOWN", BTN_DPAD_DOWN},
    {"BTN_DPAD_LEFT", BTN_DPAD_LEFT},
    {"BTN_DPAD_RIGHT", BTN_DPAD_RIGHT},
    {"BTN_TRIGGER_HAPPY1", BTN_TRIGGER_HAPPY1},
};

constexpr std::string_view kManyButtons = "BTN_TRIGGER_HAPPY";  // 1 to 40: sticks with more buttons than names

std::optional<std::uint16_t> code_of(std::span<const NamedCode> table, std::string_view name) {
  for (const NamedCode& row : table) {
    if (row.name == name) return row.code;
  }
  return std::nullopt;
}

std::vector<std::string_view> names_of(std::span<const NamedCode> table) {
  std::vector<std::string_view> names;
  for (const NamedCode& row : table) names.push_back(row.name);
  return names;
}

}  // namespace

std::size_t read_events(std::span<const std::byte> bytes, std::vector<InputEvent>& events) {
  std::size_t used = 0;
  for (; bytes.size() - used >= kInputEventBytes; used += kInputEventBytes) {
    ::input_event event;
    std::memcpy(&event, bytes.data() + used, kInputEventBytes);
    // by unsigned numbers: seconds are foreign bytes
    const std::uint64_t time_us = static_cast<std::uint64_t>(event.input_event_sec) * 1'000'000U +
                                  static_cast<std::uint64_t>(event.input_event_usec);
    events.push_back({static_cast<std::int64_t>(time_us), event.type, event.code, event.value});
  }
  return used;
}

std::optional<std::uint16_t> axis_code(std::string_view name) {
  return code_of(kAxes, name);
}

std::optional<std::uint16_t> button_code(std::string_view name) {
  if (name.starts_with(kManyButtons)) {
    const std::string_view digits = name.substr(kManyButtons.size());
    unsigned number = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error != std::errc() || end != digits.data() + digits.size() || number < 1 ||
        number > BTN_TRIGGER_HAPPY40 - BTN_TRIGGER_HAPPY1 + 1) {
      return std::nullopt;
    }
    return static_cast<std::uint16_t>(BTN_TRIGGER_HAPPY1 + number - 1);
  }
  return code_of(kButtons, name);
}

std::vector<std::string_view> axis_names() {
  return names_of(kAxes);
}

std::vector<std::string_view> button_names() {
  return names_of(kButtons);
}

}  // namespace slew::devices
