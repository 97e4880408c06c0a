// SPDX-License-Identifier: Apache-2.0
// Counts heap allocations of a thread, between construction and count(), or from its start: proof of rule "no heap in a
// step", in tests and in every node while it runs.
//
// Link slewring_allocation_guard; it puts itself in front of malloc for the whole program. Not under a sanitizer, which
// needs that place for itself: the guard then counts nothing.
#pragma once

#include <cstdint>

namespace slew {

// Allocations of the calling thread so far. Real-time safe.
[[nodiscard]] std::uint64_t thread_allocations() noexcept;

class AllocationGuard {
 public:
#ifdef SLEWRING_SANITIZED
  static constexpr bool kCounts = false;
#else
  static constexpr bool kCounts = true;
#endif

  AllocationGuard() noexcept;
  ~AllocationGuard();
  AllocationGuard(const AllocationGuard&) = delete;
  AllocationGuard& operator=(const AllocationGuard&) = delete;

  // Allocations (malloc, calloc, realloc, aligned forms, operator new) and frees since construction.
  [[nodiscard]] std::uint64_t allocations() const noexcept;
  [[nodiscard]] std::uint64_t frees() const noexcept;

 private:
  std::uint64_t allocations_at_start_;
  std::uint64_t frees_at_start_;
};

}  // namespace slew
