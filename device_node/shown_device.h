// SPDX-License-Identifier: Apache-2.0
// A device that shows variables and outputs of a session.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "core/json.h"
#include "device_node/can_bus.h"
#include "device_node/input_device.h"
#include "device_node/packet_sender.h"
#include "device_node/signal_feed.h"
#include "scene/devices.h"

namespace slew::device_node {

class ShownDevice {
 public:
  ShownDevice() = default;
  virtual ~ShownDevice() = default;
  ShownDevice(const ShownDevice&) = delete;
  ShownDevice& operator=(const ShownDevice&) = delete;

  [[nodiscard]] virtual SignalFeed& feed() noexcept = 0;
  // Called some 50 times a second, and when it is due: looks for an interface that has left, steps what moves by
  // itself.
  virtual void look_after(std::int64_t /*now_ns*/) {}
  // Monotonic time of its next step; the largest: none.
  [[nodiscard]] virtual std::int64_t due_ns() const noexcept { return INT64_MAX; }
  // The session is over, or a stop was requested: it comes to rest by look_after().
  virtual void leave_session() {}
  [[nodiscard]] virtual bool is_at_rest() const noexcept { return true; }
  // Its own counts and those of its feed.
  [[nodiscard]] virtual Json counts() const = 0;
  // Sentences for the user since the last call.
  [[nodiscard]] std::vector<std::string> take_notices() { return std::exchange(notices_, {}); }

 protected:
  void add_notice(std::string text) { notices_.push_back(std::move(text)); }

 private:
  std::vector<std::string> notices_;
};

// With a sender of the caller's, for tests; without, on the network. Throws Failure.
[[nodiscard]] std::unique_ptr<ShownDevice> open_udp_out(const scene::UdpOutDef& def, const scene::OutputsDef& outputs,
                                                        Reach reach, SendBytes send = nullptr);
// gravity: of the scene, m/s2 in Ground.
[[nodiscard]] std::unique_ptr<ShownDevice> open_motion_platform(const scene::MotionPlatformDef& def,
                                                                const scene::OutputsDef& outputs, const Triple& gravity,
                                                                Reach reach, SendBytes send = nullptr);
[[nodiscard]] std::unique_ptr<ShownDevice> open_can_out(const scene::CanOutDef& def, const scene::OutputsDef& outputs,
                                                        OpenCan open = open_can);

}  // namespace slew::device_node
