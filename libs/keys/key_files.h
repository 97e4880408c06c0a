// Files and folders of a key store. What was there before is left as it is, with its mode.
#pragma once

#include <filesystem>
#include <string>

#include "core/failure.h"

namespace slew::keys {

// Of a file or folder, with code 6.
[[nodiscard]] Failure storage_failure(const std::filesystem::path& path, const std::string& why);

// Throws Failure when it cannot be written.
void write_file(const std::filesystem::path& path, const std::string& text);
// Empty when it cannot be read.
[[nodiscard]] std::string read_file(const std::filesystem::path& path);

enum class Folder : bool { made, was_there };
// For this user alone, whatever the umask, when it is not there yet; as many above it as are missing with the umask's
// mode. Throws Failure.
Folder make_private_folder(const std::filesystem::path& path);

// A folder for this user alone under a name that nobody had and that begins as `path` does. It is removed at the end
// unless it was moved away or is to be kept.
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
