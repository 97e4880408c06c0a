// SPDX-License-Identifier: Apache-2.0
// Output files of verbs: written whole, or left unchanged.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "core/status.h"

namespace slew {

// Replaces the file. `write` receives the path of a temporary file beside it, which is renamed after a complete write
// and removed otherwise, also where `write` throws. A target that is not a regular file, such as /dev/stdout, is
// written directly. Returns the result of `write`, with the file's own path; storage if the rename fails.
[[nodiscard]] Status replace_file(const std::filesystem::path& path,
                                  const std::function<Status(const std::filesystem::path&)>& write);

// Writes directly to the path. Error storage.
[[nodiscard]] Status put_text(const std::filesystem::path& path, const std::string& text);

// For use before long work: throws Failure (storage) if write_text() could not write there now. An existing file is not
// changed.
void require_writable(const std::string& path);

// Replaces a file; "-" is standard output. Throws Failure (storage).
void write_text(const std::string& path, const std::string& text);

}  // namespace slew
