// SPDX-License-Identifier: Apache-2.0
#include "flex/flexible_table.h"

#include <fmt/format.h>

#include "flex/input_error.h"

namespace slew::flex {
namespace {

// value behind key= in the header's word
std::string_view value_of(const TextLines& lines, const std::vector<std::string_view>& words, std::size_t i,
                          std::string_view key) {
  if (i < words.size() && words[i].size() > key.size() && words[i].starts_with(key)) return words[i].substr(key.size());
  lines.refuse(fmt::format("the header has no {}", key),
               fmt::format("{} {} Matrix rows=.. columns=.. set=.. units=..", kFormatName, kFormatVersion),
               "write the set again");
}

}  // namespace

TableForm form_of(const std::string& what, std::size_t modes) {
  if (what == "Source") return {what, 0, "-", "key value"};
  if (what == "Nodes") return {what, 4, "1 m m m", "id x y z"};
  if (what == "Frequencies") return {what, 2, "1 rad/s", "mode omega"};
  if (what == "Modes")
    return {what, 8, "1 1 kg^-1/2 kg^-1/2 kg^-1/2 rad/m/kg^1/2 rad/m/kg^1/2 rad/m/kg^1/2",
            "node mode phi_x phi_y phi_z psi_x psi_y psi_z"};
  if (what == "Inertia")
    return {what, 12, "mass:kg s0:kg.m W0:kg.m2 C:kg^1/2 Z:m.kg^1/2 Y:1",
            "what k l xx xy xz yx yy yz zx zy zz (vectors: x y z and zeros)"};
  if (what == "Stiffness") return {what, modes, "1/s2", "modes by modes"};
  if (what == "Foreshortening")
    return {what, 13, "G:1/m H:1 g:1/kg/m", "what node k l xx xy xz yx yy yz zx zy zz (vectors: x y z and zeros)"};
  if (what == "Elements")
    return {what, 15, "1 1 1 N N.m2 N.m2 N.m2 N N kg/m kg.m kg.m 1 1 1",
            "element node1 node2 EA GJ EIy EIz kGAy kGAz rhoA rhoIy rhoIz y_x y_y y_z (kGA 0: rigid in shear)"};
  return {what, 5 + 2 * modes, "1 1 m m 1 Pa/m/kg^1/2", "element node y z has_shear, normal by mode, shear by mode"};
}

std::optional<FileOwner> owner_of(const std::filesystem::path& source) {
  FlexibleTable table(source, "Source");
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const auto& words = table.next();
    if (words.size() == 3 && words[0] == "files") return FileOwner{std::string(words[1]), std::string(words[2])};
  }
  return std::nullopt;
}

FlexibleTable::FlexibleTable(const std::filesystem::path& file, const std::string& what) : lines_(file), what_(what) {
  if (!lines_.next())
    refuse_file(file, 0, "the file is empty", fmt::format("a header that begins with {}", kFormatName));
  // units may hold commas and semicolons, which words() would take out: nothing behind set= is read
  const auto words = lines_.words();
  if (words.size() < 3 || words[0] != kFormatName)
    lines_.refuse(fmt::format("the first line is '{}'", lines_.line().substr(0, 60)),
                  fmt::format("a header that begins with {} {}", kFormatName, kFormatVersion),
                  "is it a flexible file?");
  if (lines_.whole_of(words[1], 0) != kFormatVersion)
    lines_.refuse(fmt::format("the format has version {}", words[1]), std::to_string(kFormatVersion),
                  "write the set again with this release");
  if (words[2] != what) lines_.refuse(fmt::format("the file holds {}", words[2]), what, "it may have been renamed");
  rows_ = static_cast<std::size_t>(lines_.whole_of(value_of(lines_, words, 3, "rows="), 0));
  columns_ = static_cast<std::size_t>(lines_.whole_of(value_of(lines_, words, 4, "columns="), 0));
  set_ = value_of(lines_, words, 5, "set=");
}

void FlexibleTable::expect_rows(std::size_t rows, const std::string& because) const {
  if (rows_ != rows)
    refuse_file(lines_.file(), 1, fmt::format("the header states {} rows", rows_), fmt::format("{}, {}", rows, because),
                "the files do not belong together; write the set again");
}

void FlexibleTable::expect_columns(std::size_t columns, const std::string& because) const {
  if (columns_ != columns)
    refuse_file(lines_.file(), 1, fmt::format("the header states {} columns", columns_),
                fmt::format("{}, {}", columns, because), "the files do not belong together; write the set again");
}

bool FlexibleTable::next_row() {
  while (lines_.next()) {
    if (lines_.line().starts_with('#')) continue;
    words_ = lines_.words();
    if (!words_.empty()) return true;
  }
  return false;
}

const std::vector<std::string_view>& FlexibleTable::next() {
  if (!next_row())
    refuse_file(lines_.file(), lines_.number(), fmt::format("the file ends after {} rows", taken_),
                fmt::format("{} rows of {}", rows_, what_), "it may have been cut; write the set again");
  ++taken_;
  if (columns_ > 0 && words_.size() != columns_)
    lines_.refuse(fmt::format("{} words", words_.size()), fmt::format("{} of {}", columns_, what_));
  return words_;
}

void FlexibleTable::end() {
  if (next_row()) lines_.refuse(fmt::format("there are more rows than {}", rows_), "the number in the header");
  if (!lines_.is_ended())
    refuse_file(lines_.file(), lines_.number(), "the last line has no end", "a file that ends with its last row",
                "it may have been cut; write the set again");
}

void FlexibleTable::expect_whole(std::size_t column, long value, const char* what) const {
  if (lines_.whole_of(words_[column], 0) != value)
    lines_.refuse(fmt::format("{} {}", what, words_[column]), fmt::format("{} {}", what, value),
                  "keep the order of rows");
}

void FlexibleTable::expect_word(std::size_t column, std::string_view word) const {
  if (words_[column] != word)
    lines_.refuse(fmt::format("a row of '{}'", words_[column]), fmt::format("one of '{}'", word),
                  "keep the order of rows");
}

}  // namespace slew::flex
