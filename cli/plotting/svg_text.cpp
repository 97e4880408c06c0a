#include "cli/plotting/svg_text.h"

#include <algorithm>

namespace slew::plotting {
namespace {

constexpr double kLetter = 7.3;  // mean width of a letter at 12 px in the widest of the fonts

}  // namespace

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
  }
  return out;
}

double text_width(std::string_view text) {
  // bytes that continue a character of UTF-8 take no room
  const auto letters = std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; });
  return kLetter * static_cast<double>(letters);
}

}  // namespace slew::plotting
