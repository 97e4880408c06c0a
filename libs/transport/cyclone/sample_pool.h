// Memory of the samples of one topic, which several threads take and give back while the session runs.
//
// The first sample of a size brings room for as many as the topic keeps, in one piece; that is before the first step.
// What was given back is taken again, so that a steady session asks the heap for nothing. Beyond that room a sample has
// memory of its own, which stays in the pool too. Who holds the lock inherits the priority of who waits for it.
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
  // room: samples of one size that are kept at hand, as far as kMostBytes goes
  [[nodiscard]] static SamplePool* create(std::size_t room) { return new SamplePool(room); }
  // At least `bytes` of memory, aligned to 16. Throws std::bad_alloc.
  [[nodiscard]] void* take(std::size_t bytes);
  static void give_back(void* memory) noexcept;
  // Instead of delete: nothing is taken any more.
  void close() noexcept;

  SamplePool(const SamplePool&) = delete;
  SamplePool& operator=(const SamplePool&) = delete;

 private:
  static constexpr std::size_t kSizes = 8;              // 256 bytes, doubled up to 32 KiB
  static constexpr std::size_t kSmallest = 256;         // bytes of a block, its head included
  static constexpr std::size_t kMostBytes = 2'097'152;  // of room for one size
  enum class Origin : std::uint8_t { room, own, too_large };
  struct alignas(16) Block {
    SamplePool* pool;
    Block* next;  // of those that were given back
    std::uint8_t size;
    Origin origin;
  };
  struct Size {
    Block* free = nullptr;
    std::byte* unused = nullptr;  // of the room
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
