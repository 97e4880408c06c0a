// SPDX-License-Identifier: Apache-2.0
#include "core/real_time_thread.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>

#include "core/allocation_guard.h"

namespace slew {
namespace real_time_thread_test {

constexpr std::size_t kPage = 4096;

void write_to_pages(volatile char* bytes, std::size_t size) {
  for (std::size_t i = 0; i < size; i += kPage) bytes[i] = 1;
}

[[gnu::noinline]] void use_stack() {
  char bytes[200 << 10];
  write_to_pages(bytes, sizeof bytes);
}

void use_heap() {
  auto* bytes = static_cast<char*>(std::malloc(16u << 20));
  write_to_pages(bytes, 16u << 20);
  std::free(bytes);
}

long page_faults() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt + usage.ru_majflt;
}

// In a process of its own, whose scheduling and memory no other test uses; memory is touched with and without
// permission.
TEST(RealTimeThread, HasItsStackAndHeapInMemoryBeforeItUsesThem) {
  if (!AllocationGuard::kCounts) GTEST_SKIP() << "a sanitizer is in front of malloc";
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    static_cast<void>(make_real_time(1));
    const long before = page_faults();
    use_stack();
    use_heap();
    _exit(page_faults() == before ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << "pages came while they were used";
}

}  // namespace real_time_thread_test
}  // namespace slew
