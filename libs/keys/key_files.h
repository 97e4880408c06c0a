// SPDX-License-Identifier: Apache-2.0
// Files and folders of a key store. Files that existed before are left as they are, with their mode.
#pragma once

#include <filesystem>
#include <string>

#include "core/failure.h"

namespace slew::keys {

// Failure of a file or folder, with code 6.
[[nodiscard]] Failure storage_failure(const std::filesystem::path& path, const std::string& why);

// Throws Failure when it cannot be written.
void write_file(const std::filesystem::path& path, const std::string& text);
// The same for a new file that only its owner may read, whatever the umask.
void write_private_file(const std::filesystem::path& path, const std::string& text);
// Empty when it cannot be read.
[[nodiscard]] std::string read_file(const std::filesystem::path& path);

enum class Folder : bool { made, was_there };
// Makes a folder for this user alone, whatever the umask, unless it exists; missing parent folders get the umask's
// mode. Throws Failure.
Folder make_private_folder(const std::filesystem::path& path);

// A folder for this user alone under an unused name that begins as `path` does. The destructor removes it unless it was
// moved away or is to be kept.
class UniqueFolder {
 public:
  explicit UniqueFolder(const std::filesystem::path& path);
  ~UniqueFolder();
  UniqueFolder(const UniqueFolder&) = delete;
  UniqueFolder& operator=(const UniqueFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  void keep() noexcept { is_kept_ = true; }

 private:
  std::filesystem::path path_;
  bool is_kept_ = false;
};

}  // namespace slew::keys
