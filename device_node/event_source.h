// SPDX-License-Identifier: Apache-2.0
// Where the events of a joystick come from: a device file of Linux, or a file of recorded events (the bytes that
// `cat /dev/input/event5` gives), which is played once in its own time.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "devices/input_events.h"
#include "devices/stick.h"
#include "devices/stick_calibration.h"

namespace slew::device_node {

class EventSource {
 public:
  EventSource() = default;
  virtual ~EventSource() = default;
  EventSource(const EventSource&) = delete;
  EventSource& operator=(const EventSource&) = delete;

  // Readable when events have come; -1: none, events are due at a time.
  [[nodiscard]] virtual int descriptor() const noexcept = 0;
  // Appends the events up to now; their time is that of the monotonic clock. False: the device has left, or the
  // recording is over.
  [[nodiscard]] virtual bool take(std::int64_t now_ns, std::vector<devices::InputEvent>& events) = 0;
  // The device's whole state now. False: it has left.
  [[nodiscard]] virtual bool read_state(const devices::Stick& stick, devices::StickState& state) = 0;
  // Its axes with the ranges that it states.
  [[nodiscard]] virtual std::vector<devices::AxisRange> axes() const = 0;
  [[nodiscard]] virtual std::vector<std::string> buttons() const = 0;
};

// Null and the reason: there is no such file at present, or it cannot be read. Throws Failure (bad_input) for a file
// that is neither a device nor a recording.
[[nodiscard]] std::unique_ptr<EventSource> open_events(const std::string& path, std::string& reason);

// An input device of this machine.
struct FoundDevice {
  std::string path;  // "/dev/input/event5"
  std::string name;  // empty: it cannot be read
  std::string obstacle;
};
[[nodiscard]] std::vector<FoundDevice> find_input_devices();
// Path of the first one whose name fits the pattern; empty: none.
[[nodiscard]] std::string find_input_device(const std::string& pattern);

}  // namespace slew::device_node
