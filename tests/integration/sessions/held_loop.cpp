// SPDX-License-Identifier: Apache-2.0
#include "held_loop.h"

#include <fcntl.h>
#include <linux/futex.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace slew::testing {
namespace {

constexpr int kTries = 100'000;

// only calls that are safe after a fork of a process with threads

bool stop(pid_t thread) {
  int status = 0;
  return ptrace(PTRACE_INTERRUPT, thread, nullptr, nullptr) == 0 && waitpid(thread, &status, __WALL) == thread &&
         WIFSTOPPED(status);
}

// Where it waits for a message, as Doorbell does. Elsewhere it may have a lock of the middleware or wait for one, and
// the node's health waits behind it.
bool is_in_its_wait(const char* call_file) {
  std::array<char, 128> text{};
  const int file = open(call_file, O_RDONLY | O_CLOEXEC);
  if (file < 0 || read(file, text.data(), text.size() - 1) <= 0) text[0] = '\0';
  if (file >= 0) close(file);
  char* rest = nullptr;
  const long call = std::strtol(text.data(), &rest, 10);
  std::strtoul(rest, &rest, 16);  // where
  const unsigned long how = std::strtoul(rest, nullptr, 16);
  return call == SYS_futex && how == FUTEX_WAIT_BITSET_PRIVATE;
}

[[noreturn]] void hold(pid_t thread, const char* call_file, int pipe_end) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  bool is_stopped = ptrace(PTRACE_SEIZE, thread, nullptr, nullptr) == 0 && stop(thread);
  for (int i = 0; i < kTries && is_stopped && !is_in_its_wait(call_file); ++i) {
    is_stopped = ptrace(PTRACE_CONT, thread, nullptr, nullptr) == 0 && stop(thread);
  }
  int status = 0;
  const char word = is_stopped ? 'y' : 'n';
  if (write(pipe_end, &word, 1) != 1) _exit(1);
  // the kernel reports its end to the tracer first, and to its parent after that
  while (is_stopped && waitpid(thread, &status, __WALL) == thread && !WIFEXITED(status) && !WIFSIGNALED(status)) {
  }
  _exit(0);
}

}  // namespace

HeldLoop::HeldLoop(pid_t process) {
  const std::string call_file = "/proc/" + std::to_string(process) + "/syscall";
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw std::runtime_error("no pipe for a tracer");
  tracer_ = fork();
  if (tracer_ < 0) throw std::runtime_error("no process for a tracer");
  if (tracer_ == 0) hold(process, call_file.c_str(), ends[1]);
  close(ends[1]);
  char word = 'n';
  is_held_ = read(ends[0], &word, 1) == 1 && word == 'y';
  close(ends[0]);
}

// a traced process goes on when its tracer is gone
void HeldLoop::let_go() {
  if (tracer_ < 0) return;
  kill(tracer_, SIGKILL);
  waitpid(tracer_, nullptr, 0);
  tracer_ = -1;
  is_held_ = false;
}

}  // namespace slew::testing
