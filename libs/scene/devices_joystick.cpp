// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "core/suggestion.h"
#include "scene/device_readers.h"

namespace slew::scene {
namespace {

constexpr Range kJoystickBlockRange{.min = 0, .max = 15, .min_is_open = false, .max_is_open = false};

std::vector<Field> make_joystick_fields() {
  std::vector<Field> fields = {
      field<&JoystickDef::path>("path", {.doc = "device file, as /dev/input/event5 or a link in /dev/input/by-id; or a "
                                                "file of recorded events in the scene's folder, played once"}),
      field<&JoystickDef::match>("match", {.doc = "name of the device, or a pattern with * and ?: the first of "
                                                  "/dev/input that fits, also one plugged in later"}),
      field<&JoystickDef::block>(
          "block", {.range = kJoystickBlockRange, .doc = "block of the inputs that its axes and buttons move"}),
  };
  add_enable_fields<JoystickDef>(fields, "button to press before an input leaves neutral, as BTN_THUMB");
  return fields;
}

}  // namespace

std::span<const Field> joystick_fields() {
  static const std::vector<Field> fields = make_joystick_fields();
  return fields;
}

void read_joystick(JoystickDef& def, InputUse& use, Problems& problems) {
  def.stick.name = def.name;
  // events come when something moves: a stick that is there is fresh
  read_enable(def.name, def.enable, devices::EnableChainDef().device_timeout, problems);
  if (def.path.empty() == def.match.empty()) {
    problems.push_back({def.name, "the device is not identified, or twice", "one of path and match", ""});
  }
  const std::size_t before = problems.size();
  validate(def.stick, problems);
  if (!def.enable.dead_man.empty() && !devices::button_code(def.enable.dead_man)) {
    problems.push_back({def.name + ".dead_man", fmt::format("there is no button '{}'", def.enable.dead_man),
                        "a name of the kernel, as BTN_THUMB", closest(def.enable.dead_man, devices::button_names())});
  }
  if (problems.size() > before) return;
  for (const devices::AxisDef& axis : def.stick.axes)
    use.use_channel(fmt::format("{}.axes.{}.channel", def.name, axis.code), def, axis.channel, InputType::analog);
  for (const devices::ButtonDef& button : def.stick.buttons)
    use.use_channel(fmt::format("{}.buttons.{}.channel", def.name, button.code), def, button.channel,
                    InputType::digital);
}

}  // namespace slew::scene
