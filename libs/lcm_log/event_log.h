// SPDX-License-Identifier: Apache-2.0
// LCM's event logs, as lcm-logger writes and lcm-logplayer reads them. An event is, big-endian:
//   uint32 0xEDA1DA01, int64 number, int64 time [us], int32 length of the channel, int32 length of the data,
//   channel, data
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace slew::lcm_log {

inline constexpr std::size_t kMaxChannelLength = 63;  // LCM_MAX_CHANNEL_NAME_LENGTH

struct Event {
  std::int64_t time_us = 0;
  std::string_view channel;
  std::span<const std::byte> data;
};

// Appends events to a log in memory, with growing numbers.
class EventLogWriter {
 public:
  // Pre-condition: 1 to kMaxChannelLength characters of channel.
  void add(const Event& event, std::string& log);
  [[nodiscard]] std::int64_t count() const noexcept { return count_; }

 private:
  std::int64_t count_ = 0;
};

// Takes the events from the bytes of a log, which must outlive it. No input makes it read beyond them.
class EventLogReader {
 public:
  explicit EventLogReader(std::string_view log) noexcept : log_(log) {}

  // False at the end of the log, or at the first damaged byte.
  [[nodiscard]] bool next(Event& event);
  // Why reading ended in front of the end: "is cut or damaged behind event 12 (byte 733)"; empty: it did not.
  [[nodiscard]] const std::string& damage() const noexcept { return damage_; }
  [[nodiscard]] std::int64_t count() const noexcept { return count_; }

 private:
  std::string_view log_;
  std::size_t at_ = 0;
  std::int64_t count_ = 0;
  std::string damage_;
};

}  // namespace slew::lcm_log
