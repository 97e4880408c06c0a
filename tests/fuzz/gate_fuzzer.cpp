// SPDX-License-Identifier: Apache-2.0
// The controller gate: with any values at any times, controls stay finite and within their channel's scale, and a
// channel without a holder takes no controller's value.
#include <cmath>
#include <string>
#include <vector>

#include "io_node/input_gate.h"
#include "tests/fuzz/bytes.h"

namespace {

using namespace slew;

constexpr std::int64_t kMs = 1'000'000;
const std::string kControllers[] = {"", "joystick", "pid", "supervisor"};

std::vector<io_node::ChannelConfig> channels() {
  io_node::ChannelConfig lever, loop, button;
  lever.name = "lever";
  lever.scale = 10;
  lever.dead_zone = 0.05;
  lever.ramp = 0.2;
  lever.supervisor = "supervisor";
  loop.name = "loop";
  loop.controller = scene::ControllerMode::lockstep;
  loop.delay = 3;
  loop.rate_limit = 5;
  loop.scale = -2;
  button.name = "button";
  button.is_digital = true;
  return {lever, loop, button};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Choices choices(data, size);
  io_node::GateConfig config;
  config.variables_every = 1 + static_cast<StepIndex>(choices.below(4));
  io_node::InputGate gate(channels(), config, milliseconds(1));
  StepIndex step = 0;
  std::int64_t now_ns = 0;
  while (choices.has_more()) {
    const std::size_t channel = choices.below(3);
    const std::string& controller = kControllers[choices.below(4)];
    switch (choices.below(8)) {
      case 0:
        static_cast<void>(gate.acquire(channel, controller.empty() ? "joystick" : controller, now_ns));
        break;
      case 1:
        static_cast<void>(gate.take_over(channel, controller.empty() ? "joystick" : controller, now_ns));
        break;
      case 2:
        static_cast<void>(gate.release(channel, controller, step - static_cast<StepIndex>(choices.below(8))));
        break;
      case 3: {
        const double value = choices.usual();
        const StepIndex based_on = step - static_cast<StepIndex>(choices.below(16)) + 4;
        const std::uint64_t refused = gate.rejected_no_lease();
        const bool is_taken = gate.write(channel, controller, value, step, now_ns, based_on);
        fuzz::require(!is_taken || (std::isfinite(value) && gate.rejected_no_lease() == refused));
        break;
      }
      case 4:
        now_ns += static_cast<std::int64_t>(choices.byte()) * kMs * 40;
        break;
      case 5:
        if (choices.byte() == 0) {
          gate.reset();
          step = 0;
        }
        break;
      case 6:
        gate.excuse(SimDuration{static_cast<std::int64_t>(choices.byte()) * kMs}, now_ns);
        break;
      default: {
        std::vector<SignalCourse> script(3);
        for (SignalCourse& held : script) {
          const double raw = choices.usual();
          held = {{1, raw, raw}};
        }
        fuzz::require(gate.awaited(step).ns >= 0);
        gate.advance(step, script, now_ns);
        ++step;
        now_ns += kMs;
        for (std::size_t i = 0; i < gate.size(); ++i) {
          const io_node::ChannelConfig& one = gate.config(i);
          fuzz::require(std::isfinite(gate.control(i)) && std::fabs(gate.control(i)) <= std::fabs(one.scale));
          fuzz::require(std::fabs(gate.raw(i)) <= 1 && (!one.is_digital || gate.raw(i) >= 0));
          fuzz::require(gate.based_on(i) < step);
        }
        break;
      }
    }
    for (const io_node::Notice& notice : gate.take_notices()) fuzz::require(!notice.reason.empty());
  }
  StateHash hash;
  gate.add_to(hash);
  return 0;
}
