// SPDX-License-Identifier: Apache-2.0
// Loaded in front of the C library (LD_PRELOAD): a disk that confirms writes only after a time in s from the
// environment.
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

extern "C" int fdatasync(int descriptor) {
  const char* const seconds = std::getenv("SLEWRING_SLOW_DISK");
  timespec left = {seconds == nullptr ? 0 : std::atol(seconds), 0};
  // as a disk that is waited for: signals change nothing
  while (nanosleep(&left, &left) != 0 && errno == EINTR) {
  }
  return static_cast<int>(syscall(SYS_fdatasync, descriptor));
}
