// SPDX-License-Identifier: Apache-2.0
#include "transport/middleware_log.h"

#include <cstdio>

#include "core/printable.h"
#include "core/time.h"

namespace slew::transport {
namespace {

constexpr std::int64_t kInterval = 1'000'000'000;  // ns between two lines

}  // namespace

void MiddlewareLog::set_echo(Echo echo) {
  const std::lock_guard lock(mutex_);
  echo_ = echo;
}

std::string MiddlewareLog::last_line() const {
  const std::lock_guard lock(mutex_);
  return last_line_;
}

void MiddlewareLog::write(std::string_view line) {
  const std::lock_guard lock(mutex_);
  while (line.ends_with('\n')) line.remove_suffix(1);
  last_line_ = line;
  if (echo_ == Echo::off) return;
  const std::int64_t now = monotonic_ns();
  if (last_printed_ns_ != 0 && now - last_printed_ns_ < kInterval) {
    ++suppressed_;
    return;
  }
  last_printed_ns_ = now;
  if (suppressed_ > 0) {
    std::fprintf(stderr, "slewring: DDS: %s (and %llu more messages)\n", printable(last_line_).c_str(),
                 static_cast<unsigned long long>(suppressed_));
  } else {
    std::fprintf(stderr, "slewring: DDS: %s\n", printable(last_line_).c_str());
  }
  suppressed_ = 0;
}

}  // namespace slew::transport
