// SPDX-License-Identifier: Apache-2.0
// Programs run by tests: to their end with their output, or in the background.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace slew::testing {

struct CommandResult {
  int code = -1;  // exit code, or minus the signal
  std::string out;
  std::string err;
};

// One of the programs that are tested, started with its output in files of a folder.
class Command {
 public:
  // program: name in the build's bin folder.
  Command(const std::string& program, const std::vector<std::string>& arguments,
          const std::filesystem::path& working_folder);
  ~Command();  // kills it when it still runs
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;

  [[nodiscard]] pid_t pid() const noexcept { return pid_; }
  void send(int signal) const;
  // Waits for the end, at most 120 s.
  [[nodiscard]] CommandResult wait();
  [[nodiscard]] bool has_ended();
  // Its output so far.
  [[nodiscard]] std::string out() const;
  [[nodiscard]] std::string err() const;

 private:
  pid_t pid_ = -1;
  int status_ = 0;
  bool has_ended_ = false;
  std::filesystem::path out_, err_;
};

[[nodiscard]] CommandResult run(const std::string& program, const std::vector<std::string>& arguments,
                                const std::filesystem::path& working_folder);

// Waits until the condition holds; false after the time.
[[nodiscard]] bool wait_until(const std::function<bool()>& condition, double seconds = 60);

// A folder for one test, removed afterwards when the test passed.
class WorkFolder {
 public:
  WorkFolder();
  ~WorkFolder();
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  // The only recording below it; throws when there is none or more than one.
  [[nodiscard]] std::filesystem::path recording() const;

 private:
  std::filesystem::path path_;
};

// A program of this build; a path that is absolute stays.
[[nodiscard]] std::filesystem::path program_file(const std::string& name);

[[nodiscard]] std::string scene_file(const std::string& name);

// Process ids of the programs that a supervisor has started, by program name ("mechanics_node").
[[nodiscard]] pid_t child_of(pid_t parent, const std::string& program);

// The sanitizers of this build, as in -fsanitize=; empty for none.
[[nodiscard]] std::string_view sanitizers();

// False with the sanitizer of undefined behaviour: it checks the types of objects with a pipe, and reports them as
// wrong when it cannot open one.
[[nodiscard]] bool can_run_without_files();

}  // namespace slew::testing
