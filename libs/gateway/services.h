// The services of the gateway: calls with a JSON object, answered by one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gateway/server_messages.h"

namespace slew::gateway {

enum class Call : std::uint32_t {
  pause = 1,
  resume,
  step,
  reset,
  set_parameter,
  lease,
  release,
  play,
  speed,
  seek,
};

// Of a live session; of a recording.
[[nodiscard]] std::span<const Call> session_calls() noexcept;
[[nodiscard]] std::span<const Call> recording_calls() noexcept;

// ids are the values of Call.
[[nodiscard]] std::vector<ServiceInfo> service_infos(std::span<const Call> calls);

}  // namespace slew::gateway
