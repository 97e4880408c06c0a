// SPDX-License-Identifier: Apache-2.0
// A program of the build started as a process of its own: own process group, output in files, killed when the test
// dies.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace slew::testing {

// Longest wait for anything that should happen soon; generous, since the machine may be busy.
inline constexpr std::int64_t kSoonNs = 30'000'000'000;

class Program {
 public:
  // path: of the executable; arguments without the program's name. Standard output and error go to OUTPUT.out and .err.
  Program(const std::filesystem::path& path, const std::vector<std::string>& arguments,
          const std::filesystem::path& output);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void send(int signal) const;
  [[nodiscard]] pid_t pid() const noexcept { return pid_; }

  // Exit code, or minus the signal that ended it; none when it still runs after the time.
  [[nodiscard]] std::optional<int> wait(std::int64_t longest_ns = kSoonNs);
  [[nodiscard]] bool is_running() { return !wait(0).has_value(); }

  [[nodiscard]] std::string out() const;
  [[nodiscard]] std::string err() const;

 private:
  std::filesystem::path output_;
  pid_t pid_ = -1;
  int watch_ = -1;  // pidfd
  std::optional<int> end_;
};

// An executable of this build.
[[nodiscard]] std::filesystem::path program_path(const std::string& name);

// A folder of this test's own, removed at the end unless the test failed.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace slew::testing
