// SPDX-License-Identifier: Apache-2.0
// A file in memory under a path.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "tests/fuzz/bytes.h"

namespace slew::fuzz {

class MemoryFile {
 public:
  MemoryFile() : fd_(memfd_create("input", 0)) { require(fd_ >= 0); }
  ~MemoryFile() { close(fd_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  void write(const std::uint8_t* data, std::size_t size) {
    require(ftruncate(fd_, 0) == 0);
    require(pwrite(fd_, data, size, 0) == static_cast<ssize_t>(size));
  }
  [[nodiscard]] std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(fd_); }

 private:
  int fd_;
};

// A file that a fuzzer writes, in the folder TMPDIR.
inline std::filesystem::path written_file(const std::string& ending) {
  return std::filesystem::temp_directory_path() / ("slewring_fuzz_" + std::to_string(getpid()) + ending);
}

}  // namespace slew::fuzz
