// SPDX-License-Identifier: Apache-2.0
#include "command.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "build_paths.h"
#include "core/time.h"

namespace slew::testing {
namespace {

constexpr double kLongestRun = 120;  // s

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

int file_for_writing(const std::filesystem::path& path) {
  return open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
}

}  // namespace

Command::Command(const std::string& program, const std::vector<std::string>& arguments,
                 const std::filesystem::path& working_folder) {
  static std::atomic<int> number{0};
  const std::string name = std::to_string(++number);
  out_ = working_folder / (name + ".out");
  err_ = working_folder / (name + ".err");
  std::vector<std::string> owned = arguments;
  owned.insert(owned.begin(), program_file(program).string());
  std::vector<char*> pointers;
  for (std::string& argument : owned) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  const int out = file_for_writing(out_), err = file_for_writing(err_);
  pid_ = fork();
  if (pid_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    // a shell's background job ignores them, and so would its child processes
    for (const int ignored : {SIGINT, SIGHUP, SIGTERM}) signal(ignored, SIG_DFL);
    const int nothing = open("/dev/null", O_RDONLY);
    dup2(nothing, STDIN_FILENO);
    dup2(out, STDOUT_FILENO);
    dup2(err, STDERR_FILENO);
    if (chdir(working_folder.c_str()) == 0) execv(pointers[0], pointers.data());
    _exit(126);
  }
  close(out);
  close(err);
}

Command::~Command() {
  if (has_ended()) return;
  // first in order, so that the nodes of a supervisor end as well
  kill(pid_, SIGTERM);
  if (!wait_until([this] { return has_ended(); }, 10)) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
}

void Command::send(int signal) const {
  kill(pid_, signal);
}

bool Command::has_ended() {
  if (!has_ended_ && waitpid(pid_, &status_, WNOHANG) == pid_) has_ended_ = true;
  return has_ended_;
}

CommandResult Command::wait() {
  if (!wait_until([this] { return has_ended(); }, kLongestRun)) {
    throw std::runtime_error("a program did not end within 120 s; its output so far:\n" + out() + err());
  }
  return {WIFEXITED(status_) ? WEXITSTATUS(status_) : -WTERMSIG(status_), out(), err()};
}

std::string Command::out() const {
  return text_of(out_);
}
std::string Command::err() const {
  return text_of(err_);
}

CommandResult run(const std::string& program, const std::vector<std::string>& arguments,
                  const std::filesystem::path& working_folder) {
  return Command(program, arguments, working_folder).wait();
}

bool wait_until(const std::function<bool()>& condition, double seconds) {
  const std::int64_t end_ns = monotonic_ns() + static_cast<std::int64_t>(seconds * 1e9);
  while (!condition()) {
    if (monotonic_ns() > end_ns) return false;
    sleep_until_monotonic(monotonic_ns() + 5'000'000);
  }
  return true;
}

WorkFolder::WorkFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "slewring_cli_XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no folder for the test");
  path_ = pattern;
}

WorkFolder::~WorkFolder() {
  if (!::testing::Test::HasFailure()) std::filesystem::remove_all(path_);
}

std::filesystem::path WorkFolder::recording() const {
  std::filesystem::path found;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path_)) {
    if (entry.path().extension() != ".mcap") continue;
    if (!found.empty()) throw std::runtime_error("more than one recording in " + path_.string());
    found = entry.path();
  }
  if (found.empty()) throw std::runtime_error("no recording in " + path_.string());
  return found;
}

std::filesystem::path program_file(const std::string& name) {
  return std::filesystem::path(SLEWRING_BINARY_DIR) / "bin" / name;
}

std::string scene_file(const std::string& name) {
  return std::string(SLEWRING_SOURCE_DIR) + "/scenes/" + name;
}

pid_t child_of(pid_t parent, const std::string& program) {
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    // pid (comm) state ppid ...; comm has at most 15 characters
    const std::string stat = text_of(entry.path() / "stat");
    const std::size_t open = stat.find('('), close = stat.rfind(')');
    if (open == std::string::npos || close == std::string::npos) continue;
    if (stat.substr(open + 1, close - open - 1) != program.substr(0, 15)) continue;
    std::istringstream rest(stat.substr(close + 1));
    char state = 0;
    pid_t its_parent = 0;
    rest >> state >> its_parent;
    if (its_parent == parent && state != 'Z') return std::stoi(name);
  }
  return 0;
}

std::string_view sanitizers() {
  return SLEWRING_SANITIZER;
}

bool can_run_without_files() {
  return sanitizers().find("undefined") == std::string_view::npos;
}

}  // namespace slew::testing
