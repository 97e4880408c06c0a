// SPDX-License-Identifier: Apache-2.0
#include "lcm_log/messages.h"

#include <slewring/input_t.hpp>
#include <slewring/parameter_t.hpp>

#include "lcm_log/big_endian.h"

namespace slew::lcm_log {
namespace {

template <typename Type>
bool begins_as(BigEndianSource& bytes) {
  return bytes.take<std::int64_t>() == Type::getHash() && bytes.is_sound();
}

}  // namespace

Decoded decode(std::span<const std::byte> content, Input& input) {
  BigEndianSource bytes(content);
  if (!begins_as<slewring::input_t>(bytes)) return Decoded::other_type;
  input.controller = bytes.take_string(kMaxTextLength);
  input.sender = bytes.take<std::int64_t>();
  input.sequence = bytes.take<std::int64_t>();
  input.channel = bytes.take_string(kMaxTextLength);
  input.value = bytes.take_double();
  input.based_on_step = bytes.take<std::int64_t>();
  const bool is_in_range = input.sequence >= 0 && input.based_on_step >= -1;
  return bytes.is_at_end() && is_in_range ? Decoded::ok : Decoded::damaged;
}

Decoded decode(std::span<const std::byte> content, ParameterRequest& request) {
  BigEndianSource bytes(content);
  if (!begins_as<slewring::parameter_t>(bytes)) return Decoded::other_type;
  request.request = bytes.take<std::int64_t>();
  const auto is_change = bytes.take<std::int8_t>();
  request.is_change = is_change == 1;
  request.path = bytes.take_string(kMaxTextLength);
  request.value = bytes.take_double();
  request.over = bytes.take_double();
  return bytes.is_at_end() && (is_change == 0 || is_change == 1) ? Decoded::ok : Decoded::damaged;
}

void encode(const Input& input, std::string& bytes) {
  slewring::input_t message;
  message.controller = input.controller;
  message.sender = input.sender;
  message.sequence = input.sequence;
  message.channel = input.channel;
  message.value = input.value;
  message.based_on_step = input.based_on_step;
  bytes.resize(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
}

}  // namespace slew::lcm_log
