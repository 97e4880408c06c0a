// Counts heap allocations of the calling thread between construction and count(): proof of rule "no heap in a step".
//
// Link slewring_allocation_guard; it puts itself in front of malloc for the whole program.
#pragma once

#include <cstdint>

namespace slew {

class AllocationGuard {
 public:
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
