// SPDX-License-Identifier: Apache-2.0
// A lock on a file against other processes that take it.
#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

namespace slew::view_node {

// Waits for the lock, and holds it until it is destroyed.
class FileLock {
 public:
  // flags: of open(2); O_CREAT makes a file for this user alone.
  FileLock(const std::filesystem::path& file, int flags) : file_(open(file.c_str(), flags | O_CLOEXEC, 0600)) {
    if (file_ < 0 || flock(file_, LOCK_EX) != 0) error_ = errno;
  }
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;
  ~FileLock() {
    if (file_ >= 0) close(file_);
  }
  // errno of the call that failed; 0: the lock is held.
  [[nodiscard]] int error() const noexcept { return error_; }

 private:
  int file_;
  int error_ = 0;
};

}  // namespace slew::view_node
