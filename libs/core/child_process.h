// SPDX-License-Identifier: Apache-2.0
// A program started beside this one: its own process group, its output in a pipe, dead when this process dies.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace slew {

// How a process ended: an exit code, or the signal that killed it.
struct ProcessEnd {
  int exit_code = 0;
  int signal = 0;  // 0: it exited by itself
  // "exited with code 2", "was killed by signal 9 (Killed)"
  [[nodiscard]] std::string text() const;
};

class ChildProcess {
 public:
  // program: path of the executable. Throws Failure (resources) when no process can be made; a program that cannot be
  // executed ends at once with code 127 and one line of output that states the reason.
  ChildProcess(std::string name, const std::string& program, const std::vector<std::string>& arguments);
  // Kills the process if it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] pid_t pid() const noexcept { return pid_; }
  [[nodiscard]] int output_fd() const noexcept { return output_fd_; }

  void send_signal(int signal) noexcept;
  // Exit status once the process has ended. Does not block.
  [[nodiscard]] const std::optional<ProcessEnd>& poll_end();
  // Whole lines written since the last call; after the end also an unfinished one.
  [[nodiscard]] std::vector<std::string> take_lines();

 private:
  void read_output();

  std::string name_;
  pid_t pid_ = -1;
  int output_fd_ = -1;
  std::string unfinished_;
  std::vector<std::string> lines_;
  std::optional<ProcessEnd> end_;
};

}  // namespace slew
