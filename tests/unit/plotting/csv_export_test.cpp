// SPDX-License-Identifier: Apache-2.0
#include "plotting/csv_export.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

namespace slew::plotting {
namespace csv_export_test {

std::string csv_of(const std::vector<Series>& series) {
  std::ostringstream out;
  write_csv(series, out);
  return out.str();
}

TEST(CsvExport, MergesCurvesByTime) {
  const std::vector<Series> series = {{"a", "m", {0, 1, 2}, {10, 11, 12}}, {"b", "", {1, 1.5}, {-1, 0.1}}};
  EXPECT_EQ(csv_of(series),
            "time [s],a [m],b\n"
            "0,10,\n"
            "1,11,-1\n"
            "1.5,,0.1\n"
            "2,12,\n");
}

TEST(CsvExport, QuotesNamesAndSpellsSpecialNumbers) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const std::vector<Series> series = {{"a, \"b\"", "m", {nan, 0, 1, 2}, {0, nan, inf, -inf}}};
  EXPECT_EQ(csv_of(series), "time [s],\"a, \"\"b\"\" [m]\"\n0,NaN\n1,Inf\n2,-Inf\n");
  EXPECT_EQ(csv_of({}), "time [s]\n");
}

TEST(CsvExport, NumbersComeBackWithTheSameBits) {
  std::vector<Series> series = {{"a", "m", {}, {}}};
  double x = 0.37;
  for (int i = 0; i < 20'000; ++i) {
    x = 3.9 * x * (1 - x);
    series[0].time.push_back(i);
    series[0].values.push_back(std::ldexp(x, i % 2000 - 1000));
  }
  std::istringstream in(csv_of(series));
  std::string row;
  std::getline(in, row);
  for (const double value : series[0].values) {
    std::getline(in, row);
    ASSERT_EQ(std::stod(row.substr(row.find(',') + 1)), value);
  }
}

TEST(CsvExport, AFullDiskIsReported) {
  if (::access("/dev/full", W_OK) != 0) GTEST_SKIP() << "/dev/full is missing here";
  const std::vector<Series> series = {{"a", "m", {0}, {1}}};
  const Status status = export_csv(series, "/dev/full");
  EXPECT_EQ(status.code, ExitCode::storage);
  EXPECT_NE(status.text.find("/dev/full: cannot write the table (No space left on device)"), std::string::npos)
      << status.text;
  EXPECT_EQ(export_csv(series, "/nowhere/a.csv").code, ExitCode::storage);
}

}  // namespace csv_export_test
}  // namespace slew::plotting
