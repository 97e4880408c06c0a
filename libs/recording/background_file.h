// The file that a recording is written to, by a thread of its own: a slow disk holds up the writing, not whoever
// records.
//
// Takes whole records like OutputFile and tells size and checksum as if they were written. What waits is bounded: a
// block that does not fit makes append() wait until it does. After a failed write nothing that waited is written; the
// next call tells, and size and checksum are those of the file again.
// With a backlog of 0 there is no thread and every call writes at once.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <thread>
#include <vector>

#include "recording/output_file.h"

namespace slew::recording {

class BackgroundFile {
 public:
  // backlog: most bytes that wait; 0: none
  BackgroundFile(FileCalls& calls, std::size_t backlog) : file_(calls), most_(backlog) {}
  ~BackgroundFile();
  BackgroundFile(const BackgroundFile&) = delete;
  BackgroundFile& operator=(const BackgroundFile&) = delete;

  // As of OutputFile. append_marked lets the buffer grow by the Mark.
  [[nodiscard]] Status create(const std::filesystem::path& path);
  [[nodiscard]] Status append(ByteSpan records, std::uint64_t room_behind = 0);
  [[nodiscard]] Status append_marked(Bytes& records, std::uint64_t room_behind = 0);
  // Waits until everything is written. Errors: storage, the first failure since the last call that told one.
  [[nodiscard]] Status drain();
  [[nodiscard]] Status close();

  [[nodiscard]] bool is_open() const noexcept { return file_.is_open(); }
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  [[nodiscard]] std::uint32_t crc() const noexcept { return crc_; }
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return file_.path(); }
  // Bytes that wait, and bytes of the file that are written.
  [[nodiscard]] std::size_t backlog() const;
  [[nodiscard]] std::uint64_t written() const;

 private:
  void run();
  [[nodiscard]] Status take_failure(std::unique_lock<std::mutex>& lock);

  OutputFile file_;  // of the thread while blocks wait
  std::size_t most_;
  std::uint64_t size_ = 0;
  std::uint32_t crc_ = 0;

  mutable std::mutex mutex_;
  std::condition_variable wakes_thread_;
  std::condition_variable wakes_owner_;
  struct Block {
    Bytes records;
    std::uint64_t room_behind = 0;
  };
  std::deque<Block> waiting_;  // the first one is being written
  std::vector<Bytes> spare_;   // written blocks, whose memory is used again
  std::size_t waiting_bytes_ = 0;
  std::uint64_t written_ = 0;
  Status failure_;
  bool is_closing_ = false;
  std::thread thread_;
};

}  // namespace slew::recording
