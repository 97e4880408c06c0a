// SPDX-License-Identifier: Apache-2.0
// Where a middleware's messages go: one line on stderr at a time, at most one per second, the others counted.
//
// A broken link makes a thousand lines a second otherwise. Thread-safe.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>

namespace slew::transport {

class MiddlewareLog {
 public:
  enum class Echo { on, off };

  MiddlewareLog() = default;
  MiddlewareLog(const MiddlewareLog&) = delete;
  MiddlewareLog& operator=(const MiddlewareLog&) = delete;

  // While off, messages are only remembered: for errors that the caller reports.
  void set_echo(Echo echo);
  [[nodiscard]] std::string last_line() const;

  void write(std::string_view line);

 private:
  mutable std::mutex mutex_;
  Echo echo_ = Echo::on;
  std::string last_line_;
  std::int64_t last_printed_ns_ = 0;
  std::uint64_t suppressed_ = 0;
};

}  // namespace slew::transport
