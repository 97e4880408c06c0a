// SPDX-License-Identifier: Apache-2.0
// A CAN bus in memory, for tests of devices on CAN.
#pragma once

#include <cstdio>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/time.h"
#include "device_node/can_bus.h"
#include "device_node/shown_device.h"

namespace slew::device_node::testing_can {

inline constexpr std::int64_t kMs = 1'000'000;

inline CanFrame frame_of(std::uint32_t id, std::initializer_list<int> bytes, bool is_extended = false) {
  CanFrame frame;
  frame.id = id;
  frame.is_extended = is_extended;
  for (const int byte : bytes) frame.bytes[frame.size++] = static_cast<std::byte>(byte);
  return frame;
}

// A bus in memory: frames that wait for the device, and those that it has sent.
struct MemoryBus {
  struct End final : CanBus {
    explicit End(MemoryBus& owner) : bus(owner) {}
    [[nodiscard]] int descriptor() const noexcept override { return 0; }
    [[nodiscard]] Taken take(std::int64_t, CanFrame& frame) override {
      if (bus.is_gone) return Taken::gone;
      if (bus.waiting.empty()) return Taken::nothing;
      frame = bus.waiting.front();
      bus.waiting.pop_front();
      return Taken::frame;
    }
    [[nodiscard]] bool send(const CanFrame& frame) noexcept override {
      bus.sent.push_back(frame);
      return true;
    }
    MemoryBus& bus;
  };
  OpenCan opener() {
    return [this](const std::string&, std::string& reason) -> std::unique_ptr<CanBus> {
      reason = "interface can0: it was taken away";
      return is_gone ? nullptr : std::make_unique<End>(*this);
    };
  }
  // Frames sent since the last call, as "000#0105".
  std::vector<std::string> texts() {
    std::vector<std::string> all;
    for (const CanFrame& frame : sent) {
      char text[32];
      std::snprintf(text, sizeof text, frame.is_extended ? "%08X#" : "%03X#", frame.id);
      std::string& one = all.emplace_back(text);
      for (const std::byte byte : frame.data()) {
        std::snprintf(text, sizeof text, "%02X", std::to_integer<unsigned>(byte));
        one += text;
      }
    }
    sent.clear();
    return all;
  }

  std::deque<CanFrame> waiting;
  std::vector<CanFrame> sent;
  bool is_gone = false;
};

using Texts = std::vector<std::string>;

// A device that sends a variable "Load.force" of the hydraulics, on a clock of its own; steps of 1 ms.
struct ForceSender {
  explicit ForceSender(const scene::CanOutDef& def) : ForceSender(def, nullptr) {}
  // open: null: the bus in memory.
  ForceSender(const scene::CanOutDef& def, OpenCan open)
      : device(open_can_out(def, {}, open ? std::move(open) : bus.opener())) {
    wire::VariableDirectory directory;
    directory.header.role = wire::Role::hydraulics;
    directory.entries = {{"Load.force", "N"}};
    device->feed().take(directory);
  }
  void take(const CanFrame& frame) {
    bus.waiting.push_back(frame);
    wait_ms(1);
  }
  void wait_ms(int duration) {
    for (int i = 0; i < duration; ++i) device->look_after(now_ns += kMs);
  }
  void publish(double force) {
    wire::VariableBlock block;
    block.header.role = wire::Role::hydraulics;
    block.header.step = step;
    block.values.push_back(force);
    device->feed().take(block, static_cast<double>(step++) * 1e-3);
  }

  MemoryBus bus;
  std::unique_ptr<ShownDevice> device;
  std::int64_t now_ns = monotonic_ns();
  StepIndex step = 0;
};

}  // namespace slew::device_node::testing_can
