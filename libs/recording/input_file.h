// SPDX-License-Identifier: Apache-2.0
// A file that is read by offset. Its size is taken once; a file that shrinks meanwhile gives an error, not a crash.
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/status.h"
#include "recording/byte_order.h"

namespace slew::recording {

class InputFile {
 public:
  InputFile() = default;
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  // Errors: bad_input if the regular file does not exist, storage if it cannot be read.
  [[nodiscard]] Status open(const std::filesystem::path& path);

  // Reads exactly size bytes into out, which is resized. Ranges beyond the end are an error and allocate nothing.
  // Errors: storage.
  [[nodiscard]] Status read(std::uint64_t offset, std::uint64_t size, Bytes& out) const;

  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace slew::recording
