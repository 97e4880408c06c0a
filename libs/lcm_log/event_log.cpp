// SPDX-License-Identifier: Apache-2.0
#include "lcm_log/event_log.h"

#include <fmt/format.h>

#include "lcm_log/big_endian.h"

namespace slew::lcm_log {
namespace {

constexpr std::uint32_t kSync = 0xEDA1DA01;
constexpr std::size_t kHeadBytes = 28;

}  // namespace

void EventLogWriter::add(const Event& event, std::string& log) {
  put_big_endian(log, kSync);
  put_big_endian(log, count_++);
  put_big_endian(log, event.time_us);
  put_big_endian(log, static_cast<std::int32_t>(event.channel.size()));
  put_big_endian(log, static_cast<std::int32_t>(event.data.size()));
  log += event.channel;
  log.append(reinterpret_cast<const char*>(event.data.data()), event.data.size());
}

bool EventLogReader::next(Event& event) {
  if (at_ == log_.size() || !damage_.empty()) return false;
  BigEndianSource bytes(log_.substr(at_));
  const bool is_event = bytes.take<std::uint32_t>() == kSync;
  static_cast<void>(bytes.take<std::int64_t>());  // its number
  event.time_us = bytes.take<std::int64_t>();
  const auto channel = bytes.take<std::int32_t>();
  const auto data = bytes.take<std::int32_t>();
  const bool is_length = channel >= 1 && channel <= static_cast<std::int32_t>(kMaxChannelLength) && data >= 0;
  if (is_event && is_length) {
    event.channel = bytes.take_bytes(static_cast<std::size_t>(channel));
    const std::string_view content = bytes.take_bytes(static_cast<std::size_t>(data));
    event.data = std::as_bytes(std::span<const char>(content.data(), content.size()));
  }
  if (!is_event || !is_length || !bytes.is_sound()) {
    damage_ = fmt::format("is cut or damaged behind event {} (byte {})", count_, at_);
    return false;
  }
  at_ += kHeadBytes + event.channel.size() + event.data.size();
  ++count_;
  return true;
}

}  // namespace slew::lcm_log
