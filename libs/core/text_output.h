// Files that a verb writes: whole, or as they were.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "core/status.h"

namespace slew {

// Replaces the file by what `write` puts into the path that it is given: one beside it, which takes its name when
// everything is written, and is removed otherwise. What is there and no file, such as /dev/stdout, is written to as it
// is. The result is write's own, about the file's own path; storage when the name cannot be taken.
[[nodiscard]] Status replace_file(const std::filesystem::path& path,
                                  const std::function<Status(const std::filesystem::path&)>& write);

// Writes to the path as it is. Error storage.
[[nodiscard]] Status put_text(const std::filesystem::path& path, const std::string& text);

// Before long work: throws Failure (storage) when write_text() could not write there now. What is there stays as it is.
void require_writable(const std::string& path);

// Replaces a file; "-" is standard output. Throws Failure (storage).
void write_text(const std::string& path, const std::string& text);

}  // namespace slew
