// SPDX-License-Identifier: Apache-2.0
#include "keys/key_files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "core/input_file.h"

namespace slew::keys {

namespace fs = std::filesystem;

Failure storage_failure(const fs::path& path, const std::string& why) {
  return Failure(ExitCode::storage, fmt::format("{}: {}; nothing else was changed", path.string(), why));
}

void write_file(const fs::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw storage_failure(path, "cannot be written");
}

void write_private_file(const fs::path& path, const std::string& text) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (file < 0) throw storage_failure(path, std::strerror(errno));
  ::close(file);
  write_file(path, text);
}

std::string read_file(const fs::path& path) {
  constexpr std::size_t kMost = 1'000'000;
  std::string text;
  static_cast<void>(read_input(path, kMost, text));  // empty: the caller refuses it
  return text;
}

Folder make_private_folder(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return Folder::was_there;
  error.clear();
  // a separator at its end would make the folder itself one of those above it
  const fs::path plain = path.has_filename() ? path : path.parent_path();
  if (plain.has_parent_path()) fs::create_directories(plain.parent_path(), error);
  if (error) throw storage_failure(plain.parent_path(), error.message());
  if (::mkdir(plain.c_str(), S_IRWXU) != 0) throw storage_failure(path, std::strerror(errno));
  return Folder::made;
}

UniqueFolder::UniqueFolder(const fs::path& path) {
  std::string name = path.string() + ".XXXXXX";
  if (::mkdtemp(name.data()) == nullptr) throw storage_failure(name, std::strerror(errno));
  path_ = name;
}

UniqueFolder::~UniqueFolder() {
  std::error_code ignored;
  if (!is_kept_) fs::remove_all(path_, ignored);
}

}  // namespace slew::keys
