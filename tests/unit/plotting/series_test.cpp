// SPDX-License-Identifier: Apache-2.0
#include "plotting/series.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "plotting/decimation.h"

namespace slew::plotting {
namespace series_test {

TEST(Series, OfSeveralMessagesKeepTheInstantsThatAllHave) {
  std::vector<Series> curves = {{"a", "m", {0, 0.1, 0.2, 0.4}, {10, 11, 12, 14}, 0.1},
                                {"b", "m", {0, 0.2, 0.3, 0.4}, {20, 22, 23, 24}, 0.1},
                                {"c", "m", {0, 0.1, 0.2, 0.3, 0.4}, {30, 31, 32, 33, 34}, 0.1}};
  keep_common_instants(curves);
  const std::vector<double> common = {0, 0.2, 0.4};
  for (const Series& curve : curves) EXPECT_EQ(curve.time, common) << curve.name;
  EXPECT_EQ(curves[0].values, (std::vector<double>{10, 12, 14}));
  EXPECT_EQ(curves[1].values, (std::vector<double>{20, 22, 24}));
  EXPECT_EQ(curves[2].values, (std::vector<double>{30, 32, 34}));
}

TEST(Series, WithoutACommonInstantKeepNone) {
  std::vector<Series> curves = {{"a", "", {0, 1}, {1, 2}}, {"b", "", {}, {}}};
  keep_common_instants(curves);
  EXPECT_TRUE(curves[0].time.empty());
  EXPECT_TRUE(curves[0].values.empty());
}

TEST(Series, PartWhereSamplesAreMissing) {
  std::vector<Series> curves = {{"a", "m", {0, 0.01, 0.02, 0.05, 0.06}, {1, 2, 3, 4, 5}, 0.01},
                                {"of unknown spacing", "m", {0, 0.01, 0.05}, {1, 2, 3}}};
  part_at_gaps(curves);
  ASSERT_EQ(curves[0].time.size(), 6u);
  EXPECT_DOUBLE_EQ(curves[0].time[3], 0.03);
  EXPECT_TRUE(std::isnan(curves[0].values[3]));
  EXPECT_EQ(curves[0].values[4], 4);
  EXPECT_EQ(curves[1].time.size(), 3u);
  const std::vector<Polyline> parts = decimate(curves[0], 0, 0.06, 1000);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].back(), (std::pair<double, double>{0.02, 3}));
  EXPECT_EQ(parts[1].front(), (std::pair<double, double>{0.05, 4}));
}

TEST(Series, PartNowhereWhenNothingIsMissing) {
  Series whole{"a", "m", {}, {}, 0.001};
  for (int k = 0; k < 100'000; ++k) {
    whole.time.push_back(static_cast<double>(k * 1'000'000LL) / 1e9);
    whole.values.push_back(k);
  }
  part_at_gaps({&whole, 1});
  EXPECT_EQ(whole.time.size(), 100'000u);
}

}  // namespace series_test
}  // namespace slew::plotting
