// SPDX-License-Identifier: Apache-2.0
#include "bridge/incoming.h"

namespace slew::bridge {

void Incoming::take(std::span<const std::byte> bytes, std::int64_t now_ns, StepIndex newest_step) {
  const auto input = filter_.take(bytes, now_ns, newest_step);
  if (!input) return;
  const observer::InputLeases::Key key{kLeasePrefix + input->controller, input->channel};
  if (leases_.write(key, input->value, input->based_on_step, now_ns)) {
    ++filter_.counts().applied;
  } else {
    ++filter_.counts().of(lcm_log::Cause::no_lease);
  }
}

std::vector<std::string> Incoming::take_notices() {
  std::vector<std::string> taken = filter_.take_notices();
  for (std::string& notice : leases_.take_notices()) taken.push_back(std::move(notice));
  return taken;
}

}  // namespace slew::bridge
