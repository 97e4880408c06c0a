// SPDX-License-Identifier: Apache-2.0
// Whole numbers of 64 bits: CLI11 wraps the negative ones of unsigned options and takes numbers beyond 64 bits for the
// greatest one.
#pragma once

#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <limits>
#include <string>
#include <type_traits>

namespace slew::options {

// What is wrong with a number that is none of the type; empty: nothing, or no number at all, which CLI11 reports.
template <class Whole>
[[nodiscard]] std::string problem_of_whole(const std::string& text) {
  constexpr bool kIsUnsigned = std::is_unsigned_v<Whole>;
  errno = 0;
  char* end = nullptr;
  if constexpr (kIsUnsigned) {
    static_cast<void>(std::strtoull(text.c_str(), &end, 0));
  } else {
    static_cast<void>(std::strtoll(text.c_str(), &end, 0));
  }
  const bool is_beyond = errno == ERANGE || (kIsUnsigned && text.find('-') != std::string::npos);
  if (!is_beyond) return {};
  return fmt::format("'{}' is no whole number from {} to {}", text, std::numeric_limits<Whole>::min(),
                     std::numeric_limits<Whole>::max());
}

}  // namespace slew::options
