// SPDX-License-Identifier: Apache-2.0
#include "plotting/svg_text.h"

#include <algorithm>

namespace slew::plotting {
namespace {

constexpr double kLetter = 7.3;  // mean width of a letter at 12 px in the widest of the fonts

}  // namespace

double text_width(std::string_view text) {
  // bytes that continue a character of UTF-8 take no room
  const auto letters = std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; });
  return kLetter * static_cast<double>(letters);
}

}  // namespace slew::plotting
