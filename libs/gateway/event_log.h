// SPDX-License-Identifier: Apache-2.0
// Events of a session as messages foxglove.Log, for clients that come and for those that come later.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>

namespace slew::gateway {

enum class LogLevel : std::uint8_t { info = 2, warning = 3, error = 4 };

struct LogEvent {
  std::uint64_t time_ns = 0;                  // of the session
  std::shared_ptr<const std::string> body{};  // JSON
};

class EventLog {
 public:
  static constexpr std::size_t kKept = 100;

  // source: node or program that the event is of.
  const LogEvent& add(std::uint64_t time_ns, LogLevel level, const std::string& source, const std::string& text);
  // The last ones.
  [[nodiscard]] const std::deque<LogEvent>& kept() const noexcept { return kept_; }
  void forget() { kept_.clear(); }

 private:
  std::deque<LogEvent> kept_;
};

}  // namespace slew::gateway
