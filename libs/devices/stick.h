// SPDX-License-Identifier: Apache-2.0
// A joystick, gamepad or set of pedals: events to axes and buttons.
//
// Events of one report take effect together, with its SYN_REPORT. After SYN_DROPPED (the kernel's queue was full)
// events are missing: all up to and including the next SYN_REPORT are dropped, and the stick has no values until its
// whole state is read again by the program (EVIOCGABS, EVIOCGKEY) and given to give_state(). The same holds at the
// start. A device that left is neutral: axes 0, buttons released.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/field.h"
#include "core/problem.h"
#include "devices/input_events.h"
#include "devices/stick_axis.h"

namespace slew::devices {

struct ButtonDef {
  std::string code{};        // "BTN_TRIGGER"
  std::int64_t channel = 0;  // of the inputs' block
  bool invert = false;       // contact that is closed at rest
};

struct StickDef {
  std::string name;
  std::vector<AxisDef> axes{};
  std::vector<ButtonDef> buttons{};
};

[[nodiscard]] std::span<const Field> button_fields() noexcept;
void validate(const StickDef& def, Problems& problems);

enum class StickPhase : std::uint8_t {
  absent,          // values are neutral
  awaiting_state,  // present; no values until give_state()
  dropping,        // events are missing; no values
  valid
};

// Immutable; codes resolved. Pre-condition of build_stick(): no problem; throws Failure (bad_input) otherwise.
struct Stick {
  StickDef def;
  std::vector<std::uint16_t> axis_codes, button_codes;
};
[[nodiscard]] Stick build_stick(const StickDef& def);

struct StickState {
  StickPhase phase = StickPhase::absent;
  std::vector<std::int32_t> axes, pending_axes;        // raw counts; pending: of the unfinished report
  std::vector<std::uint8_t> buttons, pending_buttons;  // 1: pressed, before `invert`
  std::int64_t report_time_us = 0;                     // time of the last report's SYN_REPORT
  std::uint64_t reports = 0;                           // finished and used
  std::uint64_t dropped = 0;                           // SYN_DROPPED
  std::uint64_t held = 0;                              // reports with an axis beyond its calibrated ends
};
[[nodiscard]] StickState initial_state(const Stick& stick);

void connect(StickState& state) noexcept;
void disconnect(StickState& state) noexcept;

// The device's whole state as read from it, in the order of the definition. Pre-condition: sizes as in the definition.
void give_state(StickState& state, std::span<const std::int32_t> axes, std::span<const std::uint8_t> buttons) noexcept;

// Takes events in their order. Result: whether a report was finished, so that values may have changed. No allocation.
bool take_events(const Stick& stick, StickState& state, std::span<const InputEvent> events) noexcept;

// -1 .. 1; no value while the state is not known.
[[nodiscard]] std::optional<double> axis_value(const Stick& stick, const StickState& state, std::size_t axis) noexcept;
[[nodiscard]] std::optional<bool> button_value(const Stick& stick, const StickState& state,
                                               std::size_t button) noexcept;

}  // namespace slew::devices
