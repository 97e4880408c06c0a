// SPDX-License-Identifier: Apache-2.0
// Enable chain: a channel leaves neutral only while everything that its safety needs is there.
//
//   blocked -> ready      all devices are fresh, all conditions are met, and the dead-man input is released
//   ready   -> enabled    it is pressed while every axis is near neutral
//   enabled -> blocked    it is released, or anything is missing
//
// A dead-man input that was pressed before the others were met does not enable: it must be released and pressed again,
// after every loss. An input that is not known counts as released, a condition that is not known as not met.
//
// This is logic of a simulator, not a safety function in the sense of ISO 13849: an emergency stop needs its own wires.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/field.h"
#include "core/problem.h"

namespace slew::devices {

struct EnableChainDef {
  std::string name;
  std::string dead_man{};                 // button, "Stick_Left.BTN_TRIGGER"
  std::vector<std::string> devices{};     // that must be fresh
  std::vector<std::string> conditions{};  // that must be met, as "Platform is parked"
  double device_timeout = 0.2;            // s
  double neutral_band = 0.05;             // largest |axis| at which the chain enables
};

[[nodiscard]] std::span<const Field> enable_chain_fields() noexcept;
void validate(const EnableChainDef& def, Problems& problems);

enum class EnablePhase : std::uint8_t { blocked, ready, enabled };

// First cause, in this order, for which the chain does not enable.
enum class EnableHindrance : std::uint8_t {
  none,
  device_silent,      // index: of the device
  condition_not_met,  // index: of the condition
  dead_man_held,      // pressed since before the rest was met: release it
  dead_man_released,  // press it
  axis_not_neutral
};

struct EnableInputs {
  std::optional<bool> dead_man;           // pressed
  std::span<const double> device_ages{};  // s since the last news of each device; NaN: never
  std::span<const std::optional<bool>> conditions{};
  double farthest_axis = 0;  // largest |value| of the channels; NaN: not known
};

struct EnableState {
  EnablePhase phase = EnablePhase::blocked;
  EnableHindrance hindrance = EnableHindrance::dead_man_released;
  std::size_t index = 0;     // of the device or condition
  std::uint64_t losses = 0;  // enabled -> blocked

  [[nodiscard]] bool is_enabled() const noexcept { return phase == EnablePhase::enabled; }
};

// One step. Result: whether the phase changed. Pre-condition: one age for each device, one entry for each condition.
bool step(const EnableChainDef& def, const EnableInputs& inputs, EnableState& state) noexcept;

// "device Stick_Left is silent", "release Stick_Left.BTN_TRIGGER, then press it"
[[nodiscard]] std::string text_of(const EnableChainDef& def, const EnableState& state);

}  // namespace slew::devices
