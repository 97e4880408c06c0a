// SPDX-License-Identifier: Apache-2.0
#include "core/input_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace slew {
namespace {

std::string megabytes(std::size_t bytes) {
  return fmt::format("{:.1f} MB", static_cast<double>(bytes) * 1e-6);
}

InputFault too_large(std::size_t bytes, std::size_t most) {
  return {"is " + megabytes(bytes) + " large", "at most " + megabytes(most)};
}

InputFault unreadable(int error) {
  return {std::string("cannot be read: ") + std::strerror(error), ""};
}

class OpenFile {
 public:
  // a device is not even opened; without O_NONBLOCK a FIFO that took the file's place would wait for a writer
  explicit OpenFile(const std::filesystem::path& path) {
    bool is_there = ::stat(path.c_str(), &status_) == 0;
    if (is_there && S_ISREG(status_.st_mode)) {
      descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
      is_there = descriptor_ >= 0 && ::fstat(descriptor_, &status_) == 0;
    }
    if (!is_there) error_ = errno;
  }
  ~OpenFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  [[nodiscard]] std::optional<InputFault> fault(std::size_t most) const {
    if (error_ != 0) return unreadable(error_);
    if (S_ISDIR(status_.st_mode)) return InputFault{"is a directory", "a file"};
    if (!S_ISREG(status_.st_mode)) return InputFault{"is not a regular file", "a file"};
    if (size() > most) return too_large(size(), most);
    return std::nullopt;
  }
  [[nodiscard]] std::size_t size() const noexcept { return static_cast<std::size_t>(status_.st_size); }

  // Appends the content, up to one byte beyond `most`.
  [[nodiscard]] std::optional<InputFault> read_into(std::string& bytes, std::size_t most) const {
    constexpr std::size_t kBlock = 1u << 16;
    // one byte more than the file had, so that the end is found without growing
    bytes.resize(size() + 1);
    std::size_t filled = 0;
    while (filled <= most) {
      if (filled == bytes.size()) bytes.resize(filled + kBlock);
      const ssize_t count = ::read(descriptor_, bytes.data() + filled, bytes.size() - filled);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) return unreadable(errno);
      if (count == 0) break;
      filled += static_cast<std::size_t>(count);
    }
    if (filled > most) return too_large(filled, most);
    bytes.resize(filled);
    return std::nullopt;
  }

 private:
  int descriptor_ = -1;
  int error_ = 0;
  struct stat status_ = {};
};

}  // namespace

std::optional<InputFault> find_input_fault(const std::filesystem::path& path, std::size_t most) {
  return OpenFile(path).fault(most);
}

std::optional<InputFault> read_input(const std::filesystem::path& path, std::size_t most, std::string& bytes) {
  bytes.clear();
  const OpenFile file(path);
  std::optional<InputFault> fault = file.fault(most);
  if (!fault) fault = file.read_into(bytes, most);
  if (fault) bytes.clear();
  return fault;
}

}  // namespace slew
