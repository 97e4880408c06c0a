// One file of a flexible set: its form, and a reader that keeps to it.
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
  std::string units;        // by column, of several kinds of rows in the order of the names
  std::string names;        // of the columns, for the reader's eye
};

[[nodiscard]] TableForm form_of(const std::string& what, std::size_t modes);

// Whose files these are: the row `files` of Source.
struct FileOwner {
  std::string model, prefix;
  // Another pair whose files have the same names.
  [[nodiscard]] bool shadows(const std::string& its_model, const std::string& its_prefix) const {
    return model != its_model && model + '_' + prefix == its_model + '_' + its_prefix;
  }
};

// Empty where Source has no such row. Throws InputError when the file is no Source of this format.
[[nodiscard]] std::optional<FileOwner> owner_of(const std::filesystem::path& source);

// Reads row after row; throws InputError at the first that is not as the header or the form say.
class FlexibleTable {
 public:
  explicit FlexibleTable(const std::filesystem::path& file, const std::string& what);

  [[nodiscard]] const std::string& set() const noexcept { return set_; }
  [[nodiscard]] std::size_t rows() const noexcept { return rows_; }
  [[nodiscard]] std::size_t columns() const noexcept { return columns_; }
  // Counts of the header against what the other files ask for.
  void expect_rows(std::size_t rows, const std::string& because) const;
  void expect_columns(std::size_t columns, const std::string& because) const;

  // Words of the next row.
  [[nodiscard]] const std::vector<std::string_view>& next();
  [[nodiscard]] std::string_view line() const noexcept { return lines_.line(); }
  // Throws when there is another row.
  void end();
  [[nodiscard]] const TextLines& at() const noexcept { return lines_; }
  [[nodiscard]] double number(std::size_t column) const { return lines_.number_of(words_[column]); }
  // A counted number that must be this one.
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
