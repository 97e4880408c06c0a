// SPDX-License-Identifier: Apache-2.0
// One file of a flexible set: its format, and a strict reader.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "flex/text_lines.h"

namespace slew::flex {

inline constexpr std::string_view kFormatName = "slewring-flexible";
inline constexpr int kFormatVersion = 2;

struct TableForm {
  std::string what;
  std::size_t columns = 0;  // 0: text after a key
  std::string units;        // by column; several kinds of rows in the order of the names
  std::string names;        // names of the columns, for readers
};

[[nodiscard]] TableForm form_of(const std::string& what, std::size_t modes);

// Owner of the files: the row `files` of Source.
struct FileOwner {
  std::string model, prefix;
  // Another pair whose files have the same names.
  [[nodiscard]] bool shadows(const std::string& its_model, const std::string& its_prefix) const {
    return model != its_model && model + '_' + prefix == its_model + '_' + its_prefix;
  }
};

// Empty if Source lacks the row. Throws InputError if the file is no Source of this format.
[[nodiscard]] std::optional<FileOwner> owner_of(const std::filesystem::path& source);

// Reads row after row; throws InputError at the first that violates the header or the format.
class FlexibleTable {
 public:
  explicit FlexibleTable(const std::filesystem::path& file, const std::string& what);

  [[nodiscard]] const std::string& set() const noexcept { return set_; }
  [[nodiscard]] std::size_t rows() const noexcept { return rows_; }
  [[nodiscard]] std::size_t columns() const noexcept { return columns_; }
  // Checks the counts of the header against those of the other files.
  void expect_rows(std::size_t rows, const std::string& because) const;
  void expect_columns(std::size_t columns, const std::string& because) const;

  // Words of the next row.
  [[nodiscard]] const std::vector<std::string_view>& next();
  [[nodiscard]] std::string_view line() const noexcept { return lines_.line(); }
  // Throws if another row follows.
  void end();
  [[nodiscard]] const TextLines& at() const noexcept { return lines_; }
  [[nodiscard]] double number(std::size_t column) const { return lines_.number_of(words_[column]); }
  // Reads a counted number that must have this value.
  void expect_whole(std::size_t column, long value, const char* what) const;
  void expect_word(std::size_t column, std::string_view word) const;

 private:
  [[nodiscard]] bool next_row();
  TextLines lines_;
  std::string what_, set_;
  std::size_t rows_ = 0, columns_ = 0, taken_ = 0;
  std::vector<std::string_view> words_;
};

}  // namespace slew::flex
