// SPDX-License-Identifier: Apache-2.0
// Frames of a CAN bus: of an interface of Linux (SocketCAN), or of a file that `candump -l` wrote, which is played once
// in its own time.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "devices/can_frame.h"

namespace slew::device_node {

using devices::CanFrame;

class CanBus {
 public:
  enum class Taken : std::uint8_t { frame, nothing, gone };

  CanBus() = default;
  virtual ~CanBus() = default;
  CanBus(const CanBus&) = delete;
  CanBus& operator=(const CanBus&) = delete;

  // Readable when a frame has come; -1: none, frames are due at a time.
  [[nodiscard]] virtual int descriptor() const noexcept = 0;
  // gone: the interface has left, or the recording is over. Frames that carry no data (remote, error) are passed over.
  [[nodiscard]] virtual Taken take(std::int64_t now_ns, CanFrame& frame) = 0;
  // False: the system did not take it.
  [[nodiscard]] virtual bool send(const CanFrame& frame) noexcept = 0;
};

// Null and the reason: there is no such interface at present, or this kernel has no CAN.
[[nodiscard]] std::unique_ptr<CanBus> open_can(const std::string& interface, std::string& reason);
// The same, for tests another one.
using OpenCan = std::function<std::unique_ptr<CanBus>(const std::string& interface, std::string& reason)>;
// Throws Failure (bad_input).
[[nodiscard]] std::unique_ptr<CanBus> open_can_log(const std::string& path);

}  // namespace slew::device_node
