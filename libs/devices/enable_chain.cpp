// SPDX-License-Identifier: Apache-2.0
#include "devices/enable_chain.h"

#include <fmt/format.h>

#include "core/check.h"
#include "devices/field_rules.h"

namespace slew::devices {
namespace {

constexpr Field kEnableChainFields[] = {
    field<&EnableChainDef::dead_man>(
        "dead_man", {.presence = Presence::required, .doc = "button that must be pressed, as Stick_Left.BTN_TRIGGER"}),
    field<&EnableChainDef::devices>("devices", {.doc = "devices that must be fresh"}),
    field<&EnableChainDef::conditions>("conditions", {.doc = "conditions that must be met"}),
    field<&EnableChainDef::device_timeout>(
        "device_timeout", {.dimension = Dimension::time,
                           .range = {.min = 0.001, .max = 60, .min_is_open = false, .max_is_open = false},
                           .doc = "silence after which a device is not fresh"}),
    field<&EnableChainDef::neutral_band>("neutral_band",
                                         {.range = {.min = 0, .max = 1, .min_is_open = false},
                                          .doc = "largest deflection of an axis at which the inputs are enabled"}),
};

// First device or condition that is missing.
EnableHindrance find_missing(const EnableChainDef& def, const EnableInputs& inputs, std::size_t& index) noexcept {
  for (index = 0; index < inputs.device_ages.size(); ++index) {
    if (!(inputs.device_ages[index] <= def.device_timeout)) return EnableHindrance::device_silent;
  }
  for (index = 0; index < inputs.conditions.size(); ++index) {
    if (!inputs.conditions[index].value_or(false)) return EnableHindrance::condition_not_met;
  }
  index = 0;
  return EnableHindrance::none;
}

}  // namespace

std::span<const Field> enable_chain_fields() noexcept {
  return kEnableChainFields;
}

void validate(const EnableChainDef& def, Problems& problems) {
  check_fields(def.name, &def, kEnableChainFields, problems);
}

bool step(const EnableChainDef& def, const EnableInputs& inputs, EnableState& state) noexcept {
  SLEW_CHECK(inputs.device_ages.size() == def.devices.size() && inputs.conditions.size() == def.conditions.size());
  const EnablePhase before = state.phase;
  const bool is_pressed = inputs.dead_man.value_or(false);
  state.hindrance = find_missing(def, inputs, state.index);
  if (state.hindrance != EnableHindrance::none) {
    state.phase = EnablePhase::blocked;
  } else if (state.phase == EnablePhase::enabled) {
    if (!is_pressed) state.phase = EnablePhase::blocked, state.hindrance = EnableHindrance::dead_man_released;
  } else if (!is_pressed) {
    state.phase = EnablePhase::ready;
    state.hindrance = EnableHindrance::dead_man_released;
  } else if (state.phase == EnablePhase::blocked) {
    state.hindrance = EnableHindrance::dead_man_held;
  } else if (!(inputs.farthest_axis <= def.neutral_band)) {
    state.hindrance = EnableHindrance::axis_not_neutral;
  } else {
    state.phase = EnablePhase::enabled;
  }
  if (before == EnablePhase::enabled && state.phase != EnablePhase::enabled) ++state.losses;
  return state.phase != before;
}

std::string text_of(const EnableChainDef& def, const EnableState& state) {
  switch (state.hindrance) {
    case EnableHindrance::none:
      return "enabled";
    case EnableHindrance::device_silent:
      return fmt::format("device {} is silent for more than {:g} s", def.devices[state.index], def.device_timeout);
    case EnableHindrance::condition_not_met:
      return fmt::format("not met: {}", def.conditions[state.index]);
    case EnableHindrance::dead_man_held:
      return fmt::format("release {}, then press it", def.dead_man);
    case EnableHindrance::dead_man_released:
      return fmt::format("press {}", def.dead_man);
    case EnableHindrance::axis_not_neutral:
      return "an axis is not at neutral";
  }
  return "";
}

}  // namespace slew::devices
