// SPDX-License-Identifier: Apache-2.0
#include "devices/dbc_tokens.h"

#include <array>

#include "core/printable.h"

namespace slew::devices {
namespace {

// Windows-1252, bytes 0x80 to 0x9F; 0: not in the set
constexpr std::array<std::uint16_t, 32> kWindows1252 = {0x20AC, 0,      0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021,
                                                        0x02C6, 0x2030, 0x0160, 0x2039, 0x0152, 0,      0x017D, 0,
                                                        0,      0x2018, 0x2019, 0x201C, 0x201D, 0x2022, 0x2013, 0x2014,
                                                        0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0,      0x017E, 0x0178};

bool is_word_begin(char c) {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_';
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_utf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t n = sequence_length(text, at);
    if (n == 0) return false;
    at += n;
  }
  return true;
}

void append_utf8(std::string& out, unsigned code) {
  if (code < 0x80) {
    out += static_cast<char>(code);
  } else if (code < 0x800) {
    out += static_cast<char>(0xC0 | (code >> 6));
    out += static_cast<char>(0x80 | (code & 0x3F));
  } else {
    out += static_cast<char>(0xE0 | (code >> 12));
    out += static_cast<char>(0x80 | ((code >> 6) & 0x3F));
    out += static_cast<char>(0x80 | (code & 0x3F));
  }
}

class Lexer {
 public:
  explicit Lexer(std::string_view text) : text_(text) {}

  std::vector<DbcToken> run() {
    for (;;) {
      skip_blanks();
      const std::size_t begin = at_;
      const bool begins_line = begin == 0 || text_[begin - 1] == '\n';
      const int line = line_;
      if (at_ == text_.size()) {
        tokens_.push_back({DbcTokenKind::end, "", line, true});
        return tokens_;
      }
      const DbcToken token = next();
      tokens_.push_back({token.kind, token.text, line, begins_line});
      if (token.kind == DbcTokenKind::broken) at_ = text_.size();
    }
  }

 private:
  [[nodiscard]] char peek(std::size_t ahead = 0) const {
    return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0';
  }

  void skip_blanks() {
    while (at_ < text_.size() && (peek() == ' ' || peek() == '\t' || peek() == '\r' || peek() == '\n')) {
      if (peek() == '\n') ++line_;
      ++at_;
    }
  }

  DbcToken next() {
    const std::size_t begin = at_;
    if (is_word_begin(peek())) {
      while (is_word_begin(peek()) || is_digit(peek())) ++at_;
      return {DbcTokenKind::word, text_.substr(begin, at_ - begin), 0, false};
    }
    const bool has_sign = (peek() == '+' || peek() == '-') && (is_digit(peek(1)) || peek(1) == '.');
    if (is_digit(peek()) || has_sign || (peek() == '.' && is_digit(peek(1)))) return number();
    if (peek() == '"') return quoted();
    ++at_;
    return {DbcTokenKind::sign, text_.substr(begin, 1), 0, false};
  }

  DbcToken number() {
    const std::size_t begin = at_;
    ++at_;
    while (is_digit(peek()) || peek() == '.') ++at_;
    const bool has_signed_power = (peek(1) == '+' || peek(1) == '-') && is_digit(peek(2));
    if ((peek() == 'e' || peek() == 'E') && (is_digit(peek(1)) || has_signed_power)) {
      at_ += 2;
      while (is_digit(peek())) ++at_;
    }
    return {DbcTokenKind::number, text_.substr(begin, at_ - begin), 0, false};
  }

  DbcToken quoted() {
    const std::size_t begin = ++at_;
    for (; at_ < text_.size() && peek() != '"'; ++at_) {
      if (peek() == '\\' && at_ + 1 < text_.size()) ++at_;
      if (peek() == '\n') ++line_;
    }
    if (at_ == text_.size()) return {DbcTokenKind::broken, "a text without its closing quote", 0, false};
    return {DbcTokenKind::text, text_.substr(begin, at_++ - begin), 0, false};
  }

  std::string_view text_;
  std::vector<DbcToken> tokens_;
  std::size_t at_ = 0;
  int line_ = 1;
};

}  // namespace

std::vector<DbcToken> dbc_tokens(std::string_view text) {
  return Lexer(text).run();
}

std::string dbc_text(std::string_view bytes) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (bytes.starts_with(kByteOrderMark)) bytes.remove_prefix(kByteOrderMark.size());
  if (is_utf8(bytes)) return std::string(bytes);
  std::string text;
  for (const char c : bytes) {
    const auto code = static_cast<unsigned char>(c);
    const unsigned special = code >= 0x80 && code < 0xA0 ? kWindows1252[code - 0x80U] : code;
    append_utf8(text, special == 0 ? '?' : special);
  }
  return text;
}

}  // namespace slew::devices
