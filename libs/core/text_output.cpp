// SPDX-License-Identifier: Apache-2.0
#include "core/text_output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iostream>

#include "core/failure.h"

namespace slew {
namespace {

Status failed(const std::filesystem::path& path, const std::string& reason) {
  return Status::error(ExitCode::storage, fmt::format("{}: cannot be written ({}); nothing was kept; free space or "
                                                      "choose another place with -o",
                                                      path.string(), reason));
}

}  // namespace

Status replace_file(const std::filesystem::path& path,
                    const std::function<Status(const std::filesystem::path&)>& write) {
  std::error_code error;
  const std::filesystem::file_status there = std::filesystem::status(path, error);
  if (std::filesystem::exists(there) && !std::filesystem::is_regular_file(there)) return write(path);
  const std::filesystem::path part = path.string() + ".part";
  Status status;
  try {
    status = write(part);
  } catch (...) {
    std::filesystem::remove(part, error);
    throw;
  }
  if (status.is_ok()) {
    std::filesystem::rename(part, path, error);
    if (error) status = failed(path, error.message());
  }
  if (status.is_ok()) return status;
  std::filesystem::remove(part, error);
  if (const std::size_t at = status.text.find(part.string()); at != std::string::npos) {
    status.text.replace(at, part.string().size(), path.string());
  }
  return status;
}

Status put_text(const std::filesystem::path& path, const std::string& text) {
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  return file ? Status::ok() : failed(path, std::strerror(errno));
}

void require_writable(const std::string& path) {
  if (path == "-") return;
  std::error_code error;
  const std::filesystem::file_status there = std::filesystem::status(path, error);
  errno = 0;
  bool is_writable = false;
  if (std::filesystem::is_directory(there)) {
    errno = EISDIR;
  } else if (std::filesystem::exists(there) && !std::filesystem::is_regular_file(there)) {
    is_writable = access(path.c_str(), W_OK) == 0;
  } else {
    const std::string part = path + ".part";
    const int file = open(part.c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0666);
    is_writable = file >= 0;
    if (is_writable) {
      close(file);
      std::filesystem::remove(part, error);
    }
  }
  if (is_writable) return;
  throw Failure(ExitCode::storage,
                fmt::format("{}: cannot be written ({}); nothing was done; choose another place with -o", path,
                            std::strerror(errno)));
}

void write_text(const std::string& path, const std::string& text) {
  if (path == "-") {
    std::cout << text << std::flush;
    return;
  }
  require(replace_file(path, [&text](const std::filesystem::path& part) { return put_text(part, text); }));
}

}  // namespace slew
