// SPDX-License-Identifier: Apache-2.0
// Sequence with inline storage and a fixed capacity: no heap in wire messages and step loops. A copy moves the
// elements, not the capacity.
#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>
#include <span>

#include "core/check.h"

namespace slew {

template <typename T, std::size_t Capacity>
class StaticVector {
 public:
  constexpr StaticVector() = default;
  constexpr StaticVector(std::initializer_list<T> values) {
    for (const T& value : values) push_back(value);
  }
  constexpr StaticVector(const StaticVector& other) noexcept { *this = other; }
  constexpr StaticVector& operator=(const StaticVector& other) noexcept {
    size_ = other.size_;
    for (std::size_t i = 0; i < size_; ++i) values_[i] = other.values_[i];
    return *this;
  }
  constexpr ~StaticVector() = default;

  [[nodiscard]] static constexpr std::size_t capacity() noexcept { return Capacity; }
  [[nodiscard]] constexpr std::size_t size() const noexcept { return size_; }
  [[nodiscard]] constexpr bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] constexpr T* data() noexcept { return values_.data(); }
  [[nodiscard]] constexpr const T* data() const noexcept { return values_.data(); }
  [[nodiscard]] constexpr T* begin() noexcept { return values_.data(); }
  [[nodiscard]] constexpr T* end() noexcept { return values_.data() + size_; }
  [[nodiscard]] constexpr const T* begin() const noexcept { return values_.data(); }
  [[nodiscard]] constexpr const T* end() const noexcept { return values_.data() + size_; }
  [[nodiscard]] constexpr T& operator[](std::size_t i) noexcept { return values_[i]; }
  [[nodiscard]] constexpr const T& operator[](std::size_t i) const noexcept { return values_[i]; }
  [[nodiscard]] constexpr T& back() noexcept { return values_[size_ - 1]; }
  [[nodiscard]] constexpr std::span<const T> span() const noexcept { return {values_.data(), size_}; }
  [[nodiscard]] constexpr std::span<T> span() noexcept { return {values_.data(), size_}; }

  constexpr void clear() noexcept { size_ = 0; }
  // New elements keep the old content of the storage; pre-condition: n <= Capacity.
  constexpr void resize(std::size_t n) noexcept {
    SLEW_CHECK(n <= Capacity);
    size_ = n;
  }
  constexpr void push_back(const T& value) noexcept {
    SLEW_CHECK(size_ < Capacity);
    values_[size_++] = value;
  }

  friend constexpr bool operator==(const StaticVector& a, const StaticVector& b) {
    if (a.size_ != b.size_) return false;
    for (std::size_t i = 0; i < a.size_; ++i) {
      if (!(a.values_[i] == b.values_[i])) return false;
    }
    return true;
  }

 private:
  std::array<T, Capacity> values_{};
  std::size_t size_ = 0;
};

}  // namespace slew
