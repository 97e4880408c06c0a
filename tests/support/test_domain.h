// SPDX-License-Identifier: Apache-2.0
// A DDS domain number that no other test on this host uses, as long as the object lives.
//
// Numbers 1 to 99, each behind a lock file in the system's directory for temporary files. Forked children share the
// lock; programs started by exec do not hold it.
#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace slew::testing {

class TestDomain {
 public:
  TestDomain() {
    // start at a place of one's own, so that parallel tests rarely meet
    const std::uint32_t start = static_cast<std::uint32_t>(getpid()) % kCount;
    for (std::uint32_t i = 0; i < kCount && file_ < 0; ++i) try_lock(1 + (start + i) % kCount);
    if (file_ < 0) throw std::runtime_error("all test domains 1 to 99 are in use");
  }
  ~TestDomain() { close(file_); }
  TestDomain(const TestDomain&) = delete;
  TestDomain& operator=(const TestDomain&) = delete;

  [[nodiscard]] std::uint32_t number() const noexcept { return number_; }

 private:
  static constexpr std::uint32_t kCount = 99;

  void try_lock(std::uint32_t number) {
    const std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("slewring-test-domain-" + std::to_string(number));
    const int file = open(path.c_str(), O_RDONLY | O_CREAT | O_CLOEXEC, 0666);
    if (file < 0) return;
    if (flock(file, LOCK_EX | LOCK_NB) != 0) {
      close(file);
      return;
    }
    file_ = file;
    number_ = number;
  }

  int file_ = -1;
  std::uint32_t number_ = 0;
};

}  // namespace slew::testing
