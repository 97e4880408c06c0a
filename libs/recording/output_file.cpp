// SPDX-License-Identifier: Apache-2.0
#include "recording/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <limits>
#include <tuple>

#include "recording/records.h"

namespace slew::recording {
namespace {

// remedy for a failed write
const char* remedy_of(int error) noexcept {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return "free space on that file system, or record elsewhere with --out DIR";
    case EFBIG:
      return "raise the file size limit (ulimit -f), or record to another file system";
    case EACCES:
    case EPERM:
    case EROFS:
      return "choose a directory that you may write to with --out DIR";
    case EIO:
      return "check the disk (dmesg), and record elsewhere with --out DIR";
    default:
      return "record elsewhere with --out DIR";
  }
}

}  // namespace

std::int64_t FileCalls::write(int descriptor, ByteSpan bytes, std::uint64_t offset) {
  return ::pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
}

int FileCalls::truncate(int descriptor, std::uint64_t size) {
  return ::ftruncate(descriptor, static_cast<off_t>(size));
}

int FileCalls::reserve(int descriptor, std::uint64_t offset, std::uint64_t size) {
  return ::fallocate(descriptor, FALLOC_FL_KEEP_SIZE, static_cast<off_t>(offset), static_cast<off_t>(size));
}

int FileCalls::synchronise(int descriptor) {
  return ::fdatasync(descriptor);
}

int FileCalls::close(int descriptor) {
  return ::close(descriptor);
}

std::uint64_t FileCalls::free_bytes(const std::filesystem::path& path) {
  struct statvfs room {};
  if (::statvfs(path.c_str(), &room) != 0) return std::numeric_limits<std::uint64_t>::max();
  return std::uint64_t{room.f_bavail} * room.f_frsize;
}

FileCalls& system_file_calls() noexcept {
  static FileCalls calls;
  return calls;
}

OutputFile::~OutputFile() {
  if (is_open()) std::ignore = calls_.close(descriptor_);
}

Status OutputFile::create(const std::filesystem::path& path) {
  path_ = path;
  descriptor_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (is_open()) return Status::ok();
  const int error = errno;
  if (error == EEXIST) {
    return Status::error(ExitCode::storage,
                         fmt::format("{}: the file exists already; recordings are never overwritten; "
                                     "choose another name",
                                     path.string()));
  }
  return Status::error(ExitCode::storage, fmt::format("{}: cannot create the recording ({}); nothing was written; {}",
                                                      path.string(), std::strerror(error), remedy_of(error)));
}

Status OutputFile::append(ByteSpan records, std::uint64_t room_behind) {
  if (room_behind > 0) {
    has_reserved_ = true;
    const std::uint64_t needed = records.size() + room_behind;
    if (calls_.reserve(descriptor_, size_, needed) != 0 && (errno == ENOSPC || errno == EDQUOT)) {
      return failed(errno, records.size(), size_);
    }
  }
  return write_all(records, crc32_of(records, crc_));
}

// truncate to the last whole record; if that fails, the reader stops at the same place
Status OutputFile::failed(int error, std::size_t bytes, std::uint64_t at) {
  const bool is_cut_back = at == size_ || calls_.truncate(descriptor_, size_) == 0;
  return Status::error(
      ExitCode::storage,
      fmt::format("{}: cannot write {} bytes at byte {} ({}); {} {} bytes that are readable; {}", path_.string(), bytes,
                  at, std::strerror(error), is_cut_back ? "the file was cut back to" : "the file begins with", size_,
                  remedy_of(error)));
}

Status OutputFile::append_marked(Bytes& records) {
  const std::uint32_t crc = crc32_of(records, crc_);
  const std::size_t mark_at = records.size();
  encode_mark(records, crc);
  return write_all(records, crc32_of(ByteSpan(records).subspan(mark_at), crc));
}

Status OutputFile::write_all(ByteSpan bytes, std::uint32_t crc_after) {
  std::uint64_t at = size_;
  while (!bytes.empty()) {
    const std::int64_t written = calls_.write(descriptor_, bytes, at);
    if (written > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(written));
      at += static_cast<std::uint64_t>(written);
      continue;
    }
    const int error = written == 0 ? EIO : errno;
    if (error == EINTR) continue;
    return failed(error, bytes.size(), at);
  }
  size_ = at;
  crc_ = crc_after;
  return Status::ok();
}

Status OutputFile::close() {
  if (!is_open()) return Status::ok();
  if (has_reserved_) std::ignore = calls_.truncate(descriptor_, size_);  // releases the reserved space
  const bool is_synchronised = calls_.synchronise(descriptor_) == 0;
  const int sync_error = errno;
  const bool is_closed = calls_.close(descriptor_) == 0;
  const int close_error = errno;
  descriptor_ = -1;
  if (is_synchronised && is_closed) return Status::ok();
  const int error = is_synchronised ? close_error : sync_error;
  return Status::error(ExitCode::storage,
                       fmt::format("{}: the disk did not confirm the recording ({}); it was closed and may be "
                                   "incomplete; check it with slewring info, {}",
                                   path_.string(), std::strerror(error), remedy_of(error)));
}

}  // namespace slew::recording
