// SPDX-License-Identifier: Apache-2.0
#include "plotting/decimation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace slew::plotting {
namespace decimation_test {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Series sampled(std::size_t size) {
  Series series{"s", "m", {}, {}};
  for (std::size_t i = 0; i < size; ++i) {
    series.time.push_back(1e-3 * static_cast<double>(i));
    series.values.push_back(std::sin(0.01 * static_cast<double>(i)));
  }
  return series;
}

TEST(Decimation, KeepsAPeakOfOneSampleAmongAMillion) {
  Series series = sampled(1'000'000);
  series.values[123'457] = 99;
  series.values[765'432] = -99;
  const std::vector<Polyline> parts = decimate(series, 0, 999.999, 500);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_LE(parts[0].size(), 2'000u);
  const auto has = [&](double time, double value) {
    return std::find(parts[0].begin(), parts[0].end(), std::pair(time, value)) != parts[0].end();
  };
  EXPECT_TRUE(has(series.time[123'457], 99));
  EXPECT_TRUE(has(series.time[765'432], -99));
  EXPECT_TRUE(
      std::is_sorted(parts[0].begin(), parts[0].end(), [](const auto& a, const auto& b) { return a.first < b.first; }));
}

TEST(Decimation, KeepsEverySampleWhereThereIsRoom) {
  const Series series = sampled(100);
  const std::vector<Polyline> parts = decimate(series, 0, 0.1, 1'000);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].size(), 100u);
}

TEST(Decimation, PartsTheCurveAtGapsAndResets) {
  const Series series = {"s", "m", {0, 1, 2, 3, 4, 0, 1, 2}, {1, 2, kNan, 4, 5, 6, 1e308, 8}};
  const std::vector<Polyline> parts = decimate(series, 0, 4, 100);
  ASSERT_EQ(parts.size(), 4u);
  EXPECT_EQ(parts[0], (Polyline{{0, 1}, {1, 2}}));
  EXPECT_EQ(parts[1], (Polyline{{3, 4}, {4, 5}}));
  EXPECT_EQ(parts[2], (Polyline{{0, 6}}));
  EXPECT_EQ(parts[3], (Polyline{{2, 8}}));
}

TEST(Decimation, LeavesOutWhatIsOutside) {
  EXPECT_TRUE(decimate({"s", "m", {0, 9}, {1, 2}}, 2, 4, 100).empty());
  EXPECT_TRUE(decimate({"s", "m", {}, {}}, 2, 4, 100).empty());
  EXPECT_TRUE(decimate({"s", "m", {3}, {kNan}}, 2, 4, 100).empty());
}

// ---- thinned curves -------------------------------------------------------------------------------------------

TEST(Thinning, KeepsTheExtremesOfEveryBinInTheirOrderAndCommonTimes) {
  std::vector<Series> curves = {sampled(100'000), sampled(100'000)};
  curves[0].values[12'345] = 99;
  curves[1].values[76'543] = -99;
  EXPECT_EQ(thin_out(curves, 2'000), 100u);
  for (const Series& curve : curves) {
    EXPECT_LE(curve.time.size(), 2'000u);
    EXPECT_EQ(curve.time.size(), curve.values.size());
    EXPECT_TRUE(std::is_sorted(curve.time.begin(), curve.time.end()));
  }
  EXPECT_EQ(curves[0].time, curves[1].time);
  EXPECT_EQ(*std::max_element(curves[0].values.begin(), curves[0].values.end()), 99);
  EXPECT_EQ(*std::min_element(curves[1].values.begin(), curves[1].values.end()), -99);
}

TEST(Thinning, LeavesShortCurvesAsTheyAre) {
  std::vector<Series> curves = {sampled(2'000)};
  EXPECT_EQ(thin_out(curves, 2'000), 1u);
  EXPECT_EQ(curves[0].values, sampled(2'000).values);
}

TEST(Thinning, KeepsGapsAndStepsBackInTime) {
  std::vector<Series> curves = {sampled(1'000)};
  curves[0].values[505] = kNan;
  for (std::size_t i = 800; i < 1'000; ++i) curves[0].time[i] -= 0.7;
  EXPECT_EQ(thin_out(curves, 100), 20u);
  const Series& thinned = curves[0];
  EXPECT_EQ(std::count_if(thinned.values.begin(), thinned.values.end(), [](double v) { return std::isnan(v); }), 1);
  std::size_t steps_back = 0;
  for (std::size_t i = 1; i < thinned.time.size(); ++i) steps_back += thinned.time[i] < thinned.time[i - 1] ? 1 : 0;
  EXPECT_EQ(steps_back, 1u);
}

}  // namespace decimation_test
}  // namespace slew::plotting
