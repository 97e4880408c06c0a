// SPDX-License-Identifier: Apache-2.0
// The same bits wherever the subsystems lie in memory: every block of the heap is shifted by 16 bytes within the 32
// that vector instructions care about, and the sizes in front of them differ. (8 bytes would break what operator new
// promises; reductions of run-time size have their own test with 8 bytes in core.)
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>
#include <vector>

#include "support/crane_pair.h"

namespace {

constexpr std::size_t kLine = 32;
thread_local std::size_t shift = 0;  // 0 or 16

#ifndef SLEWRING_SANITIZED
// block: from malloc, aligned to 32, with the way back in front of what is handed out
void* shifted_or_null(std::size_t size) noexcept {
  char* block = static_cast<char*>(std::aligned_alloc(kLine, (size + 3 * kLine) / kLine * kLine + kLine));
  if (block == nullptr) return nullptr;
  char* given = block + kLine + shift;
  reinterpret_cast<void**>(given)[-1] = block;
  return given;
}

void* shifted(std::size_t size) {
  void* given = shifted_or_null(size);
  if (given == nullptr) throw std::bad_alloc();
  return given;
}

void give_back(void* given) noexcept {
  if (given != nullptr) std::free(static_cast<void**>(given)[-1]);
}

#endif

}  // namespace

// the sanitizers bring their own
#ifndef SLEWRING_SANITIZED
void* operator new(std::size_t size) {
  return shifted(size);
}
void* operator new[](std::size_t size) {
  return shifted(size);
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return shifted_or_null(size);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return shifted_or_null(size);
}
void operator delete(void* given) noexcept {
  give_back(given);
}
void operator delete[](void* given) noexcept {
  give_back(given);
}
void operator delete(void* given, std::size_t) noexcept {
  give_back(given);
}
void operator delete[](void* given, std::size_t) noexcept {
  give_back(given);
}
#endif

namespace slew::testing {
namespace {

std::vector<std::uint64_t> chain(std::size_t shift_of_run, std::size_t blocks_in_front) {
  shift = shift_of_run;
  std::vector<std::vector<char>> front;
  for (std::size_t i = 0; i < blocks_in_front; ++i) front.emplace_back(17 + 40 * i);
  std::vector<std::uint64_t> hashes;
  {
    const scene::Scene scene = CranePair::load();
    CranePair crane(scene);
    crane.start();
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(crane.mechanics->state().q.data()) % kLine, shift_of_run);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(crane.hydraulics->integrator().state().data()) % kLine, shift_of_run);
    for (int i = 0; i < 500; ++i) {
      if (i == 100) static_cast<void>(crane.mechanics->change_parameter(i, {"Bag.mass", 900, milliseconds(50)}));
      crane.step(CranePair::levers(crane.n));
      hashes.push_back(crane.mechanics->state_hash());
      hashes.push_back(crane.hydraulics->state_hash());
    }
  }
  shift = 0;
  return hashes;
}

TEST(SubsystemAddresses, DoNotEnterTheBits) {
#ifdef SLEWRING_SANITIZED
  GTEST_SKIP() << "the heap is the sanitizer's";
#endif
  const std::vector<std::uint64_t> straight = chain(0, 0);
  EXPECT_EQ(chain(16, 0), straight);
  EXPECT_EQ(chain(0, 7), straight);
  EXPECT_EQ(chain(16, 13), straight);
}

}  // namespace
}  // namespace slew::testing
