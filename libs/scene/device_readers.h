// SPDX-License-Identifier: Apache-2.0
// Parts that the readers of all kinds of devices share: rows of the libraries' tables, and rules of inputs, addresses,
// layouts and enable chains.
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/field.h"
#include "core/problem.h"
#include "scene/defs.h"
#include "scene/devices.h"

namespace slew::scene {

inline constexpr Range kOftenRange{.min = 0.0005, .max = 10, .min_is_open = false, .max_is_open = false};
inline constexpr Range kSilenceRange{.min = 0.002, .max = 60, .min_is_open = false, .max_is_open = false};

// A row of a library's table for a member of ours that holds its Def.
template <auto... Path>
Field lent_as_is(std::span<const Field> fields, std::string_view key) {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.key == key; });
  return field<Path...>(key, *found);
}
// The same, for a key that may be left out.
template <auto... Path>
Field lent(std::span<const Field> fields, std::string_view key) {
  Field row = lent_as_is<Path...>(fields, key);
  row.presence = Presence::optional;
  return row;
}

template <typename Def>
void add_enable_fields(std::vector<Field>& fields, std::string_view dead_man) {
  const std::span<const Field> chain = devices::enable_chain_fields();
  fields.push_back(field<&Def::enable, &devices::EnableChainDef::dead_man>("dead_man", {.doc = dead_man}));
  fields.push_back(field<&Def::enable, &devices::EnableChainDef::conditions>(
      "conditions", {.doc = "conditions on variables that must hold before an input leaves neutral, as "
                            "'Vol_MainPump.pressure > 20 bar'; needs dead_man"}));
  fields.push_back(lent<&Def::enable, &devices::EnableChainDef::neutral_band>(chain, "neutral_band"));
}

template <typename Def>
void add_layout_fields(std::vector<Field>& fields) {
  const std::span<const Field> layout = devices::layout_fields();
  fields.push_back(lent<&Def::layout, &devices::LayoutDef::byte_order>(layout, "byte_order"));
  fields.push_back(lent<&Def::layout, &devices::LayoutDef::packing>(layout, "packing"));
  fields.push_back(lent<&Def::layout, &devices::LayoutDef::size>(layout, "size"));
}

// The inputs of a scene, each moved by one device at most.
class InputUse {
 public:
  InputUse(std::span<const InputDef> inputs, Problems& problems) : inputs_(inputs), problems_(problems) {}

  void use(const std::string& path, const std::string& device, const InputDef& input);
  // The input of a joystick's block by its channel.
  void use_channel(const std::string& path, const JoystickDef& stick, std::int64_t channel, InputType type);
  // Null: there is none of the name.
  [[nodiscard]] const InputDef* find(const std::string& name) const;

 private:
  std::span<const InputDef> inputs_;
  Problems& problems_;
  std::map<std::string, std::string> users_;
};

void read_enable(const std::string& name, devices::EnableChainDef& enable, double timeout, Problems& problems);
// Problems of the layout; without any, the layout.
[[nodiscard]] std::optional<devices::ByteLayout> read_layout(const std::string& name, devices::LayoutDef& def,
                                                             Problems& problems);
// True if the text is an IPv4 address and a port; otherwise a problem.
bool check_address(const std::string& path, const std::string& text, Problems& problems);
void check_conditions(const std::string& device, const std::vector<std::string>& conditions, Problems& problems);

void read_joystick(JoystickDef& def, InputUse& use, Problems& problems);
void read_udp_in(UdpInDef& def, InputUse& use, Problems& problems);
void read_udp_out(UdpOutDef& def, Problems& problems);
void read_can_in(CanInDef& def, InputUse& use, Problems& problems);
void read_can_out(CanOutDef& def, Problems& problems);
void read_platform(MotionPlatformDef& def, Problems& problems);

// Rules of fields that are sent: each has one source at most, and at least one has one.
void check_sent_fields(const std::string& device, const devices::ByteLayout& layout, Problems& problems);

}  // namespace slew::scene
