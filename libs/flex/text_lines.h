// SPDX-License-Identifier: Apache-2.0
// Text files read line by line, word by word, with errors that name the line.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace slew::flex {

// The whole file. Throws InputError when it cannot be read.
[[nodiscard]] std::string read_text(const std::filesystem::path& file);
// Throws OutputError when it cannot be written whole.
void write_text(const std::filesystem::path& file, std::string_view text);

class TextLines {
 public:
  explicit TextLines(std::filesystem::path file);

  // The next line without its end; false after the last one.
  [[nodiscard]] bool next();
  [[nodiscard]] std::string_view line() const noexcept { return line_; }
  [[nodiscard]] std::size_t number() const noexcept { return number_; }  // counted from 1
  [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }
  // True if the file's last line has its end; rarely true for a cut file.
  [[nodiscard]] bool is_ended() const noexcept { return text_.empty() || text_.back() == '\n'; }
  // Words of the line between white space, commas and semicolons.
  [[nodiscard]] std::vector<std::string_view> words() const;

  // Throws InputError at the present line.
  [[noreturn]] void refuse(const std::string& what, const std::string& expected, const std::string& remedy = {}) const;
  // The word as a finite number, as a whole number of at least `least`. Throws InputError otherwise.
  [[nodiscard]] double number_of(std::string_view word) const;
  [[nodiscard]] long whole_of(std::string_view word, long least) const;

 private:
  std::filesystem::path file_;
  std::string text_;
  std::string_view line_;
  std::size_t at_ = 0, number_ = 0;
};

}  // namespace slew::flex
