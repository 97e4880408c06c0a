// SPDX-License-Identifier: Apache-2.0
#include "scene/expression_signs.h"

#include <cstddef>

namespace slew::scene {
namespace {

constexpr std::string_view kExpressionBegin = "${";
constexpr std::string_view kSigns = "{}[],:#";

}  // namespace

std::string without_signs(std::string_view text) {
  std::string result;
  std::size_t copied = 0;
  for (std::size_t begin = text.find(kExpressionBegin); begin != std::string_view::npos;
       begin = text.find(kExpressionBegin, copied)) {
    // an expression has no quotes and no second line
    const std::size_t stop = text.find_first_of("}\"'\n", begin);
    if (stop == std::string_view::npos || text[stop] != '}') {
      result += text.substr(copied, begin + kExpressionBegin.size() - copied);
      copied = begin + kExpressionBegin.size();
      continue;
    }
    result += text.substr(copied, begin - copied);
    for (const char c : text.substr(begin, stop + 1 - begin)) {
      const std::size_t sign = kSigns.find(c);
      if (sign == std::string_view::npos) {
        result += c;
      } else {
        result += kSignPlane;
        result += static_cast<char>(0x80 + sign);
      }
    }
    copied = stop + 1;
  }
  if (!result.empty()) result += text.substr(copied);
  return result;
}

void restore_signs(std::string& text) {
  std::size_t kept = 0;
  for (std::size_t at = 0; at < text.size(); ++kept) {
    const bool is_in_plane = text.compare(at, kSignPlane.size(), kSignPlane) == 0;
    const std::size_t sign =
        is_in_plane ? static_cast<unsigned char>(text[at + kSignPlane.size()]) - 0x80U : kSigns.size();
    if (sign < kSigns.size()) {
      text[kept] = kSigns[sign];
      at += kSignPlane.size() + 1;
    } else {
      text[kept] = text[at++];
    }
  }
  text.resize(kept);
}

}  // namespace slew::scene
