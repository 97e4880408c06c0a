// SPDX-License-Identifier: Apache-2.0
#include "core/allocation_guard.h"

#include <cerrno>
#include <cstddef>

#ifndef SLEWRING_SANITIZED
// glibc's own entry points behind malloc and its relatives
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);
}
#endif

namespace {
thread_local std::uint64_t allocation_count = 0;
thread_local std::uint64_t free_count = 0;
}  // namespace

#ifndef SLEWRING_SANITIZED
extern "C" {
void* malloc(std::size_t size) {
  ++allocation_count;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocation_count;
  return __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) {
  ++allocation_count;
  return __libc_realloc(block, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  ++allocation_count;
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocation_count;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  ++allocation_count;
  *block = __libc_memalign(alignment, size);
  return *block != nullptr ? 0 : ENOMEM;
}
void free(void* block) {
  ++free_count;
  __libc_free(block);
}
}
#endif

namespace slew {

std::uint64_t thread_allocations() noexcept {
  return allocation_count;
}

AllocationGuard::AllocationGuard() noexcept : allocations_at_start_(allocation_count), frees_at_start_(free_count) {}
AllocationGuard::~AllocationGuard() = default;

std::uint64_t AllocationGuard::allocations() const noexcept {
  return allocation_count - allocations_at_start_;
}
std::uint64_t AllocationGuard::frees() const noexcept {
  return free_count - frees_at_start_;
}

}  // namespace slew
