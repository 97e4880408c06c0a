// SPDX-License-Identifier: Apache-2.0
// The file that a recording is written to: whole records only, with the checksum of everything written so far.
//
// When a write fails the file is cut back to the last whole record, so that it stays readable, and no further byte is
// written until the failure is reported. The file is not synchronised to the disk before close(): written records
// survive the death of the process, not a power cut (docs/recording-format.md).
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/status.h"
#include "recording/byte_order.h"

namespace slew::recording {

// System calls of a recording, with the semantics of pwrite, ftruncate, fdatasync and close. Tests replace them by a
// failing disk.
class FileCalls {
 public:
  virtual ~FileCalls() = default;
  [[nodiscard]] virtual std::int64_t write(int descriptor, ByteSpan bytes, std::uint64_t offset);
  [[nodiscard]] virtual int truncate(int descriptor, std::uint64_t size);
  // Reserves space for so many bytes at the offset, also beyond the file's end; the size of the file does not change.
  [[nodiscard]] virtual int reserve(int descriptor, std::uint64_t offset, std::uint64_t size);
  [[nodiscard]] virtual int synchronise(int descriptor);
  [[nodiscard]] virtual int close(int descriptor);
  // Room on the file system of a path for this user; the largest value if it is unknown.
  [[nodiscard]] virtual std::uint64_t free_bytes(const std::filesystem::path& path);
};
[[nodiscard]] FileCalls& system_file_calls() noexcept;

class OutputFile {
 public:
  explicit OutputFile(FileCalls& calls = system_file_calls()) noexcept : calls_(calls) {}
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // Creates the file; one that exists is never touched. Errors: storage.
  [[nodiscard]] Status create(const std::filesystem::path& path);

  // Appends whole records. Errors: storage; the file then ends where it ended before.
  // room_behind: bytes that must have room behind the records; otherwise the records are not written. If the file
  // system cannot reserve space, its free space is used.
  [[nodiscard]] Status append(ByteSpan records, std::uint64_t room_behind = 0);

  // The same, followed by a Mark; the buffer grows by the Mark.
  [[nodiscard]] Status append_marked(Bytes& records);

  // Flushes to the disk and closes. Errors: storage.
  [[nodiscard]] Status close();

  [[nodiscard]] bool is_open() const noexcept { return descriptor_ >= 0; }
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  [[nodiscard]] std::uint32_t crc() const noexcept { return crc_; }
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  [[nodiscard]] Status write_all(ByteSpan bytes, std::uint32_t crc_after);
  [[nodiscard]] Status failed(int error, std::size_t bytes, std::uint64_t at);

  FileCalls& calls_;
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
  std::uint32_t crc_ = 0;
  bool has_reserved_ = false;
};

}  // namespace slew::recording
