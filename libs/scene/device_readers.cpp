// SPDX-License-Identifier: Apache-2.0
#include "scene/device_readers.h"

#include <fmt/format.h>

#include <cmath>

#include "devices/udp_address.h"
#include "scene/units.h"

namespace slew::scene {
namespace {

constexpr std::size_t kMaxConditions = 8;

// `unit: mm, scale: 0.001` of a variable: mm is the unit of the raw numbers, the variable's is m.
void take_unit_of_raw_numbers(devices::LayoutFieldDef& f) {
  if (f.variable.empty() || f.unit.empty()) return;
  UnitSystem units;
  const Unit* const unit = units.find(f.unit);
  if (unit == nullptr || unit->has_other_base || (unit->scale == 1 && unit->offset == 0)) return;
  const auto scale = static_cast<double>(unit->scale), offset = static_cast<double>(unit->offset);
  if (std::fabs(f.scale - scale) <= 1e-9 * scale && std::fabs(f.offset - offset) <= 1e-9 * offset) {
    f.unit = si_unit_of(unit->exponent);
  }
}

}  // namespace

void InputUse::use(const std::string& path, const std::string& device, const InputDef& input) {
  if (input.controller == ControllerMode::lockstep) {
    problems_.push_back({path, fmt::format("input {} waits for a controller in step, and a device is not", input.name),
                         fmt::format("{}.controller: sampled", input.name), ""});
  }
  const auto [user, is_new] = users_.emplace(input.name, device);
  if (is_new) return;
  problems_.push_back({path, fmt::format("input {} is moved by {} already", input.name, user->second),
                       "one device for an input, once", ""});
}

void InputUse::use_channel(const std::string& path, const JoystickDef& stick, std::int64_t channel, InputType type) {
  const auto is_there = [&](const InputDef& input) {
    return input.block == stick.block && input.type == type && input.channel == channel;
  };
  const auto found = std::find_if(inputs_.begin(), inputs_.end(), is_there);
  if (found != inputs_.end()) return use(path, stick.name, *found);
  const char* const kind = type == InputType::analog ? "analog" : "digital";
  std::string others;
  for (const InputDef& input : inputs_) {
    if (input.block != stick.block || input.type != type) continue;
    others += fmt::format("{}{} ({})", others.empty() ? "" : ", ", input.channel, input.name);
  }
  problems_.push_back({path, fmt::format("no {} input has block {} and channel {}", kind, stick.block, channel),
                       others.empty() ? fmt::format("a {} input of block {}", kind, stick.block) : others, ""});
}

const InputDef* InputUse::find(const std::string& name) const {
  const auto found = std::find_if(inputs_.begin(), inputs_.end(), [&](const InputDef& i) { return i.name == name; });
  return found == inputs_.end() ? nullptr : &*found;
}

void read_enable(const std::string& name, devices::EnableChainDef& enable, double timeout, Problems& problems) {
  enable.name = name;
  enable.devices = {name};
  enable.device_timeout = timeout;
  if (enable.dead_man.empty() && !enable.conditions.empty()) {
    problems.push_back({name + ".conditions", "conditions enable nothing without a dead-man input", "dead_man", ""});
  }
  check_conditions(name, enable.conditions, problems);
}

void check_conditions(const std::string& device, const std::vector<std::string>& conditions, Problems& problems) {
  if (conditions.size() > kMaxConditions) {
    problems.push_back({device + ".conditions", fmt::format("there are {} conditions", conditions.size()),
                        fmt::format("at most {}", kMaxConditions), ""});
  }
  for (const std::string& condition : conditions)
    static_cast<void>(read_condition(device + ".conditions", condition, problems));
}

std::optional<devices::ByteLayout> read_layout(const std::string& name, devices::LayoutDef& def, Problems& problems) {
  for (devices::LayoutFieldDef& f : def.fields) take_unit_of_raw_numbers(f);
  def.name = name;
  const std::size_t before = problems.size();
  validate(def, problems);
  if (problems.size() > before) return std::nullopt;
  return build(def);
}

bool check_address(const std::string& path, const std::string& text, Problems& problems) {
  if (devices::parse_udp_address(text)) return true;
  problems.push_back({path, fmt::format("'{}' is no address", text), "IPv4 address and port, as 127.0.0.1:5005", ""});
  return false;
}

}  // namespace slew::scene
