// SPDX-License-Identifier: Apache-2.0
#include "devices/stick.h"

#include <fmt/format.h>
#include <linux/input-event-codes.h>

#include <algorithm>

#include "core/check.h"
#include "core/failure.h"
#include "core/suggestion.h"
#include "devices/field_rules.h"

namespace slew::devices {
namespace {

constexpr Field kButtonFields[] = {
    field<&ButtonDef::code>("code",
                            {.presence = Presence::required, .doc = "the kernel's name of the button, as BTN_TRIGGER"}),
    field<&ButtonDef::channel>("channel", {.range = {.min = 0, .max = 63, .min_is_open = false, .max_is_open = false},
                                           .doc = "channel of the inputs that the button moves"}),
    field<&ButtonDef::invert>("invert", {.doc = "contact that is closed at rest"}),
};

// Place of a code in the list, or its size.
std::size_t place_of(std::span<const std::uint16_t> codes, std::uint16_t code) noexcept {
  return static_cast<std::size_t>(std::find(codes.begin(), codes.end(), code) - codes.begin());
}

void finish_report(const Stick& stick, StickState& state, std::int64_t time_us) noexcept {
  bool was_held = false;
  for (std::size_t i = 0; i < state.axes.size(); ++i) {
    state.axes[i] = state.pending_axes[i];
    was_held = was_held || shape(stick.def.axes[i], state.axes[i]).was_held;
  }
  std::copy(state.pending_buttons.begin(), state.pending_buttons.end(), state.buttons.begin());
  state.report_time_us = time_us;
  ++state.reports;
  if (was_held) ++state.held;
}

}  // namespace

std::span<const Field> button_fields() noexcept {
  return kButtonFields;
}

void validate(const StickDef& def, Problems& problems) {
  const auto check_channel = [&](const std::string& path, bool is_taken) {
    if (is_taken) problems.push_back({path, "the code or the channel is used twice in the device", "", ""});
  };
  for (std::size_t i = 0; i < def.axes.size(); ++i) {
    const AxisDef& axis = def.axes[i];
    const std::string path = fmt::format("{}.axes.{}", def.name, axis.code);
    validate(path, axis, problems);
    check_channel(path, std::any_of(def.axes.begin(), def.axes.begin() + static_cast<std::ptrdiff_t>(i),
                                    [&](const AxisDef& other) {
                                      return other.code == axis.code || other.channel == axis.channel;
                                    }));
  }
  for (std::size_t i = 0; i < def.buttons.size(); ++i) {
    const ButtonDef& button = def.buttons[i];
    const std::string path = fmt::format("{}.buttons.{}", def.name, button.code);
    check_fields(path, &button, kButtonFields, problems);
    if (!button_code(button.code)) {
      problems.push_back({path + ".code", fmt::format("there is no button '{}'", button.code),
                          "a name of the kernel, as BTN_TRIGGER", closest(button.code, button_names())});
    }
    const auto is_same = [&](const ButtonDef& other) {
      return other.code == button.code || other.channel == button.channel;
    };
    check_channel(path,
                  std::any_of(def.buttons.begin(), def.buttons.begin() + static_cast<std::ptrdiff_t>(i), is_same) ||
                      std::any_of(def.axes.begin(), def.axes.end(),
                                  [&](const AxisDef& axis) { return axis.channel == button.channel; }));
  }
  if (def.axes.empty() && def.buttons.empty()) {
    problems.push_back({def.name, "the device has neither axes nor buttons",
                        "axes or buttons; 'slewring device calibrate' writes them", ""});
  }
}

Stick build_stick(const StickDef& def) {
  Problems problems;
  validate(def, problems);
  if (!problems.empty()) throw Failure(ExitCode::bad_input, problems[0].path + ": " + problems[0].what);
  Stick stick{def, {}, {}};
  for (const AxisDef& axis : def.axes) stick.axis_codes.push_back(*axis_code(axis.code));
  for (const ButtonDef& button : def.buttons) stick.button_codes.push_back(*button_code(button.code));
  return stick;
}

StickState initial_state(const Stick& stick) {
  StickState state;
  for (const AxisDef& axis : stick.def.axes) state.axes.push_back(static_cast<std::int32_t>(axis.centre));
  state.pending_axes = state.axes;
  state.buttons.assign(stick.def.buttons.size(), 0);
  state.pending_buttons = state.buttons;
  return state;
}

void connect(StickState& state) noexcept {
  state.phase = StickPhase::awaiting_state;
}

void disconnect(StickState& state) noexcept {
  state.phase = StickPhase::absent;
}

void give_state(StickState& state, std::span<const std::int32_t> axes, std::span<const std::uint8_t> buttons) noexcept {
  SLEW_CHECK(axes.size() == state.axes.size() && buttons.size() == state.buttons.size());
  std::copy(axes.begin(), axes.end(), state.axes.begin());
  std::copy(axes.begin(), axes.end(), state.pending_axes.begin());
  std::copy(buttons.begin(), buttons.end(), state.buttons.begin());
  std::copy(buttons.begin(), buttons.end(), state.pending_buttons.begin());
  state.phase = StickPhase::valid;
}

bool take_events(const Stick& stick, StickState& state, std::span<const InputEvent> events) noexcept {
  bool has_report = false;
  for (const InputEvent& event : events) {
    const bool is_report_end = event.type == EV_SYN && event.code == SYN_REPORT;
    if (event.type == EV_SYN && event.code == SYN_DROPPED) {
      if (state.phase != StickPhase::absent) state.phase = StickPhase::dropping;
      ++state.dropped;
    } else if (state.phase == StickPhase::dropping && is_report_end) {
      state.phase = StickPhase::awaiting_state;
    }
    if (state.phase != StickPhase::valid) continue;

    if (is_report_end) {
      finish_report(stick, state, event.time_us);
      has_report = true;
    } else if (event.type == EV_ABS) {
      const std::size_t i = place_of(stick.axis_codes, event.code);
      if (i < state.pending_axes.size()) state.pending_axes[i] = event.value;
    } else if (event.type == EV_KEY) {
      const std::size_t i = place_of(stick.button_codes, event.code);
      if (i < state.pending_buttons.size()) state.pending_buttons[i] = event.value != 0;  // 2: repeated by the kernel
    }
  }
  return has_report;
}

std::optional<double> axis_value(const Stick& stick, const StickState& state, std::size_t axis) noexcept {
  if (state.phase == StickPhase::absent) return 0;
  if (state.phase != StickPhase::valid) return std::nullopt;
  return shape(stick.def.axes[axis], state.axes[axis]).value;
}

std::optional<bool> button_value(const Stick& stick, const StickState& state, std::size_t button) noexcept {
  if (state.phase == StickPhase::absent) return false;
  if (state.phase != StickPhase::valid) return std::nullopt;
  return (state.buttons[button] != 0) != stick.def.buttons[button].invert;
}

}  // namespace slew::devices
