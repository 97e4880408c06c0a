// SPDX-License-Identifier: Apache-2.0
#include "flex/text_lines.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <fstream>

#include "core/input_file.h"
#include "flex/input_error.h"

namespace slew::flex {

std::string read_text(const std::filesystem::path& file) {
  std::string text;
  const auto fault = read_input(file, kMaxAssetBytes, text);
  if (fault && fault->expected.empty())
    refuse_file(file, 0, "the file " + fault->what, "a file that is there", "check its name and rights");
  if (fault) refuse_file(file, 0, "this " + fault->what, fault->expected);
  return text;
}

void write_text(const std::filesystem::path& file, std::string_view text) {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  out.close();
  if (!out)
    throw OutputError(file.string() +
                      ": the file cannot be written; expected a folder that takes it; check rights and free space");
}

TextLines::TextLines(std::filesystem::path file) : file_(std::move(file)), text_(read_text(file_)) {}

bool TextLines::next() {
  if (at_ >= text_.size()) return false;
  const std::size_t end = std::min(text_.find('\n', at_), text_.size());
  line_ = std::string_view(text_).substr(at_, end - at_);
  if (!line_.empty() && line_.back() == '\r') line_.remove_suffix(1);
  at_ = end + 1;
  ++number_;
  return true;
}

std::vector<std::string_view> TextLines::words() const {
  constexpr std::string_view kBetween = " \t,;";
  std::vector<std::string_view> words;
  for (std::size_t at = line_.find_first_not_of(kBetween); at != std::string_view::npos;) {
    const std::size_t end = std::min(line_.find_first_of(kBetween, at), line_.size());
    words.push_back(line_.substr(at, end - at));
    at = line_.find_first_not_of(kBetween, end);
  }
  return words;
}

void TextLines::refuse(const std::string& what, const std::string& expected, const std::string& remedy) const {
  refuse_file(file_, number_, what, expected, remedy);
}

double TextLines::number_of(std::string_view word) const {
  double value = 0;
  const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size())
    refuse(fmt::format("'{}' is no number", word), "a number");
  if (!std::isfinite(value)) refuse(fmt::format("{} is not finite", word), "a finite number");
  return value;
}

long TextLines::whole_of(std::string_view word, long least) const {
  long value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size())
    refuse(fmt::format("'{}' is no whole number", word), "a whole number");
  if (value < least) refuse(fmt::format("{} is out of range", value), fmt::format("{} or more", least));
  return value;
}

}  // namespace slew::flex
