// SPDX-License-Identifier: Apache-2.0
#include "transport/sample_pool.h"

#include <algorithm>
#include <cstdlib>
#include <new>

namespace slew::transport {
namespace {

class Lock {
 public:
  explicit Lock(pthread_mutex_t& mutex) noexcept : mutex_(mutex) { pthread_mutex_lock(&mutex_); }
  ~Lock() { pthread_mutex_unlock(&mutex_); }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

 private:
  pthread_mutex_t& mutex_;
};

void* from_heap(std::size_t bytes) {
  void* memory = std::malloc(bytes);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

SamplePool::SamplePool(std::size_t room) : room_(room) {
  pthread_mutexattr_t attributes;
  pthread_mutexattr_init(&attributes);
  pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
  pthread_mutex_init(&mutex_, &attributes);
  pthread_mutexattr_destroy(&attributes);
  rooms_.reserve(kSizes);
}

SamplePool::~SamplePool() {
  for (const Size& size : sizes_) {
    for (Block* block = size.free; block != nullptr;) {
      Block* next = block->next;
      if (block->origin == Origin::own) std::free(block);
      block = next;
    }
  }
  for (void* room : rooms_) std::free(room);
  pthread_mutex_destroy(&mutex_);
}

// Under the lock.
SamplePool::Block* SamplePool::block_of(std::size_t size) {
  Size& of_size = sizes_[size];
  const std::size_t bytes = kSmallest << size;
  if (!of_size.has_room) {
    const std::size_t room = std::min(room_, kMostBytes / bytes) * bytes;
    of_size.unused = static_cast<std::byte*>(from_heap(room));
    of_size.end = of_size.unused + room;
    of_size.has_room = true;
    rooms_.push_back(of_size.unused);
  }
  if (of_size.free != nullptr) {
    Block* block = of_size.free;
    of_size.free = block->next;
    return block;
  }
  if (of_size.unused == of_size.end) {
    return new (from_heap(bytes)) Block{this, nullptr, static_cast<std::uint8_t>(size), Origin::own};
  }
  Block* block = new (of_size.unused) Block{this, nullptr, static_cast<std::uint8_t>(size), Origin::room};
  of_size.unused += bytes;
  return block;
}

void* SamplePool::take(std::size_t bytes) {
  const std::size_t whole = bytes + sizeof(Block);
  std::size_t size = 0;
  while (size < kSizes && (kSmallest << size) < whole) ++size;
  const Lock lock(mutex_);
  Block* block =
      size < kSizes ? block_of(size) : new (from_heap(whole)) Block{this, nullptr, kSizes, Origin::too_large};
  ++taken_;
  return block + 1;
}

void SamplePool::give_back(void* memory) noexcept {
  Block* block = static_cast<Block*>(memory) - 1;
  SamplePool* pool = block->pool;
  bool is_last = false;
  {
    const Lock lock(pool->mutex_);
    if (block->origin != Origin::too_large) {
      Size& of_size = pool->sizes_[block->size];
      block->next = of_size.free;
      of_size.free = block;
    }
    is_last = --pool->taken_ == 0 && pool->is_closed_;
  }
  if (block->origin == Origin::too_large) std::free(block);
  if (is_last) delete pool;
}

void SamplePool::close() noexcept {
  bool is_last = false;
  {
    const Lock lock(mutex_);
    is_closed_ = true;
    is_last = taken_ == 0;
  }
  if (is_last) delete this;
}

}  // namespace slew::transport
