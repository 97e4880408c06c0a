// The recording reader: any file is read as far as it is sound, verified and recovered, or refused.
#include <sys/mman.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "recording/reader.h"
#include "recording/recovery.h"
#include "tests/fuzz/bytes.h"

namespace {

using namespace slew;

// A file in memory under a path.
class MemoryFile {
 public:
  MemoryFile() : fd_(memfd_create("recording", 0)) { fuzz::require(fd_ >= 0); }
  ~MemoryFile() { close(fd_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  void write(const std::uint8_t* data, std::size_t size) {
    fuzz::require(ftruncate(fd_, 0) == 0);
    fuzz::require(pwrite(fd_, data, size, 0) == static_cast<ssize_t>(size));
  }
  [[nodiscard]] std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(fd_); }

 private:
  int fd_;
};

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

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static MemoryFile file;
  static const std::filesystem::path recovered =
      std::filesystem::temp_directory_path() / ("slewring_fuzz_" + std::to_string(getpid()) + ".mcap");
  file.write(data, size);
  const std::uint64_t readable = read_all(file.path());
  recording::Recovery recovery;
  const Status status = recording::recover(file.path(), recovered, recovery);
  // what was recovered is whole, and has at least what could be read of the damaged file
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
