// SPDX-License-Identifier: Apache-2.0
#include "scene/devices.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <system_error>

#include "scene/device_readers.h"
#include "scene/recorded_files.h"

namespace slew::scene {
namespace {

void check_listeners(const DevicesDef& devices, Problems& problems) {
  std::map<std::string, std::string> users;
  for (const UdpInDef& device : devices.udp_ins) {
    const auto [first, is_new] = users.emplace(device.listen, device.name);
    if (is_new) continue;
    problems.push_back({device.name + ".listen", fmt::format("{} is taken by {}", device.listen, first->second),
                        "an address or a port of its own", ""});
  }
}

// An absolute path stays what it is.
std::string path_in(const std::string& folder, const std::string& file) {
  return (std::filesystem::path(folder) / file).lexically_normal().string();
}

}  // namespace

std::vector<std::string> DevicesDef::names() const {
  std::vector<std::string> names;
  for (const JoystickDef& device : joysticks) names.push_back(device.name);
  for (const UdpInDef& device : udp_ins) names.push_back(device.name);
  for (const UdpOutDef& device : udp_outs) names.push_back(device.name);
  for (const CanInDef& device : can_ins) names.push_back(device.name);
  for (const CanOutDef& device : can_outs) names.push_back(device.name);
  for (const MotionPlatformDef& device : platforms) names.push_back(device.name);
  return names;
}

void read_devices(DevicesDef& devices, std::span<const InputDef> inputs, Problems& problems) {
  InputUse use(inputs, problems);
  for (JoystickDef& device : devices.joysticks) read_joystick(device, use, problems);
  for (UdpInDef& device : devices.udp_ins) read_udp_in(device, use, problems);
  for (UdpOutDef& device : devices.udp_outs) read_udp_out(device, problems);
  for (CanInDef& device : devices.can_ins) read_can_in(device, use, problems);
  for (CanOutDef& device : devices.can_outs) read_can_out(device, problems);
  for (MotionPlatformDef& device : devices.platforms) read_platform(device, problems);
  check_listeners(devices, problems);
  const std::vector<std::string> names = devices.names();
  if (names.size() <= kMaxDevices) return;
  problems.push_back({names[kMaxDevices], fmt::format("there are {} devices", names.size()),
                      fmt::format("at most {}", kMaxDevices), ""});
}

bool is_device_file(const std::string& path) {
  return path.starts_with("/dev/");
}

void place_recorded_files(DevicesDef& devices, const std::string& folder) {
  const auto place = [&](std::string& path) {
    if (!path.empty()) path = path_in(folder, path);
  };
  for (JoystickDef& device : devices.joysticks) place(device.path);
  for (CanInDef& device : devices.can_ins) place(device.path);
}

void check_recorded_files(const DevicesDef& devices, const std::string& folder, Problems& problems) {
  const auto check = [&](const std::string& device, const std::string& path) {
    std::error_code error;
    if (path.empty() || is_device_file(path) || std::filesystem::exists(path_in(folder, path), error)) return;
    problems.push_back({device + ".path", fmt::format("there is no file '{}'", path_in(folder, path)),
                        "a file in the scene's folder", ""});
  };
  for (const JoystickDef& device : devices.joysticks) check(device.name, device.path);
  for (const CanInDef& device : devices.can_ins) check(device.name, device.path);
}

std::vector<NamedVariable> variables_of(const DevicesDef& devices, const OutputsDef& outputs) {
  std::vector<NamedVariable> all;
  const auto add_conditions = [&](const std::string& device, const std::vector<std::string>& conditions) {
    Problems none;
    for (const std::string& text : conditions) {
      if (const auto condition = read_condition("", text, none))
        all.push_back({device + ".conditions", condition->variable, condition->threshold.unit});
    }
  };
  for (const JoystickDef& device : devices.joysticks) add_conditions(device.name, device.enable.conditions);
  for (const UdpInDef& device : devices.udp_ins) add_conditions(device.name, device.enable.conditions);
  for (const CanInDef& device : devices.can_ins) add_conditions(device.name, device.enable.conditions);
  for (const CanOutDef& device : devices.can_outs) {
    for (const CanSignalDef& signal : device.bus.signals) {
      if (!signal.variable.empty())
        all.push_back({fmt::format("{}.signals.{}", device.name, signal.signal), signal.variable});
    }
  }
  for (const UdpOutDef& device : devices.udp_outs) {
    for (const devices::LayoutFieldDef& f : device.layout.fields) {
      if (!f.variable.empty()) all.push_back({fmt::format("{}.{}.variable", device.name, f.name), f.variable, f.unit});
    }
  }
  for (const MotionPlatformDef& device : devices.platforms) {
    add_conditions(device.name, device.conditions);
    for (const std::string& variable : device.body_variables()) all.push_back({device.name + ".body", variable});
    for (const devices::LayoutFieldDef& f : device.layout.fields) {
      if (f.variable.empty() || device.own_quantity(f) != nullptr) continue;
      all.push_back({fmt::format("{}.{}.variable", device.name, f.name), f.variable, f.unit});
    }
  }
  Problems ignored;
  for (const SwitchedDef& output : outputs.switched) {
    const auto condition = read_condition("", output.condition, ignored);
    all.push_back({output.name + ".condition", output.output.variable, condition ? condition->threshold.unit : ""});
  }
  for (const AnalogDef& output : outputs.analog) {
    const auto high = read_any_quantity("", output.high, ignored);
    all.push_back({output.name + ".variable", output.output.variable, high ? high->unit : ""});
  }
  return all;
}

}  // namespace slew::scene
