// SPDX-License-Identifier: Apache-2.0
#include "scene/csv_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/suggestion.h"
#include "scene/number.h"
#include "scene/scene.h"

namespace slew::scene {
namespace {

bool is_space(char c, char separator) {
  return c == ' ' || (c == '\t' && separator != '\t');
}

// Separator by the first line, outside of quotes.
char separator_of(std::string_view line) {
  bool is_quoted = false;
  std::size_t commas = 0, tabs = 0;
  for (const char c : line) {
    if (c == '"') is_quoted = !is_quoted;
    if (is_quoted) continue;
    if (c == ';') return ';';
    if (c == ',') ++commas;
    if (c == '\t') ++tabs;
  }
  return tabs > commas ? '\t' : ',';
}

std::string separator_name(char separator) {
  return separator == '\t' ? "a tab" : fmt::format("'{}'", separator);
}

// ---- units in a header

// text in brackets, at [open, close]
struct Bracketed {
  std::size_t open = 0;
  std::size_t close = 0;
  std::string_view content;
};

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

// The outer pairs of these brackets.
std::vector<Bracketed> bracketed_in(std::string_view text, char opening, char closing) {
  std::vector<Bracketed> found;
  std::size_t depth = 0, open = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == opening && depth++ == 0) open = i;
    if (text[i] != closing || depth == 0 || --depth > 0) continue;
    found.push_back({open, i, trimmed(text.substr(open + 1, i - open - 1))});
  }
  return found;
}

// Units of a number of anything have no place in a column: 'p (A)' is a name.
bool is_unit(std::string_view text, UnitSystem& units) {
  const Unit* const unit = units.find(text);
  return text == "-" || (unit != nullptr && !unit->has_other_base);
}

bool are_of_one_dimension(std::string_view a, std::string_view b, UnitSystem& units) {
  const Unit* const first = units.find(a);
  const Unit* const second = units.find(b);
  return first != nullptr && second != nullptr && first->exponent == second->exponent;
}

// Text behind a unit that would change the numbers, or belong to the unit: "/1000", "x1000", "^2", "2".
bool is_calculation(std::string_view text) {
  text = trimmed(text);
  if (text.empty()) return false;
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (is_digit(text.front()) || std::string_view("/*^+=%").find(text.front()) != std::string_view::npos) return true;
  for (const std::string_view sign : {"-", "x", "X", ".", "\xC3\x97", "\xC2\xB7", "\xE2\x8B\x85"}) {
    if (!text.starts_with(sign)) continue;
    const std::string_view rest = trimmed(text.substr(sign.size()));
    if (!rest.empty() && is_digit(rest.front())) return true;
  }
  return false;
}

// "a name and one unit in brackets, such as 'force [kN]'"
std::string expected_header(std::string_view name) {
  return fmt::format("a name and one unit in brackets behind it, such as '{} [UNIT]', or the name alone for SI",
                     name.empty() ? "force" : name);
}

void split_unit(ColumnHead& column, UnitSystem& units) {
  const std::string_view text = column.text;
  const std::vector<Bracketed> square = bracketed_in(text, '[', ']');
  std::vector<Bracketed> found = square;
  std::string_view empty;
  for (const Bracketed& round : bracketed_in(text, '(', ')')) {
    if (round.content.empty() && square.empty()) empty = "()";
    if (!is_unit(round.content, units)) continue;
    // 'p (P) [bar]': the round brackets are part of the name
    const bool counts = square.empty() || are_of_one_dimension(round.content, square.front().content, units);
    if (counts) found.push_back(round);
  }
  if (found.empty() && empty.empty()) return;
  const std::size_t begin = found.empty() ? text.find(empty) : std::min(found.front().open, found.back().open);
  std::string_view name = trimmed(text.substr(0, begin));
  // Q/(l/min)
  if (name.ends_with('/')) name = trimmed(name.substr(0, name.size() - 1));
  column.name = name;
  const auto fault = [&](std::string_view what) {
    column.problem = {fmt::format("the header '{}' {}", text, what), expected_header(name), ""};
  };
  if (found.size() > 1) return fault("has two parts in brackets");
  if (found.empty() || found.front().content.empty()) return fault("has no unit in its brackets");
  if (is_calculation(text.substr(found.front().close + 1))) return fault("goes on with a calculation behind the unit");
  column.unit = found.front().content;
}

constexpr std::string_view kMarks = " ./:,_{}()<>|";

std::string_view without_marks(std::string_view text) {
  while (!text.empty() && kMarks.find(text.back()) != std::string_view::npos) text.remove_suffix(1);
  return text;
}

// The unit at the end of a header without brackets: "kN" of "f kN", "f/kN", "f {kN}"; empty: none.
std::string_view loose_unit_in(std::string_view header, Dimension dimension, UnitSystem& units) {
  const std::string_view text = without_marks(header);
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_word = i == 0 || kMarks.find(text[i - 1]) != std::string_view::npos;
    const std::string_view word = text.substr(i);
    if (!is_word) continue;
    const Unit* const unit = read_unit(word, dimension, units).unit;
    if (unit == nullptr) continue;
    const bool is_si = unit->scale == 1 && unit->offset == 0;
    // a name may be a unit of SI, or end in one: 'm', 'force_N'
    const bool is_name = i == 0 || text[i - 1] == '_' || is_plain_number(dimension);
    if (!is_si || !is_name) return word;
  }
  return {};
}

}  // namespace

void CsvFile::report_problem(const Cell& cell, ValueProblem problem) {
  ++problem_count_;
  report_.add(source_.mark_at(cell.byte), "", std::move(problem));
}

// ---- lines and cells

bool CsvFile::next_line() {
  while (line_ < source_.line_start.size()) {
    const std::size_t begin = source_.line_start[line_];
    ++line_;
    std::size_t end = line_ < source_.line_start.size() ? source_.line_start[line_] - 1 : source_.text.size();
    if (end > begin && source_.text[end - 1] == '\r') --end;
    const std::string_view line = std::string_view(source_.text).substr(begin, end - begin);
    const std::size_t first = line.find_first_not_of(" \t");
    if (first == std::string_view::npos || line[first] == '#') continue;
    if (separator_ == 0 && line.size() == 5 && line.starts_with("sep=")) {
      separator_ = line[4];
      continue;
    }
    if (separator_ == 0) separator_ = separator_of(line);
    return split(begin, end);
  }
  return false;
}

// Fills cells_ from a line. False after a reported problem.
bool CsvFile::split(std::size_t begin, std::size_t end) {
  const std::string_view text = source_.text;
  cells_.clear();
  unquoted_.clear();
  for (std::size_t at = begin; at <= end;) {
    std::size_t first = at;
    while (first < end && is_space(text[first], separator_)) ++first;
    if (first < end && text[first] == '"') {
      at = read_quoted(first, end);
      if (at == std::string_view::npos) return false;
    } else {
      const std::size_t stop = std::min(text.find(separator_, first), end);
      std::size_t last = stop;
      while (last > first && is_space(text[last - 1], separator_)) --last;
      cells_.push_back({text.substr(first, last - first), first});
      at = stop;
    }
    ++at;  // over the separator
  }
  return true;
}

// Reads the cell whose quote is at `open`; returns its end, at a separator or the line's end. npos after a reported
// problem.
std::size_t CsvFile::read_quoted(std::size_t open, std::size_t end) {
  const std::string_view text = source_.text;
  bool has_quotes = false;
  std::size_t close = open + 1;
  for (; close < end; ++close) {
    if (text[close] != '"') continue;
    if (close + 1 == end || text[close + 1] != '"') break;
    has_quotes = true;
    ++close;
  }
  if (close >= end) {
    report_problem({{}, open}, {"this quote is not closed in its line", "a second \"", ""});
    return std::string_view::npos;
  }
  std::string_view content = text.substr(open + 1, close - open - 1);
  if (has_quotes) {
    std::string& kept = unquoted_.emplace_back();
    for (std::size_t i = 0; i < content.size(); ++i) {
      kept += content[i];
      if (content[i] == '"') ++i;
    }
    content = kept;
  }
  while (!content.empty() && content.front() == ' ') content.remove_prefix(1);
  while (!content.empty() && content.back() == ' ') content.remove_suffix(1);
  cells_.push_back({content, open});
  std::size_t next = close + 1;
  while (next < end && is_space(text[next], separator_)) ++next;
  if (next == end || text[next] == separator_) return next;
  report_problem({{}, next},
                 {"text stands behind a quoted cell", separator_name(separator_) + " or the line's end", ""});
  return std::string_view::npos;
}

// ---- header and rows

bool CsvFile::read_column_head(const Cell& cell) {
  ColumnHead& column = head_.emplace_back(
      ColumnHead{std::string(cell.text), std::string(cell.text), "", source_.mark_at(cell.byte), {}});
  const std::size_t open = cell.text.rfind('[');
  if (open != std::string_view::npos && cell.text.find(']', open) == std::string_view::npos) {
    report_problem(cell, {"this '[' is not closed", "a name with its unit, such as 'force [kN]'", ""});
    return false;
  }
  split_unit(column, units_);
  return true;
}

std::optional<std::size_t> CsvFile::find_column(std::string_view name, std::string expected) {
  std::optional<std::size_t> found;
  std::vector<std::string_view> names;
  for (const ColumnHead& column : head_) {
    if (column.name == name && found) {
      report_.add(column.mark, "",
                  {fmt::format("'{}' and '{}' are both named '{}'", head_[*found].text, column.text, name),
                   "one column for a name; words that differ stand before the unit", ""});
      return std::nullopt;
    }
    if (column.name == name) found = names.size();
    names.push_back(column.name);
  }
  if (!found) {
    report_.add(head_.front().mark, "",
                {fmt::format("there is no column '{}'", name), std::move(expected), closest(name, names)});
  }
  return found;
}

bool CsvFile::read_head() {
  if (!next_line()) {
    if (problem_count_ == 0)
      report_file_problem({"the file is empty", fmt::format("a header such as '{}'", example_), ""});
    return false;
  }
  while (cells_.size() > 1 && cells_.back().text.empty()) cells_.pop_back();
  for (const Cell& cell : cells_) {
    if (split_number(cell.text).is_number) {
      report_problem(cell, {fmt::format("the file begins with the number '{}'", cell.text),
                            fmt::format("a header such as '{}'", example_), ""});
      return false;
    }
    if (cell.text.empty()) {
      report_problem(cell, {"a column has no name", "a name in every cell of the header", ""});
      return false;
    }
  }
  return std::all_of(cells_.begin(), cells_.end(), [this](const Cell& cell) { return read_column_head(cell); });
}

const std::vector<Cell>* CsvFile::next_row() {
  if (problem_count_ >= kMaxReportedProblems || !next_line()) return nullptr;
  if (++rows_ > kMaxTableRows) {
    report_problem(cells_[0], {fmt::format("the file has more than {} rows", kMaxTableRows), "a shorter record", ""});
    line_ = source_.line_start.size();
    return nullptr;
  }
  while (cells_.size() > head_.size() && cells_.back().text.empty()) cells_.pop_back();
  if (cells_.size() == head_.size()) return &cells_;
  // 0,5,1,2 where cells are separated by commas
  const bool may_be_decimal_commas = separator_ == ',' && cells_.size() == 2 * head_.size();
  report_problem(cells_[0],
                 {fmt::format("the line has {} cell{}", cells_.size(), cells_.size() == 1 ? "" : "s"),
                  fmt::format("{} as in the header{}", head_.size(),
                              may_be_decimal_commas ? "; decimal commas need ';' or tabs between cells" : ""),
                  ""});
  return nullptr;
}

// ---- numbers

// The cell's text with a decimal point; empty after a reported problem.
std::string_view CsvFile::with_decimal_point(const Cell& cell) {
  const std::size_t at = separator_ == ',' ? cell.text.find('.') : cell.text.find_first_of(".,");
  if (at == std::string_view::npos) return cell.text;
  if (cell.text.find_first_of(".,", at + 1) != std::string_view::npos) {
    report_problem(cell, {fmt::format("'{}' is not a plain number", cell.text), "one decimal mark, no thousands", ""});
    return {};
  }
  const char mark = cell.text[at];
  if (decimal_ == 0) {
    decimal_ = mark;
    decimal_mark_ = source_.mark_at(cell.byte);
  } else if (decimal_ != mark) {
    report_problem(cell,
                   {fmt::format("'{}' has a decimal {}, the number in line {} a decimal {}", cell.text,
                                mark == ',' ? "comma" : "point", decimal_mark_.line, mark == ',' ? "point" : "comma"),
                    "one kind of decimal mark in a file", ""});
    return {};
  }
  if (mark == '.') return cell.text;
  number_.assign(cell.text);
  number_[at] = '.';
  return number_;
}

std::optional<long double> CsvFile::number(const Cell& cell) {
  const std::string_view text = with_decimal_point(cell);
  if (text.empty()) {
    if (cell.text.empty()) report_problem(cell, {"the cell is empty", "a number", ""});
    return std::nullopt;
  }
  NumberText number = split_number(text);
  if (!number.is_number) {
    report_problem(cell, std::move(number.problem));
  } else if (!number.rest.empty()) {
    report_problem(
        cell, {fmt::format("'{}' is not a plain number", cell.text), "a number; its unit stands in the header", ""});
  } else {
    return number.value;
  }
  return std::nullopt;
}

// ---- units of columns

namespace {

// False after a reported problem: a unit outside of brackets, or round brackets about something else.
bool is_without_unit(const ColumnHead& head, Dimension dimension, UnitSystem& units, Report& report) {
  const std::string_view loose = loose_unit_in(head.text, dimension, units);
  const std::size_t round = is_plain_number(dimension) ? std::string::npos : head.text.find('(');
  if (!loose.empty()) {
    const std::string_view name = without_marks(std::string_view(head.text).substr(0, head.text.rfind(loose)));
    report.add(head.mark, "",
               {fmt::format("the unit '{}' in the header '{}' stands in no brackets", loose, head.text),
                fmt::format("'{} [{}]', or another name", name.empty() ? "force" : name, loose), ""});
  } else if (round != std::string::npos) {
    report.add(head.mark, "",
               {fmt::format("what stands in the brackets of the header '{}' is no unit", head.text),
                expected_quantity(dimension) + "; a remark stands in no brackets", ""});
  }
  return loose.empty() && round == std::string::npos;
}

}  // namespace

bool ColumnScale::take(const ColumnHead& head, Dimension dimension, UnitSystem& units, Report& report) {
  if (!head.problem.what.empty()) {
    report.add(head.mark, "", head.problem);
    return false;
  }
  if (head.unit.empty()) return is_without_unit(head, dimension, units, report);
  // unit names by which exporting programs mark plain numbers
  if (is_plain_number(dimension) && (head.unit == "1" || head.unit == "-")) return true;
  UnitResult result = read_unit(head.unit, dimension, units);
  if (result.unit == nullptr) {
    report.add(head.mark, "", std::move(result.problem));
    return false;
  }
  unit_ = *result.unit;
  return true;
}

double ColumnScale::in_si(long double number) const noexcept {
  return static_cast<double>(unit_ ? number * unit_->scale + unit_->offset : number);
}

}  // namespace slew::scene
