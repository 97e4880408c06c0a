// SPDX-License-Identifier: Apache-2.0
// A device that moves inputs: a value for each of them, while it is there and fresh.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/json.h"
#include "device_node/bus_protocol.h"
#include "device_node/can_bus.h"
#include "scene/devices.h"

namespace slew::scene {
struct InputDef;
}

namespace slew::device_node {

class InputDevice {
 public:
  InputDevice() = default;
  virtual ~InputDevice() = default;
  InputDevice(const InputDevice&) = delete;
  InputDevice& operator=(const InputDevice&) = delete;

  // Names of the inputs that it moves, in the order of values().
  [[nodiscard]] virtual const std::vector<std::string>& inputs() const noexcept = 0;
  // Readable when something has come; -1: none.
  [[nodiscard]] virtual int descriptor() const noexcept = 0;
  // Takes what has come. Result: whether the values are of a new event or packet.
  virtual bool take(std::int64_t now_ns) = 0;
  // False: absent or silent; its values mean nothing.
  [[nodiscard]] virtual bool is_fresh() const noexcept = 0;
  [[nodiscard]] virtual std::span<const double> values() const noexcept = 0;
  // State of the dead-man input; none: not known, or there is no such input.
  [[nodiscard]] virtual std::optional<bool> dead_man() const noexcept = 0;
  // Monotonic time of the event or packet that the values are of.
  [[nodiscard]] virtual std::int64_t event_ns() const noexcept = 0;
  // Its own counts.
  [[nodiscard]] virtual Json counts() const = 0;
  // All that it has read, as text for a monitor.
  [[nodiscard]] virtual std::string text() const = 0;
  // Sentences for the user since the last call.
  [[nodiscard]] std::vector<std::string> take_notices() { return std::exchange(notices_, {}); }

 protected:
  void add_notice(std::string text) { notices_.push_back(std::move(text)); }

 private:
  std::vector<std::string> notices_;
};

// Key of packets of other senders among the causes of refused ones.
inline constexpr std::string_view kStrangerCause = "sender not in from";

// Reach of sockets: the network needs --insecure-devices.
enum class Reach : std::uint8_t { this_machine, network };
// Throws Failure (bad_input) for an address beyond this machine.
void check_reach(const std::string& key, const std::string& address, Reach reach);

// inputs: of the scene. Throws Failure.
[[nodiscard]] std::unique_ptr<InputDevice> open_joystick(const scene::JoystickDef& def,
                                                         std::span<const scene::InputDef> inputs);
[[nodiscard]] std::unique_ptr<InputDevice> open_udp_in(const scene::UdpInDef& def, Reach reach);
[[nodiscard]] std::unique_ptr<InputDevice> open_can_in(const scene::CanInDef& def, BusPart part = BusPart::takes_part,
                                                       OpenCan open = open_can);

}  // namespace slew::device_node
