// SPDX-License-Identifier: Apache-2.0
#include "flex/matrix_market.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iterator>

#include "flex/input_error.h"
#include "flex/text_lines.h"

namespace slew::flex {
namespace {

constexpr const char* kHeader = "'%%MatrixMarket matrix coordinate real symmetric' or '... general'";

std::string lower(std::string_view word) {
  std::string out(word);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return std::tolower(c); });
  return out;
}

// true if the file is symmetric
bool read_header(TextLines& lines) {
  if (!lines.next()) refuse_file(lines.file(), 0, "the file is empty", kHeader);
  const auto words = lines.words();
  const std::string found = "the first line is '" + std::string(lines.line().substr(0, 80)) + "'";
  if (words.size() != 5 || words[0] != "%%MatrixMarket") lines.refuse(found, kHeader);
  const std::string field = lower(words[3]), symmetry = lower(words[4]);
  const bool is_known = lower(words[1]) == "matrix" && lower(words[2]) == "coordinate" &&
                        (field == "real" || field == "integer") && (symmetry == "symmetric" || symmetry == "general");
  if (!is_known) lines.refuse(found, kHeader, "export the matrix in that form");
  return symmetry == "symmetric";
}

// the next line that is no comment
bool next_content(TextLines& lines) {
  while (lines.next()) {
    if (!lines.line().starts_with('%') && !lines.words().empty()) return true;
  }
  return false;
}

struct Sizes {
  long rows, columns, entries;
};

Sizes read_sizes(TextLines& lines) {
  if (!next_content(lines)) refuse_file(lines.file(), 0, "the line of sizes is missing", "rows columns entries");
  const auto words = lines.words();
  if (words.size() != 3)
    lines.refuse(fmt::format("{} numbers in the line of sizes", words.size()), "rows columns entries");
  const Sizes sizes{lines.whole_of(words[0], 1), lines.whole_of(words[1], 1), lines.whole_of(words[2], 0)};
  // limit of Eigen's indices
  if (std::max({sizes.rows, sizes.columns, sizes.entries}) > 1'000'000'000)
    lines.refuse("the sizes are out of range", "at most 1e9 each");
  return sizes;
}

Eigen::Triplet<double> read_entry(const TextLines& lines, const Sizes& sizes, bool is_symmetric) {
  const auto words = lines.words();
  if (words.size() != 3) lines.refuse(fmt::format("{} words", words.size()), "row column value");
  const long row = lines.whole_of(words[0], 1), column = lines.whole_of(words[1], 1);
  if (row > sizes.rows || column > sizes.columns)
    lines.refuse(fmt::format("the entry ({}, {}) is outside", row, column),
                 fmt::format("at most ({}, {})", sizes.rows, sizes.columns));
  if (is_symmetric && column > row)
    lines.refuse(fmt::format("the entry ({}, {}) is above the diagonal", row, column),
                 "the lower triangle of a symmetric matrix");
  return {static_cast<int>(row) - 1, static_cast<int>(column) - 1, lines.number_of(words[2])};
}

}  // namespace

SparseMatrix read_matrix_market(const std::filesystem::path& file) {
  TextLines lines(file);
  const bool is_symmetric = read_header(lines);
  const Sizes sizes = read_sizes(lines);
  if (is_symmetric && sizes.rows != sizes.columns)
    lines.refuse(fmt::format("a symmetric matrix of {} rows and {} columns", sizes.rows, sizes.columns),
                 "as many columns as rows");
  std::vector<Eigen::Triplet<double>> entries;
  for (long i = 0; i < sizes.entries; ++i) {
    if (!next_content(lines))
      refuse_file(file, 0, fmt::format("the file ends after {} entries", i), fmt::format("{}", sizes.entries),
                  "it may have been cut; export it again");
    const Eigen::Triplet<double> entry = read_entry(lines, sizes, is_symmetric);
    entries.push_back(entry);
    if (is_symmetric && entry.row() != entry.col()) entries.emplace_back(entry.col(), entry.row(), entry.value());
  }
  if (next_content(lines)) lines.refuse("there is more than the entries", fmt::format("{} entries", sizes.entries));
  SparseMatrix matrix(static_cast<int>(sizes.rows), static_cast<int>(sizes.columns));
  matrix.setFromTriplets(entries.begin(), entries.end());
  if (matrix.nonZeros() != static_cast<Eigen::Index>(entries.size()))
    refuse_file(
        file, 0,
        fmt::format("{} entries are given twice", static_cast<Eigen::Index>(entries.size()) - matrix.nonZeros()),
        "each once");
  return matrix;
}

void write_matrix_market(const std::filesystem::path& file, const SparseMatrix& symmetric, const std::string& comment) {
  std::string body;
  long entries = 0;
  for (int column = 0; column < symmetric.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator it(symmetric, column); it; ++it) {
      if (it.row() < column || it.value() == 0) continue;
      fmt::format_to(std::back_inserter(body), "{} {} {:.16e}\n", it.row() + 1, column + 1, it.value());
      ++entries;
    }
  }
  std::string text = "%%MatrixMarket matrix coordinate real symmetric\n";
  if (!comment.empty()) text += "% " + comment + '\n';
  text += fmt::format("{} {} {}\n", symmetric.rows(), symmetric.cols(), entries);
  write_text(file, text + body);
}

}  // namespace slew::flex
