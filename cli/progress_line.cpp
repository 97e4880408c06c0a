// SPDX-License-Identifier: Apache-2.0
#include "cli/progress_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

#include "core/display.h"
#include "core/printable.h"
#include "core/time.h"

namespace slew::cli {
namespace {

constexpr std::int64_t kTerminalPeriodNs = 200'000'000;
constexpr double kKnown = 0.02;  // share of the work: before it, the estimate of the time left would jump

}  // namespace

ProgressLine::ProgressLine(bool is_quiet)
    : is_quiet_(is_quiet), is_terminal_(isatty(STDERR_FILENO) != 0), begin_ns_(monotonic_ns()) {}

void ProgressLine::show(std::string_view doing, double share) {
  if (is_quiet_) return;
  const std::int64_t now_ns = monotonic_ns();
  const std::string done = share < 0 ? "" : fmt::format("{:3.0f} %  ", 100 * share);
  if (!is_terminal_) {
    if (doing != last_) std::fprintf(stderr, "%s%s\n", done.c_str(), printable(doing).c_str());
  } else if (doing != last_ || now_ns >= next_ns_) {
    next_ns_ = now_ns + kTerminalPeriodNs;
    std::fprintf(stderr, "\r%s%s%s\x1b[K", done.c_str(), printable(doing).c_str(), left_text(share, now_ns).c_str());
    is_shown_ = true;
  }
  last_ = doing;
}

void ProgressLine::clear() {
  if (is_shown_) std::fprintf(stderr, "\r\x1b[K");
  is_shown_ = false;
}

std::string ProgressLine::left_text(double share, std::int64_t now_ns) const {
  if (share < kKnown) return "";
  const double elapsed = static_cast<double>(now_ns - begin_ns_) * 1e-9;
  return fmt::format("  {} left", duration_text(elapsed * (1 - share) / share));
}

}  // namespace slew::cli
