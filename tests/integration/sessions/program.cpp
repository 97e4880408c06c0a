// SPDX-License-Identifier: Apache-2.0
#include "program.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "build_paths.h"
#include "core/time.h"

namespace slew::testing {
namespace {

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace

Program::Program(const std::filesystem::path& path, const std::vector<std::string>& arguments,
                 const std::filesystem::path& output)
    : output_(output) {
  // everything that allocates happens before the fork
  std::vector<std::string> texts = {path.string()};
  texts.insert(texts.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  const int out = open((output_.string() + ".out").c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  const int err = open((output_.string() + ".err").c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (out < 0 || err < 0) throw std::runtime_error("cannot write to " + output_.string());
  pid_ = fork();
  if (pid_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    // a shell's background job ignores them, and so would its child processes
    for (const int ignored : {SIGINT, SIGHUP, SIGTERM}) signal(ignored, SIG_DFL);
    setpgid(0, 0);
    dup2(out, STDOUT_FILENO);
    dup2(err, STDERR_FILENO);
    execv(pointers[0], pointers.data());
    _exit(127);
  }
  close(out);
  close(err);
  if (pid_ < 0) throw std::runtime_error("cannot start " + path.string());
  watch_ = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
}

Program::~Program() {
  if (!end_) {
    send(SIGKILL);
    static_cast<void>(wait());
  }
  if (watch_ >= 0) close(watch_);
}

void Program::send(int signal) const {
  if (!end_) kill(pid_, signal);
}

std::optional<int> Program::wait(std::int64_t longest_ns) {
  if (end_) return end_;
  pollfd request{watch_, POLLIN, 0};
  if (poll(&request, 1, static_cast<int>(longest_ns / 1'000'000)) != 1) return std::nullopt;
  int status = 0;
  waitpid(pid_, &status, 0);
  end_ = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  return end_;
}

std::string Program::out() const {
  return text_of(output_.string() + ".out");
}
std::string Program::err() const {
  return text_of(output_.string() + ".err");
}

std::filesystem::path program_path(const std::string& name) {
  return std::filesystem::path(SLEWRING_BINARY_DIR) / "bin" / name;
}

ScratchFolder::ScratchFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "slewring-session-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make a folder for temporary files");
  path_ = pattern;
}

ScratchFolder::~ScratchFolder() {
  if (::testing::Test::HasFailure()) {
    std::fprintf(stderr, "the test's files are kept in %s\n", path_.c_str());
    return;
  }
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace slew::testing
