// SPDX-License-Identifier: Apache-2.0
// The file of a recording, written by a thread of its own: a slow disk delays the writing thread, not the recorder.
//
// Takes whole records like OutputFile and returns size and checksum as if they were written. The backlog is bounded:
// append() waits until its block fits. After a failed write the waiting blocks are dropped; the next call reports the
// failure, and size and checksum are those of the file again. With a backlog of 0 there is no thread and every call
// writes at once.
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

  // As in OutputFile. append_marked extends the buffer by the Mark.
  [[nodiscard]] Status create(const std::filesystem::path& path);
  [[nodiscard]] Status append(ByteSpan records, std::uint64_t room_behind = 0);
  [[nodiscard]] Status append_marked(Bytes& records, std::uint64_t room_behind = 0);
  // Waits until everything is written. Errors: storage, the first failure since the last reported one.
  [[nodiscard]] Status drain();
  [[nodiscard]] Status close();

  [[nodiscard]] bool is_open() const noexcept { return file_.is_open(); }
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  [[nodiscard]] std::uint32_t crc() const noexcept { return crc_; }
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return file_.path(); }
  // Waiting bytes, and written bytes of the file.
  [[nodiscard]] std::size_t backlog() const;
  [[nodiscard]] std::uint64_t written() const;

 private:
  void run();
  [[nodiscard]] Status take_failure(std::unique_lock<std::mutex>& lock);

  OutputFile file_;  // owned by the thread while blocks wait
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
