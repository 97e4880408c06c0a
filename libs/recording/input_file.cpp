// SPDX-License-Identifier: Apache-2.0
#include "recording/input_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace slew::recording {

InputFile::~InputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Status InputFile::open(const std::filesystem::path& path) {
  path_ = path;
  // a FIFO must not block the program before it is refused
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  struct stat entry {};
  if (descriptor_ < 0 || ::fstat(descriptor_, &entry) != 0) {
    return Status::error(ExitCode::bad_input,
                         fmt::format("{}: cannot open the recording ({}); nothing was read; check the path and its "
                                     "permissions",
                                     path.string(), std::strerror(errno)));
  }
  if (!S_ISREG(entry.st_mode)) {
    return Status::error(
        ExitCode::bad_input,
        fmt::format("{}: this is not a file; nothing was read; name the .mcap file itself", path.string()));
  }
  size_ = static_cast<std::uint64_t>(entry.st_size);
  return Status::ok();
}

Status InputFile::read(std::uint64_t offset, std::uint64_t size, Bytes& out) const {
  const auto failure = [&](const char* reason) {
    return Status::error(ExitCode::storage,
                         fmt::format("{}: cannot read {} bytes at byte {} ({}); reading stopped there; check the disk "
                                     "(dmesg) or copy the file",
                                     path_.string(), size, offset, reason));
  };
  if (offset > size_ || size > size_ - offset) return failure("behind the end of the file");
  out.resize(size);
  std::size_t done = 0;
  while (done < size) {
    const ssize_t count = ::pread(descriptor_, out.data() + done, size - done, static_cast<off_t>(offset + done));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return failure(std::strerror(errno));
    if (count == 0) return failure("the file became shorter while it was read");
    done += static_cast<std::size_t>(count);
  }
  return Status::ok();
}

}  // namespace slew::recording
