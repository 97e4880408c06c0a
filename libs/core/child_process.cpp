// SPDX-License-Identifier: Apache-2.0
#include "core/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "core/failure.h"

namespace slew {
namespace {

constexpr int kNotExecuted = static_cast<int>(ExitCode::resources);

// between fork and exec: only calls that are safe there
[[noreturn]] void become(const char* program, char* const* arguments, int output, pid_t parent) noexcept {
  setpgid(0, 0);
  // a node ends in order when its supervisor is gone, even if the supervisor was killed just now
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(kNotExecuted);
  const int nothing = open("/dev/null", O_RDONLY);
  dup2(nothing, STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  dup2(output, STDERR_FILENO);
  // the supervisor's sockets are not the node's
  close_range(STDERR_FILENO + 1, ~0u, CLOSE_RANGE_CLOEXEC);
  // the node sets its own response to signals that the supervisor handles or ignores
  for (const int signal : {SIGINT, SIGTERM, SIGPIPE, SIGHUP}) std::signal(signal, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  execv(program, arguments);
  const char* reason = strerror(errno);
  for (const char* part : {"cannot start ", program, ": ", reason, "; build it, or install all programs together\n"}) {
    if (write(STDERR_FILENO, part, std::strlen(part)) < 0) break;
  }
  _exit(kNotExecuted);
}

}  // namespace

std::string ProcessEnd::text() const {
  if (signal != 0) return fmt::format("was killed by signal {} ({})", signal, strsignal(signal));
  return fmt::format("exited with code {}", exit_code);
}

ChildProcess::ChildProcess(std::string name, const std::string& program, const std::vector<std::string>& arguments)
    : name_(std::move(name)) {
  std::vector<std::string> owned = arguments;
  owned.insert(owned.begin(), program);
  std::vector<char*> pointers;
  for (std::string& argument : owned) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  std::array<int, 2> pipe_ends{};
  if (pipe2(pipe_ends.data(), O_CLOEXEC) != 0) {
    throw Failure(ExitCode::resources,
                  fmt::format("no pipe for {} ({}); it is not started; close other programs", name_, strerror(errno)));
  }
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ < 0) {
    const std::string reason = strerror(errno);
    close(pipe_ends[0]);
    close(pipe_ends[1]);
    throw Failure(ExitCode::resources,
                  fmt::format("no process for {} ({}); it is not started; close other programs", name_, reason));
  }
  if (pid_ == 0) become(program.c_str(), pointers.data(), pipe_ends[1], parent);
  setpgid(pid_, pid_);
  close(pipe_ends[1]);
  output_fd_ = pipe_ends[0];
  fcntl(output_fd_, F_SETFL, O_NONBLOCK);
}

ChildProcess::~ChildProcess() {
  if (!end_) {
    send_signal(SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  close(output_fd_);
}

void ChildProcess::send_signal(int signal) noexcept {
  if (!end_) kill(pid_, signal);
}

const std::optional<ProcessEnd>& ChildProcess::poll_end() {
  int status = 0;
  if (!end_ && waitpid(pid_, &status, WNOHANG) == pid_) {
    end_ = WIFSIGNALED(status) ? ProcessEnd{0, WTERMSIG(status)} : ProcessEnd{WEXITSTATUS(status), 0};
  }
  return end_;
}

void ChildProcess::read_output() {
  std::array<char, 4096> block{};
  for (ssize_t got = 0; (got = read(output_fd_, block.data(), block.size())) > 0;) {
    unfinished_.append(block.data(), static_cast<std::size_t>(got));
  }
  for (std::size_t end = 0; (end = unfinished_.find('\n')) != std::string::npos;) {
    lines_.push_back(unfinished_.substr(0, end));
    unfinished_.erase(0, end + 1);
  }
}

std::vector<std::string> ChildProcess::take_lines() {
  read_output();
  if (end_ && !unfinished_.empty()) lines_.push_back(std::exchange(unfinished_, {}));
  return std::exchange(lines_, {});
}

}  // namespace slew
