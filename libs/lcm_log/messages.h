// SPDX-License-Identifier: Apache-2.0
// The messages of idl/slewring.lcm that come from outside, decoded from untrusted bytes.
//
// The decoders that lcm-gen generates trust the lengths of strings; these check every length and number first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace slew::lcm_log {

inline constexpr std::size_t kMaxTextLength = 63;  // characters of names and paths, as on the wire

struct Input {
  std::string controller;
  std::int64_t sender = 0;
  std::int64_t sequence = 0;  // not negative
  std::string channel;
  double value = 0;
  std::int64_t based_on_step = -1;  // -1: unknown
};

struct ParameterRequest {
  std::int64_t request = 0;
  bool is_change = false;
  std::string path;
  double value = 0;
  double over = -1;  // s; negative: the parameter's own
};

enum class Decoded : std::uint8_t { ok, other_type, damaged };

[[nodiscard]] Decoded decode(std::span<const std::byte> bytes, Input& input);
[[nodiscard]] Decoded decode(std::span<const std::byte> bytes, ParameterRequest& request);

// An input as bytes, for logs.
void encode(const Input& input, std::string& bytes);

}  // namespace slew::lcm_log
