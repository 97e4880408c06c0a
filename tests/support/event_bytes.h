// SPDX-License-Identifier: Apache-2.0
// Bytes of input events as a 64-bit kernel writes them.
#pragma once

#include <cstdint>
#include <string>

namespace slew::testing {

inline void add_event(std::string& bytes, std::int64_t time_us, int type, int code, std::int32_t value) {
  const auto put = [&](std::uint64_t number, int size) {
    for (int i = 0; i < size; ++i, number >>= 8) bytes.push_back(static_cast<char>(number & 0xFF));
  };
  put(static_cast<std::uint64_t>(time_us / 1'000'000), 8);
  put(static_cast<std::uint64_t>(time_us % 1'000'000), 8);
  put(static_cast<std::uint64_t>(type), 2);
  put(static_cast<std::uint64_t>(code), 2);
  put(static_cast<std::uint32_t>(value), 4);
}

}  // namespace slew::testing
