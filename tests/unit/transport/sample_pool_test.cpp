// SPDX-License-Identifier: Apache-2.0
#include "transport/sample_pool.h"

#include <gtest/gtest.h>

#include <cstring>
#include <set>
#include <thread>
#include <vector>

#include "core/allocation_guard.h"

namespace slew::transport {
namespace sample_pool_test {

class Pool : public ::testing::Test {
 protected:
  static constexpr std::size_t kRoom = 100, kBytes = 500;
  ~Pool() override { pool_->close(); }

  std::vector<void*> take(std::size_t count) {
    std::vector<void*> taken;
    taken.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      taken.push_back(pool_->take(kBytes));
      std::memset(taken.back(), static_cast<int>(i), kBytes);
    }
    return taken;
  }
  static void give_back(const std::vector<void*>& taken) {
    for (void* memory : taken) SamplePool::give_back(memory);
  }

  SamplePool* pool_ = SamplePool::create(kRoom);
};

TEST_F(Pool, AllocatesOnceForTheKeptSamples) {
  if (!AllocationGuard::kCounts) GTEST_SKIP() << "a sanitizer is in front of malloc";
  std::vector<void*> taken;
  taken.reserve(kRoom);
  const AllocationGuard guard;
  for (std::size_t i = 0; i < kRoom; ++i) taken.push_back(pool_->take(kBytes));
  EXPECT_EQ(guard.allocations(), 1u);
  give_back(taken);
  for (int round = 0; round < 3; ++round) {
    for (std::size_t i = 0; i < kRoom; ++i) taken[i] = pool_->take(kBytes - i % 10);
    give_back(taken);
  }
  EXPECT_EQ(guard.allocations(), 1u);
  EXPECT_EQ(guard.frees(), 0u);
}

TEST_F(Pool, KeepsWhatWasTakenBeyondItsRoom) {
  if (!AllocationGuard::kCounts) GTEST_SKIP() << "a sanitizer is in front of malloc";
  give_back(take(kRoom + 7));
  const AllocationGuard guard;
  std::vector<void*> taken = take(kRoom + 7);
  EXPECT_EQ(guard.allocations(), 1u) << "but for the test's own list";
  give_back(taken);
}

TEST_F(Pool, GivesEveryUserMemoryOfItsOwn) {
  const std::vector<void*> taken = take(kRoom + 20);
  EXPECT_EQ(std::set<void*>(taken.begin(), taken.end()).size(), taken.size());
  for (std::size_t i = 0; i < taken.size(); ++i) {
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(taken[i]) % 16, 0u);
    const auto* bytes = static_cast<const unsigned char*>(taken[i]);
    EXPECT_EQ(bytes[0], i % 256);
    EXPECT_EQ(bytes[kBytes - 1], i % 256);
  }
  give_back(taken);
}

TEST_F(Pool, TakesEverySizeAlsoThoseWithoutAList) {
  std::vector<void*> taken;
  for (std::size_t bytes : {0u, 1u, 224u, 225u, 4096u, 32'768u, 1'000'000u, 9'000'000u}) {
    taken.push_back(pool_->take(bytes));
    std::memset(taken.back(), 1, bytes);
  }
  give_back(taken);
}

TEST(ClosedPool, GoesWithItsLastSample) {
  SamplePool* pool = SamplePool::create(2);
  void* first = pool->take(10);
  void* second = pool->take(10'000'000);
  void* third = pool->take(300);
  pool->close();
  std::memset(first, 1, 10);
  for (void* memory : {first, second, third}) SamplePool::give_back(memory);  // a leak would end the sanitizer's run
}

TEST(SharedPool, GoesFromThreadToThread) {
  SamplePool* pool = SamplePool::create(16);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([pool, t] {
      std::vector<unsigned char*> mine;
      for (int i = 0; i < 2000; ++i) {
        auto* memory = static_cast<unsigned char*>(pool->take(200 + static_cast<std::size_t>(i % 3) * 200));
        std::memset(memory, t, 200);
        mine.push_back(memory);
        if (mine.size() < 12) continue;
        for (unsigned char* one : mine) {
          EXPECT_EQ(one[0], t);
          EXPECT_EQ(one[199], t);
          SamplePool::give_back(one);
        }
        mine.clear();
      }
      for (unsigned char* one : mine) SamplePool::give_back(one);
    });
  }
  for (std::thread& thread : threads) thread.join();
  pool->close();
}

}  // namespace sample_pool_test
}  // namespace slew::transport
