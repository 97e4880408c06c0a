// SPDX-License-Identifier: Apache-2.0
// Programs of others as peers in tests: a shell command, its output and its exit code.
#pragma once

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <string>

namespace slew::devices::testing {

struct ProgramResult {
  int exit_code = -1;
  std::string output;
};

// Runs `sh -c command`.
inline ProgramResult run_shell(const std::string& command) {
  ProgramResult result;
  FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return result;
  std::array<char, 4096> buffer;
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe))
    result.output.append(buffer.data(), n);
  const int status = ::pclose(pipe);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return result;
}

inline bool has_program(const std::string& name) {
  return run_shell("command -v " + name + " > /dev/null 2>&1").exit_code == 0;
}

inline void write_file(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

}  // namespace slew::devices::testing
