// SPDX-License-Identifier: Apache-2.0
// The services of the gateway: calls with a JSON object, answered by one.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "gateway/server_messages.h"

namespace slew::gateway {

enum class Call : std::uint32_t {
  pause = 1,
  resume,
  step,
  reset,
  set_parameter,
  save,
  load,
  lease,
  release,
  play,
  speed,
  seek,
  curves,
  take_over,
};

// A name of a saved state: 1 to 63 letters, digits, '_' and '-'.
[[nodiscard]] bool is_plain_name(std::string_view name) noexcept;

// Of a live session; of a recording; of one from which a live session can go on.
[[nodiscard]] std::span<const Call> session_calls() noexcept;
[[nodiscard]] std::span<const Call> recording_calls() noexcept;
[[nodiscard]] std::span<const Call> continued_calls() noexcept;

// ids are the values of Call.
[[nodiscard]] std::vector<ServiceInfo> service_infos(std::span<const Call> calls);

}  // namespace slew::gateway
