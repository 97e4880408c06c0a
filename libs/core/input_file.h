// SPDX-License-Identifier: Apache-2.0
// Files that a user or a scene names: the type is checked before a byte is read.
//
// Accepts regular files up to a stated size. A FIFO or a device is refused without waiting for its other end. Reading a
// file that grows meanwhile stops at the bound.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace slew {

inline constexpr std::size_t kMaxAssetBytes = 1'000'000'000;  // largest mesh, saved session or flexible matrix

// Why a file is not read.
struct InputFault {
  std::string what;      // "is a directory"
  std::string expected;  // "a file"; may be empty

  // "is a directory; expected a file"
  [[nodiscard]] std::string text() const { return expected.empty() ? what : what + "; expected " + expected; }
};

// Check for a library that opens the file itself; no value: the file may be opened.
[[nodiscard]] std::optional<InputFault> find_input_fault(const std::filesystem::path& path, std::size_t most);

// Fills `bytes` with the whole file. After a fault they are empty.
[[nodiscard]] std::optional<InputFault> read_input(const std::filesystem::path& path, std::size_t most,
                                                   std::string& bytes);

}  // namespace slew
