// SPDX-License-Identifier: Apache-2.0
#include "core/report_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/check.h"
#include "core/escaped.h"
#include "core/printable.h"

namespace slew {
namespace {

using Texts = std::vector<std::string>;

constexpr std::size_t kGap = 2;  // spaces between columns

std::size_t characters(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

// headings (if one of them is not empty) and rows of the shown columns
std::vector<Texts> shown_lines(const std::vector<ReportColumn>& columns,
                               const std::vector<std::vector<ReportCell>>& rows) {
  std::vector<Texts> lines(1);
  bool has_headings = false;
  for (const ReportColumn& column : columns) {
    if (!column.text) continue;
    lines.front().push_back(*column.text);
    has_headings = has_headings || !column.text->empty();
  }
  if (!has_headings) lines.clear();
  for (const std::vector<ReportCell>& row : rows) {
    Texts& line = lines.emplace_back();
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (columns[c].text) line.push_back(printable(row[c].text));
    }
  }
  return lines;
}

std::vector<std::size_t> widths_of(const std::vector<Texts>& lines) {
  std::vector<std::size_t> widths;
  for (const Texts& line : lines) {
    widths.resize(std::max(widths.size(), line.size()), 0);
    for (std::size_t c = 0; c < line.size(); ++c) widths[c] = std::max(widths[c], characters(line[c]));
  }
  return widths;
}

// columns of each block
std::vector<std::vector<std::size_t>> blocks_of(const std::vector<std::size_t>& widths, std::size_t naming,
                                                std::size_t room) {
  // repeated columns: the columns that name a row, as many as fit
  std::vector<std::size_t> repeated;
  std::size_t repeated_length = 0;  // with the gap behind each column
  while (repeated.size() < std::min(naming, widths.size())) {
    const std::size_t length = repeated_length + widths[repeated.size()] + kGap;
    if (!repeated.empty() && length > room + kGap) break;
    repeated_length = length;
    repeated.push_back(repeated.size());
  }
  // further columns as far as they fit, at least one
  std::vector<std::vector<std::size_t>> blocks = {repeated};
  std::size_t length = repeated_length;
  for (std::size_t c = repeated.size(); c < widths.size(); ++c) {
    if (blocks.back().size() > repeated.size() && length + widths[c] > room) {
      blocks.push_back(repeated);
      length = repeated_length;
    }
    blocks.back().push_back(c);
    length += widths[c] + kGap;
  }
  return blocks;
}

std::string csv_number(const Json& number) {
  std::string digits = number.dump();
  const bool is_integer = digits.find_first_not_of("-0123456789") == std::string::npos;
  if (is_integer) return digits;
  return std::isfinite(number.number()) ? fmt::format("{}", number.number()) : "";
}

std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2U : 1U, c);
  return quoted + '"';
}

std::string csv_cell(const Json& exact) {
  if (exact.is_null()) return "";
  return exact.is_number() ? csv_number(exact) : csv_text(exact.text());
}

}  // namespace

ReportTable::ReportTable(std::vector<ReportColumn> columns, std::size_t naming)
    : columns_(std::move(columns)), naming_(naming) {}

ReportTable::ReportTable(std::initializer_list<const char*> headings, std::size_t naming) : naming_(naming) {
  for (const char* heading : headings) columns_.push_back({.text = heading});
}

void ReportTable::add(std::vector<ReportCell> row) {
  SLEW_CHECK(row.size() <= columns_.size());
  rows_.push_back(std::move(row));
}

std::string ReportTable::text(std::string_view indent, std::size_t width) const {
  const std::vector<Texts> lines = shown_lines(columns_, rows_);
  const std::vector<std::size_t> widths = widths_of(lines);
  const std::size_t room =
      width == 0 ? std::numeric_limits<std::size_t>::max() - kGap : width - std::min(width, indent.size());
  std::string text;
  for (const std::vector<std::size_t>& block : blocks_of(widths, naming_, room)) {
    if (!text.empty()) text += '\n';
    for (const Texts& line : lines) {
      text += indent;
      for (std::size_t i = 0; i < block.size() && block[i] < line.size(); ++i) {
        const std::string& cell = line[block[i]];
        text += cell;
        const bool is_last = i + 1 == block.size() || block[i + 1] >= line.size();
        if (!is_last) text.append(widths[block[i]] - characters(cell) + kGap, ' ');
      }
      text += '\n';
    }
  }
  return text;
}

std::string ReportTable::csv() const {
  std::string text;
  const auto line = [&](auto&& cell_of) {
    const char* comma = "";
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      if (!columns_[c].csv) continue;
      text += std::exchange(comma, ",") + cell_of(c);
    }
    text += "\r\n";
  };
  line([&](std::size_t c) { return csv_text(*columns_[c].csv); });
  for (const std::vector<ReportCell>& row : rows_) {
    line([&](std::size_t c) { return c < row.size() ? csv_cell(row[c].exact) : std::string(); });
  }
  return text;
}

Json ReportTable::json() const {
  Json array = Json::array();
  for (const std::vector<ReportCell>& row : rows_) {
    Json object = Json::object();
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      if (columns_[c].json) object[*columns_[c].json] = c < row.size() ? row[c].exact : Json();
    }
    array.push_back(std::move(object));
  }
  return array;
}

std::string ReportTable::html() const {
  std::string text = "<table>\n";
  const std::vector<Texts> lines = shown_lines(columns_, rows_);
  const bool has_headings = lines.size() > rows_.size();
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const char* kind = has_headings && i == 0 ? "th" : "td";
    text += "<tr>";
    for (const std::string& cell : lines[i]) text += fmt::format("<{0}>{1}</{0}>", kind, escaped(cell));
    text += "</tr>\n";
  }
  return text + "</table>\n";
}

}  // namespace slew
