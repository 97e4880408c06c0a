// SPDX-License-Identifier: Apache-2.0
#include "recording/background_file.h"

#include <utility>

#include "recording/records.h"

namespace slew::recording {
namespace {

constexpr std::size_t kMostSpare = 4;  // blocks

}  // namespace

BackgroundFile::~BackgroundFile() {
  {
    const std::lock_guard lock(mutex_);
    is_closing_ = true;
  }
  wakes_thread_.notify_one();
  if (thread_.joinable()) thread_.join();
}

Status BackgroundFile::create(const std::filesystem::path& path) {
  const Status status = file_.create(path);
  if (status.is_ok() && most_ > 0) thread_ = std::thread([this] { run(); });
  return status;
}

// state after a failure: no block waits, and the size is that of the file
Status BackgroundFile::take_failure(std::unique_lock<std::mutex>&) {
  if (failure_.is_ok()) return failure_;
  size_ = file_.size();
  crc_ = file_.crc();
  return std::exchange(failure_, Status::ok());
}

Status BackgroundFile::append(ByteSpan records, std::uint64_t room_behind) {
  if (!thread_.joinable()) {
    const Status status = file_.append(records, room_behind);
    size_ = written_ = file_.size();
    crc_ = file_.crc();
    return status;
  }
  std::unique_lock lock(mutex_);
  wakes_owner_.wait(lock,
                    [&] { return !failure_.is_ok() || waiting_.empty() || waiting_bytes_ + records.size() <= most_; });
  if (const Status failed = take_failure(lock); !failed.is_ok()) return failed;
  Bytes block;
  if (!spare_.empty()) {
    block = std::move(spare_.back());
    spare_.pop_back();
  }
  block.assign(records.begin(), records.end());
  waiting_bytes_ += block.size();
  waiting_.push_back({std::move(block), room_behind});
  size_ += records.size();
  crc_ = crc32_of(records, crc_);
  lock.unlock();
  wakes_thread_.notify_one();
  return Status::ok();
}

Status BackgroundFile::append_marked(Bytes& records, std::uint64_t room_behind) {
  encode_mark(records, crc32_of(records, crc_));
  return append(records, room_behind);
}

Status BackgroundFile::drain() {
  std::unique_lock lock(mutex_);
  wakes_owner_.wait(lock, [&] { return !failure_.is_ok() || waiting_.empty(); });
  return take_failure(lock);
}

Status BackgroundFile::close() {
  if (!is_open()) return Status::ok();
  const Status drained = drain();
  {
    const std::lock_guard lock(mutex_);
    is_closing_ = true;
  }
  wakes_thread_.notify_one();
  if (thread_.joinable()) thread_.join();
  const Status closed = file_.close();
  return drained.is_ok() ? closed : drained;
}

std::size_t BackgroundFile::backlog() const {
  const std::lock_guard lock(mutex_);
  return waiting_bytes_;
}

std::uint64_t BackgroundFile::written() const {
  const std::lock_guard lock(mutex_);
  return written_;
}

void BackgroundFile::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    wakes_thread_.wait(lock, [this] { return is_closing_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const Block& block = waiting_.front();
    lock.unlock();
    Status status = file_.append(block.records, block.room_behind);
    lock.lock();
    if (status.is_ok()) {
      waiting_bytes_ -= block.records.size();
      if (spare_.size() < kMostSpare) spare_.push_back(std::move(waiting_.front().records));
      waiting_.pop_front();
    } else {
      failure_ = std::move(status);
      waiting_.clear();
      waiting_bytes_ = 0;
    }
    written_ = file_.size();
    wakes_owner_.notify_all();
  }
}

}  // namespace slew::recording
