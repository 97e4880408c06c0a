// SPDX-License-Identifier: Apache-2.0
#include "scene/number.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <optional>
#include <system_error>

namespace slew::scene {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool is_octal_digit(char c) {
  return c >= '0' && c <= '7';
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

std::string quoted(std::string_view text) {
  return fmt::format("'{}'", text);
}

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return result;
}

// [sign] digits [. digits] [e [sign] digits]
struct Extent {
  std::size_t sign = 0;      // length
  std::size_t integer = 0;   // digits before the point
  std::size_t fraction = 0;  // digits behind it
  std::size_t end = 0;       // behind the whole number
  bool has_point = false;
};

Extent measure(std::string_view text) {
  Extent extent;
  std::size_t i = 0;
  if (i < text.size() && (text[i] == '+' || text[i] == '-')) extent.sign = ++i;
  while (i < text.size() && is_digit(text[i])) ++i, ++extent.integer;
  if (i < text.size() && text[i] == '.' && (extent.integer > 0 || (i + 1 < text.size() && is_digit(text[i + 1])))) {
    extent.has_point = true;
    ++i;
    while (i < text.size() && is_digit(text[i])) ++i, ++extent.fraction;
  }
  if (extent.integer + extent.fraction == 0) return extent;
  extent.end = i;
  // an exponent needs a digit, else the letter belongs to the unit
  if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
    std::size_t j = i + 1;
    if (j < text.size() && (text[j] == '+' || text[j] == '-')) ++j;
    if (j < text.size() && is_digit(text[j])) {
      while (j < text.size() && is_digit(text[j])) ++j;
      extent.end = j;
    }
  }
  return extent;
}

// The value of at most 19 digits and a power of ten up to 27: both are exact in 64 bits of mantissa, so their product
// or quotient is the nearest long double, much faster than std::from_chars (Clinger 1990).
std::optional<long double> short_value(std::string_view text, const Extent& extent) {
  constexpr std::size_t kMostDigits = 19;
  constexpr int kMostPower = 27;
  static_assert(std::numeric_limits<long double>::digits >= 64);
  if (extent.integer + extent.fraction > kMostDigits) return std::nullopt;
  std::uint64_t digits = 0;
  std::size_t at = extent.sign;
  for (; at < extent.end && (is_digit(text[at]) || text[at] == '.'); ++at) {
    if (text[at] != '.') digits = digits * 10 + static_cast<std::uint64_t>(text[at] - '0');
  }
  int exponent = 0;
  if (at < extent.end) {
    const std::size_t first = text[at + 1] == '+' ? at + 2 : at + 1;
    const auto [end, error] = std::from_chars(text.data() + first, text.data() + extent.end, exponent);
    if (error != std::errc() || std::abs(exponent) > 1000) return std::nullopt;
  }
  exponent -= static_cast<int>(extent.fraction);
  if (std::abs(exponent) > kMostPower) return std::nullopt;
  long double power = 1;
  for (int i = 0; i < std::abs(exponent); ++i) power *= 10;
  const auto whole = static_cast<long double>(digits);
  const long double value = exponent < 0 ? whole / power : whole * power;
  return text[0] == '-' ? -value : value;
}

// The nearest long double may lie halfway between two doubles where the text does not. It moves by one bit to the
// text's side, so that a number without a unit becomes the nearest double.
long double without_false_tie(long double value, std::string_view number) {
  constexpr int kBits = std::numeric_limits<long double>::digits, kCut = kBits - std::numeric_limits<double>::digits;
  static_assert(kBits == 64);
  int exponent = 0;
  const auto mantissa = static_cast<std::uint64_t>(std::ldexp(std::frexp(std::fabs(value), &exponent), kBits));
  const bool is_tie = (mantissa & ((std::uint64_t{1} << kCut) - 1)) == std::uint64_t{1} << (kCut - 1);
  double nearest = 0;
  if (!is_tie || std::from_chars(number.data(), number.data() + number.size(), nearest).ec != std::errc()) return value;
  return static_cast<double>(value) == nearest ? value : std::nextafter(value, static_cast<long double>(nearest));
}

// 0x1F, 0o17, 0b101
bool find_base_problem(std::string_view text, NumberText& result) {
  const std::size_t sign = !text.empty() && (text[0] == '+' || text[0] == '-') ? 1 : 0;
  if (text.size() < sign + 3 || text[sign] != '0' || is_digit(text[sign + 1])) return false;
  const std::string digits = lower(text.substr(sign));
  if (digits.size() < 3 || digits[0] != '0') return false;
  const char letter = digits[1];
  const int base = letter == 'x' ? 16 : letter == 'o' ? 8 : letter == 'b' ? 2 : 0;
  if (base == 0) return false;
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data() + 2, digits.data() + digits.size(), value, base);
  if (end == digits.data() + 2) return false;
  const std::string_view name = base == 16 ? "hexadecimal" : base == 8 ? "octal" : "binary";
  const std::string_view minus = text[0] == '-' ? "-" : "";
  const bool is_whole = error == std::errc() && end == digits.data() + digits.size();
  result.problem.what = fmt::format("{} is {}", quoted(text), name);
  result.problem.expected = is_whole ? fmt::format("{}{}", minus, value) : "a decimal number";
  return true;
}

// 010 is 8 to YAML 1.1 and 10 to YAML 1.2
void set_leading_zero_problem(std::string_view text, const Extent& extent, NumberText& result) {
  const std::string_view number = text.substr(0, extent.end);
  std::string_view digits = text.substr(extent.sign, extent.integer);
  const std::string sign = extent.sign == 1 && text[0] == '-' ? "-" : "";
  const bool may_be_octal = std::all_of(digits.begin(), digits.end(), is_octal_digit) && !extent.has_point &&
                            extent.end == extent.sign + extent.integer;
  std::uint64_t octal = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), octal, 8);
  while (digits.size() > 1 && digits.front() == '0') digits.remove_prefix(1);
  const std::string decimal = sign + std::string(digits) + std::string(number.substr(extent.sign + extent.integer));
  if (may_be_octal) {
    const std::string as_octal = sign + std::to_string(octal);
    result.problem = {quoted(number) + " looks octal", "", ""};
    result.problem.expected = as_octal == decimal ? decimal : decimal + " or " + as_octal;
  } else {
    result.problem = {quoted(number) + " begins with a zero", decimal, ""};
  }
}

// Words and signs that resemble a number.
void set_text_problem(std::string_view text, NumberText& result) {
  const std::string word = lower(text);
  const std::string_view bare =
      std::string_view(word).substr(!word.empty() && (word[0] == '-' || word[0] == '+') ? 1 : 0);
  if (bare == ".nan" || bare == "nan" || bare == ".inf" || bare == "inf" || bare == "infinity") {
    result.problem = {quoted(text) + " is not finite", "a finite number", ""};
  } else if (text.starts_with("\xE2\x88\x92") || text.starts_with("\xE2\x80\x93")) {
    result.problem = {quoted(text) + " begins with a typographic minus sign", "'-'", ""};
  } else {
    result.problem = {quoted(text) + " is not a number", "", ""};
  }
}

}  // namespace

NumberText split_number(std::string_view text) {
  NumberText result;
  text = trimmed(text);
  if (find_base_problem(text, result)) return result;
  const Extent extent = measure(text);
  if (extent.end == 0) {
    set_text_problem(text, result);
    return result;
  }
  if (extent.integer > 1 && text[extent.sign] == '0') {
    set_leading_zero_problem(text, extent, result);
    return result;
  }
  const char next = extent.end < text.size() ? text[extent.end] : '\0';
  const bool digit_follows = extent.end + 1 < text.size() && is_digit(text[extent.end + 1]);
  if (next == ',' && digit_follows) {
    result.problem = {quoted(text) + " has a comma", "a decimal point", ""};
    return result;
  }
  if (next == '_' || next == '\'') {
    result.problem = {quoted(text) + " has a digit separator", "digits only", ""};
    return result;
  }
  // from_chars takes no plus sign
  const std::size_t begin = text[0] == '+' ? 1 : 0;
  const std::string_view number = text.substr(begin, extent.end - begin);
  if (const auto value = short_value(text, extent)) {
    result.value = without_false_tie(*value, number);
    result.is_number = true;
    result.rest = trimmed(text.substr(extent.end));
    return result;
  }
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), result.value);
  const bool is_huge = std::isinf(static_cast<double>(result.value));
  if (error != std::errc() || is_huge || end != text.data() + extent.end) {
    result.problem = {quoted(text.substr(0, extent.end)) + " is beyond what a number can hold", "a finite number", ""};
    return result;
  }
  result.value = without_false_tie(result.value, number);
  result.is_number = true;
  result.rest = trimmed(text.substr(extent.end));
  return result;
}

}  // namespace slew::scene
