// SHA-256 of a file's bytes: assets are told apart by it.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace slew::scene {

using Sha256 = std::array<std::uint8_t, 32>;

class Sha256Stream {
 public:
  Sha256Stream() noexcept;
  void add(std::span<const std::uint8_t> bytes) noexcept;
  [[nodiscard]] Sha256 finish() noexcept;  // once, at the end

 private:
  void compress(const std::uint8_t* block) noexcept;

  std::array<std::uint32_t, 8> state_;
  std::array<std::uint8_t, 64> buffer_{};
  std::uint64_t length_ = 0;  // bytes so far
};

}  // namespace slew::scene
