// SPDX-License-Identifier: Apache-2.0
// The recording reader: any file is read as far as it is sound, verified and recovered, or refused.
//
// Most changes break a check sum, and the reader goes no further. So three of four changed inputs get the right sums of
// marks, attachments and uncompressed chunks again, which lets them through to what lies behind.
#include "recording/reader.h"
#include "recording/records.h"
#include "recording/recovery.h"
#include "tests/fuzz/memory_file.h"

namespace {

using namespace slew;

std::uint64_t read_all(const std::filesystem::path& path) {
  std::unique_ptr<recording::Reader> reader;
  if (!recording::Reader::open(path, reader).is_ok()) return 0;
  std::uint64_t messages = 0;
  static_cast<void>(reader->for_each({}, [&](const recording::RecordedMessage& message) {
    ++messages;
    fuzz::require(message.channel != nullptr);
    return recording::Reader::Visit::go_on;
  }));
  for (const auto& attachment : reader->attachments()) {
    recording::Bytes content;
    static_cast<void>(reader->read_attachment(attachment.name, content));
  }
  static_cast<void>(reader->verify());
  static_cast<void>(reader->damage_text());
  return messages;
}

template <typename T>
T number_at(const std::uint8_t* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

std::uint32_t sum_of(const std::uint8_t* data, std::size_t size) {
  return recording::crc32_of({reinterpret_cast<const std::byte*>(data), size});
}

void put_sum(std::uint8_t* at, std::uint32_t sum) {
  std::memcpy(at, &sum, sizeof sum);
}

// Layouts as in docs/recording-format.md and the MCAP specification.
void repair_sums(std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kSum = sizeof(std::uint32_t), kChunkHead = 40;
  std::size_t at = recording::kMagic.size();
  while (at + recording::kRecordHeadBytes <= size) {
    const auto opcode = static_cast<recording::Opcode>(data[at]);
    const auto length = number_at<std::uint64_t>(data + at + 1);
    std::uint8_t* const content = data + at + recording::kRecordHeadBytes;
    if (length > size - at - recording::kRecordHeadBytes) return;
    const auto bytes = static_cast<std::size_t>(length);
    if (opcode == recording::Opcode::mark && bytes == kSum) {
      put_sum(content, sum_of(data, at));
    } else if (opcode == recording::Opcode::attachment && bytes > kSum) {
      put_sum(content + bytes - kSum, sum_of(content, bytes - kSum));
    } else if (opcode == recording::Opcode::chunk && bytes >= kChunkHead &&
               number_at<std::uint32_t>(content + 28) == 0) {
      put_sum(content + 24, sum_of(content + kChunkHead, bytes - kChunkHead));
    }
    at += recording::kRecordHeadBytes + bytes;
  }
}

}  // namespace

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  const std::size_t changed = LLVMFuzzerMutate(data, size, max_size);
  if (seed % 4 != 0) repair_sums(data, changed);
  return changed;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::MemoryFile file;
  static const std::filesystem::path recovered = fuzz::written_file(".mcap");
  file.write(data, size);
  const std::uint64_t readable = read_all(file.path());
  recording::Recovery recovery;
  const Status status = recording::recover(file.path(), recovered, recovery);
  // the recovered file is whole, and has at least the readable messages of the damaged file
  if (status.is_ok() && !recovery.was_whole) {
    std::unique_ptr<recording::Reader> reader;
    fuzz::require(recording::Reader::open(recovered, reader).is_ok());
    fuzz::require(reader->verify().is_ok());
    fuzz::require(recovery.messages >= readable);
  }
  std::error_code ignored;
  std::filesystem::remove(recovered, ignored);
  return 0;
}
