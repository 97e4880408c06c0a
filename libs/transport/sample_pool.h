// SPDX-License-Identifier: Apache-2.0
// Memory of the samples of one topic, which several threads take and give back while the session runs.
//
// The first sample of a size reserves room for as many samples as the topic keeps, in one piece, before the first step.
// Returned memory is reused, so that a steady session allocates nothing. Beyond that room a sample has memory of its
// own, which stays in the pool too. The holder of the lock inherits the priority of a waiting thread.
//
// A sample may outlive its topic: the pool goes with the last one after close().
#pragma once

#include <pthread.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace slew::transport {

class SamplePool {
 public:
  // room: number of samples of one size for which memory is reserved, up to kMostBytes
  [[nodiscard]] static SamplePool* create(std::size_t room) { return new SamplePool(room); }
  // At least `bytes` of memory, aligned to 16. Throws std::bad_alloc.
  [[nodiscard]] void* take(std::size_t bytes);
  static void give_back(void* memory) noexcept;
  // Replaces delete: no sample is taken any more.
  void close() noexcept;

  SamplePool(const SamplePool&) = delete;
  SamplePool& operator=(const SamplePool&) = delete;

 private:
  static constexpr std::size_t kSizes = 8;              // 256 bytes, doubled up to 32 KiB
  static constexpr std::size_t kSmallest = 256;         // bytes of a block, its head included
  static constexpr std::size_t kMostBytes = 2'097'152;  // bytes of room for one size
  enum class Origin : std::uint8_t { room, own, too_large };
  struct alignas(16) Block {
    SamplePool* pool;
    Block* next;  // next returned block
    std::uint8_t size;
    Origin origin;
  };
  struct Size {
    Block* free = nullptr;
    std::byte* unused = nullptr;  // unused part of the room
    std::byte* end = nullptr;
    bool has_room = false;
  };

  explicit SamplePool(std::size_t room);
  ~SamplePool();
  [[nodiscard]] Block* block_of(std::size_t size);

  std::size_t room_;
  pthread_mutex_t mutex_{};
  std::array<Size, kSizes> sizes_{};
  std::vector<void*> rooms_;
  std::size_t taken_ = 0;
  bool is_closed_ = false;
};

}  // namespace slew::transport
