// SPDX-License-Identifier: Apache-2.0
#include "transport/doorbell.h"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>

namespace slew::transport {
namespace {

static_assert(sizeof(std::atomic<std::uint32_t>) == sizeof(std::uint32_t), "the kernel compares the bare word");

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

}  // namespace

void Doorbell::ring(std::uint32_t bits) noexcept {
  bits_.fetch_or(bits);
  // either the sleeper sees the bits before it sleeps, or its flag is seen here
  if (is_asleep_.load()) syscall(SYS_futex, &bits_, FUTEX_WAKE_PRIVATE, 1, nullptr, nullptr, 0);
}

void Doorbell::wait_until(std::int64_t monotonic_deadline_ns) noexcept {
  if (monotonic_deadline_ns < 0) monotonic_deadline_ns = 0;
  const timespec deadline{monotonic_deadline_ns / kNanosecondsPerSecond, monotonic_deadline_ns % kNanosecondsPerSecond};
  is_asleep_.store(true);
  while (bits_.load() == 0) {
    const long rc =
        syscall(SYS_futex, &bits_, FUTEX_WAIT_BITSET_PRIVATE, 0, &deadline, nullptr, FUTEX_BITSET_MATCH_ANY);
    if (rc != 0 && errno == ETIMEDOUT) break;
  }
  is_asleep_.store(false);
}

}  // namespace slew::transport
