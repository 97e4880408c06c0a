// SPDX-License-Identifier: Apache-2.0
#include "core/real_time_thread.h"

#include <malloc.h>
#include <sched.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>

namespace slew {
namespace {

constexpr std::size_t kHeap = 32u << 20;
constexpr std::size_t kStack = 256u << 10;
constexpr std::size_t kPage = 4096;

void touch(volatile char* bytes, std::size_t size) noexcept {
  for (std::size_t i = 0; i < size; i += kPage) bytes[i] = 0;
}

// the stack frame is released, its pages stay mapped
[[gnu::noinline]] void touch_stack() noexcept {
  char bytes[kStack];
  touch(bytes, kStack);
}

void keep_memory() noexcept {
  // allocate no block by mmap and return none to the system: touched pages stay
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, -1);
  if (void* heap = std::malloc(kHeap)) {
    touch(static_cast<char*>(heap), kHeap);
    std::free(heap);
  }
  touch_stack();
}

}  // namespace

Status make_real_time(int priority) {
  std::string refused, goes_on;
  sched_param parameters{};
  parameters.sched_priority = priority;
  if (sched_setscheduler(0, SCHED_FIFO, &parameters) != 0) {
    refused = std::string("SCHED_FIFO was refused (") + std::strerror(errno) + ")";
    goes_on = "normal scheduling";
  }
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    refused += std::string(refused.empty() ? "" : ", ") + "locking memory was refused (" + std::strerror(errno) + ")";
    goes_on += std::string(goes_on.empty() ? "" : " and ") + "memory that may be paged";
  }
  keep_memory();
  if (refused.empty()) return Status::ok();
  return Status::error(ExitCode::resources,
                       refused + "; the run goes on with " + goes_on +
                           "; to allow it, run as root, or set 'rtprio 95' and 'memlock unlimited' for the user in "
                           "/etc/security/limits.conf and log in again");
}

std::vector<int> usable_cpus() {
  std::vector<int> cpus;
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof set, &set) != 0) return cpus;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
    if (CPU_ISSET(cpu, &set)) cpus.push_back(cpu);
  }
  return cpus;
}

Status run_on_cpu(int cpu) {
  const std::vector<int> cpus = usable_cpus();
  if (!std::binary_search(cpus.begin(), cpus.end(), cpu)) {
    return Status::error(ExitCode::bad_input, "there is no processor " + std::to_string(cpu) +
                                                  " for this process; there are " + cpu_list(cpus) +
                                                  "; nothing was started; name one of them in --cpu or session.cpus");
  }
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(cpu, &set);
  if (sched_setaffinity(0, sizeof set, &set) == 0) return Status::ok();
  return Status::error(ExitCode::resources, "processor " + std::to_string(cpu) + " was refused (" +
                                                std::strerror(errno) + "); nothing was started; leave out --cpu");
}

std::string cpu_list(const std::vector<int>& cpus) {
  std::string text;
  for (const int cpu : cpus) text += (text.empty() ? "" : ", ") + std::to_string(cpu);
  return text;
}

}  // namespace slew
