// SPDX-License-Identifier: Apache-2.0
#include "shifted_clock.h"

#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>

namespace {

using slew::testing::ClockShift;

constexpr std::int64_t kNs = 1'000'000'000;
constexpr std::int64_t kLookAgainNs = 5'000'000;  // longest delay after which a sleeper sees a jump of the clock

ClockShift* the_shift() {
  static ClockShift* const shift = [] {
    static ClockShift none;
    const char* const path = std::getenv(slew::testing::kClockShiftVariable);
    const int file = path == nullptr ? -1 : open(path, O_RDWR | O_CLOEXEC);
    if (file < 0) return &none;
    void* const page = mmap(nullptr, sizeof(ClockShift), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    close(file);
    return page == MAP_FAILED ? &none : static_cast<ClockShift*>(page);
  }();
  return shift;
}

std::int64_t kernel_ns(clockid_t clock) {
  timespec time{};
  syscall(SYS_clock_gettime, clock, &time);
  return time.tv_sec * kNs + time.tv_nsec;
}

std::int64_t shifted_ns() {
  the_shift()->reads.fetch_add(1, std::memory_order_relaxed);
  return kernel_ns(CLOCK_REALTIME) + the_shift()->ns.load();
}

timespec timespec_of(std::int64_t ns) {
  return {static_cast<time_t>(ns / kNs), static_cast<long>(ns % kNs)};
}

}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* time) noexcept {
  if (clock != CLOCK_REALTIME && clock != CLOCK_REALTIME_COARSE) {
    return static_cast<int>(syscall(SYS_clock_gettime, clock, time));
  }
  *time = timespec_of(shifted_ns());
  return 0;
}

int gettimeofday(timeval* time, void*) noexcept {
  const std::int64_t ns = shifted_ns();
  *time = {static_cast<time_t>(ns / kNs), static_cast<suseconds_t>(ns % kNs / 1000)};
  return 0;
}

time_t time(time_t* seconds) noexcept {
  const auto now = static_cast<time_t>(shifted_ns() / kNs);
  if (seconds != nullptr) *seconds = now;
  return now;
}

// Pre-condition: a condition with the default clock, as all of this program are that wait so.
int pthread_cond_timedwait(pthread_cond_t* condition, pthread_mutex_t* mutex, const timespec* until) {
  const std::int64_t until_ns = until->tv_sec * kNs + until->tv_nsec;
  while (true) {
    const std::int64_t left_ns = until_ns - shifted_ns();
    if (left_ns <= 0) return ETIMEDOUT;
    const timespec look_again = timespec_of(kernel_ns(CLOCK_MONOTONIC) + std::min(left_ns, kLookAgainNs));
    const int result = pthread_cond_clockwait(condition, mutex, CLOCK_MONOTONIC, &look_again);
    if (result != ETIMEDOUT) return result;
  }
}

}  // extern "C"
