// SPDX-License-Identifier: Apache-2.0
// A forked process that runs a function and reports success by its exit code; killed when the test leaves early.
#pragma once

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <utility>

namespace slew::testing {

class ChildProcess {
 public:
  // `body` returns whether all went well; it must not use gtest.
  template <typename Body>
  explicit ChildProcess(Body&& body) {
    std::fflush(nullptr);
    pid_ = fork();
    if (pid_ != 0) return;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    bool is_good = false;
    try {
      is_good = body();
    } catch (const std::exception& error) {
      std::fprintf(stderr, "child process: %s\n", error.what());
    }
    std::fflush(nullptr);
    _exit(is_good ? 0 : 1);
  }
  ~ChildProcess() {
    if (pid_ > 0) {
      send(SIGKILL);
      static_cast<void>(wait());
    }
  }
  ChildProcess(ChildProcess&& other) noexcept : pid_(std::exchange(other.pid_, -1)) {}
  ChildProcess& operator=(ChildProcess&&) = delete;

  void send(int signal) const { kill(pid_, signal); }

  // False when it ended instead.
  [[nodiscard]] bool wait_until_stopped() {
    int status = 0;
    waitpid(pid_, &status, WUNTRACED);
    if (!WIFSTOPPED(status)) pid_ = -1;
    return WIFSTOPPED(status);
  }

  // Exit code, or minus the number of the signal that ended it.
  [[nodiscard]] int wait() {
    int status = 0;
    waitpid(std::exchange(pid_, -1), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

 private:
  pid_t pid_ = -1;
};

}  // namespace slew::testing
