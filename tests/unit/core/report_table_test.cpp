// SPDX-License-Identifier: Apache-2.0
// A table of a report: the same columns as text, CSV, JSON and HTML.
#include "core/report_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace slew {
namespace report_table_test {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

ReportTable example() {
  ReportTable table({{"step", "step [s]", "step"}, {"error", "error [m]", "error"}, {"stable", {}, "stable"}});
  table.add({{"1 ms", 1e-3}, {"1.0e-05", 1e-5}, "yes"});
  table.add({{"any", {}}, {"-", {}}, "no"});
  return table;
}

ReportTable one_row(std::vector<ReportCell> row) {
  std::vector<ReportColumn> columns(row.size());
  for (std::size_t i = 0; i < columns.size(); ++i) columns[i] = {"", std::string(1, static_cast<char>('a' + i)), {}};
  ReportTable table(std::move(columns));
  table.add(std::move(row));
  return table;
}

std::size_t characters(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

std::size_t longest_line(const std::string& text) {
  std::istringstream lines(text);
  std::size_t longest = 0;
  for (std::string line; std::getline(lines, line);) longest = std::max(longest, characters(line));
  return longest;
}

// ---- text -----------------------------------------------------------------------------------------------------------

TEST(ReportTable, AlignsColumnsAndDoesNotPadTheLast) {
  EXPECT_EQ(example().text(),
            "step  error    stable\n"
            "1 ms  1.0e-05  yes\n"
            "any   -        no\n");
  EXPECT_EQ(example().text("  ").substr(0, 9), "  step  e");
}

TEST(ReportTable, AlignsByCharactersNotBytes) {
  ReportTable table({"a", "b"});
  table.add({"\u00e4\u00e4", "c"});
  EXPECT_EQ(table.text(), "a   b\n\u00e4\u00e4  c\n");
  EXPECT_EQ(table.text("", 5), table.text());
}

TEST(ReportTable, WithoutHeadingsHasNoLineForThem) {
  ReportTable table({"", ""});
  EXPECT_EQ(table.text(), "");
  table.add({"scene", "crane"});
  EXPECT_EQ(table.text(), "scene  crane\n");
  EXPECT_EQ(table.html(), "<table>\n<tr><td>scene</td><td>crane</td></tr>\n</table>\n");
}

TEST(ReportTable, ARowMayEndEarly) {
  ReportTable table({{"a", "a", "a"}, {"b", "b", "b"}, {"c", "c", "c"}});
  table.add({"1", "2", ""});
  table.add({"1", "2"});
  EXPECT_EQ(table.text(), "a  b  c\n1  2  \n1  2\n");
  EXPECT_EQ(table.csv(), "a,b,c\r\n1,2,\r\n1,2,\r\n");
  EXPECT_TRUE(table.json().items()[1].at("c").is_null());
}

TEST(ReportTable, WiderThanTheTerminalIsPutIntoBlocksThatBeginWithTheFirstColumn) {
  ReportTable table({"case", "verdict", "value", "note"});
  table.add({"zero gravity", "within", "212 bar", "none"});
  EXPECT_EQ(table.text("", 32),
            "case          verdict  value\n"
            "zero gravity  within   212 bar\n"
            "\n"
            "case          note\n"
            "zero gravity  none\n");
  EXPECT_EQ(table.text("", 36), table.text()) << "fits exactly";
  EXPECT_NE(table.text("", 35), table.text());
  EXPECT_EQ(longest_line(table.text("  ", 32)), 32U) << "the indent counts";
}

TEST(ReportTable, ColumnsThatNameARowAreRepeatedAsFarAsTheyFit) {
  ReportTable table({"formulation", "step", "error", "cost"}, 2);
  table.add({"recursive", "1 ms", "1e-4", "2"});
  EXPECT_EQ(table.text("", 24),
            "formulation  step  error\n"
            "recursive    1 ms  1e-4\n"
            "\n"
            "formulation  step  cost\n"
            "recursive    1 ms  2\n");
  EXPECT_EQ(table.text("", 16),
            "formulation  step\n"
            "recursive    1 ms\n"
            "\n"
            "formulation  error\n"
            "recursive    1e-4\n"
            "\n"
            "formulation  cost\n"
            "recursive    2\n");
}

TEST(ReportTable, AColumnThatIsTooWideStandsInABlockOfItsOwn) {
  ReportTable table({"case", "advice", "a", "b"});
  table.add({"one", std::string(40, 'x'), "1", "2"});
  EXPECT_EQ(table.text("", 20), "case  advice\none   " + std::string(40, 'x') + "\n\ncase  a  b\none   1  2\n");
}

TEST(ReportTable, OfFourHundredColumnsStaysWithinTheTerminal) {
  std::vector<ReportColumn> columns = {{"case"}};
  std::vector<ReportCell> row = {"valve_closes_in_1_ms"};
  for (const char* heading : {"verdict", "nearest to its bound", "largest stable step", "what to do", "notes"}) {
    columns.push_back({heading});
    row.emplace_back(std::string(75, '-'));
  }
  ReportTable table(std::move(columns));
  table.add(std::move(row));
  EXPECT_GT(longest_line(table.text("  ")), 400U);
  const std::string text = table.text("  ", 100);
  EXPECT_LE(longest_line(text), 100U) << text;
  for (const char* heading : {"verdict\n", "nearest to its bound\n", "notes\n"}) {
    EXPECT_NE(text.find(std::string("  case                  ") + heading), std::string::npos) << text;
  }
}

TEST(ReportTable, ALongTextMakesNoOtherLineLong) {
  const std::string refusal(380, 'r');
  ReportTable table({"case", "verdict", "nearest to its bound", "largest stable step"});
  table.add({"load_0_kg", "refused", refusal, "-"});
  table.add({"zero_gravity", "within", "highest pressure 273.5 bar of 728 bar, 38 %", "2.5 ms"});
  std::string text = table.text("  ", 100);
  const std::size_t at = text.find(refusal);
  ASSERT_NE(at, std::string::npos);
  EXPECT_LE(longest_line(text.erase(at, refusal.size())), 100U) << text;
}

// ---- CSV ------------------------------------------------------------------------------------------------------------

TEST(ReportTable, CsvTakesTheExactValuesOfItsOwnColumns) {
  EXPECT_EQ(example().csv(), "step [s],error [m]\r\n0.001,1e-05\r\n,\r\n");
}

TEST(ReportTable, CsvQuotesWhatWouldEndACell) {
  EXPECT_EQ(one_row({"plain text", "a, b", "the \"no\"", "two\nlines", ""}).csv(),
            "a,b,c,d,e\r\nplain text,\"a, b\",\"the \"\"no\"\"\",\"two\nlines\",\r\n");
}

TEST(ReportTable, CsvNumbersGiveTheSameBitsAgain) {
  const std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
  EXPECT_EQ(one_row({{"", 1.0 / 3}, {"", 1e15}, {"", -0.0}, {"", 2.0}, {"", -3}, {"", most}}).csv(),
            "a,b,c,d,e,f\r\n0.3333333333333333,1000000000000000,-0,2,-3,18446744073709551615\r\n");
}

TEST(ReportTable, WhatIsNotFiniteIsEmptyInCsvAndNullInJson) {
  ReportTable table({{"a", "a", "a"}, {"b", "b", "b"}});
  table.add({{"inf", kInfinity}, {"nan", std::nan("")}});
  EXPECT_EQ(table.csv(), "a,b\r\n,\r\n");
  EXPECT_EQ(table.json().dump(), R"([{"a":null,"b":null}])");
  EXPECT_EQ(table.text(), "a    b\ninf  nan\n");
}

// ---- JSON and HTML --------------------------------------------------------------------------------------------------

TEST(ReportTable, JsonIsAnArrayOfRows) {
  EXPECT_EQ(example().json().dump(),
            R"([{"error":1e-05,"stable":"yes","step":0.001},{"error":null,"stable":"no","step":null}])");
  EXPECT_EQ(ReportTable({{.json = "a"}}).json().dump(), "[]");
}

TEST(ReportTable, HtmlShowsTheTextAndNothingInItIsMarkup) {
  ReportTable table({{.text = "a < b"}, {.csv = "only in CSV"}});
  table.add({"<b>\"x\" & y</b>", "hidden"});
  EXPECT_EQ(table.html(),
            "<table>\n<tr><th>a &lt; b</th></tr>\n"
            "<tr><td>&lt;b&gt;&quot;x&quot; &amp; y&lt;/b&gt;</td></tr>\n</table>\n");
}

}  // namespace report_table_test
}  // namespace slew
