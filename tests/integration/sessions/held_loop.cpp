#include "held_loop.h"

#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <stdexcept>

namespace slew::testing {
namespace {

// only calls that are safe behind a fork of a process with threads
[[noreturn]] void hold(pid_t thread, int told) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const bool is_traced =
      ptrace(PTRACE_SEIZE, thread, nullptr, nullptr) == 0 && ptrace(PTRACE_INTERRUPT, thread, nullptr, nullptr) == 0;
  int status = 0;
  const bool is_stopped = is_traced && waitpid(thread, &status, __WALL) == thread && WIFSTOPPED(status);
  const char word = is_stopped ? 'y' : 'n';
  if (write(told, &word, 1) != 1) _exit(1);
  // its end is told to the tracer first, and to its parent behind that
  while (is_stopped && waitpid(thread, &status, __WALL) == thread && !WIFEXITED(status) && !WIFSIGNALED(status)) {
  }
  _exit(0);
}

}  // namespace

HeldLoop::HeldLoop(pid_t process) {
  std::array<int, 2> told{};
  if (pipe(told.data()) != 0) throw std::runtime_error("no pipe for a tracer");
  tracer_ = fork();
  if (tracer_ < 0) throw std::runtime_error("no process for a tracer");
  if (tracer_ == 0) hold(process, told[1]);
  close(told[1]);
  char word = 'n';
  is_held_ = read(told[0], &word, 1) == 1 && word == 'y';
  close(told[0]);
}

// who was traced goes on when its tracer is gone
void HeldLoop::let_go() {
  if (tracer_ < 0) return;
  kill(tracer_, SIGKILL);
  waitpid(tracer_, nullptr, 0);
  tracer_ = -1;
  is_held_ = false;
}

}  // namespace slew::testing
