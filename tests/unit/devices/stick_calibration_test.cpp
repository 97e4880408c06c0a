// SPDX-License-Identifier: Apache-2.0
#include "devices/stick_calibration.h"

#include <gtest/gtest.h>

#include <cmath>

namespace slew::devices {
namespace stick_calibration_test {

struct Guided {
  explicit Guided(std::vector<AxisRange> ranges, const CalibrationDef& def = {}) {
    Problems problems;
    calibration = begin_calibration(def, ranges, problems);
    EXPECT_TRUE(problems.empty());
  }
  void rest(std::vector<std::int32_t> counts, int samples = 101) {
    for (int i = 0; i < samples; ++i) add_counts(calibration, counts, 0.01);
  }
  void move(std::initializer_list<std::vector<std::int32_t>> positions) {
    for (const auto& counts : positions) add_counts(calibration, counts, 0.01);
  }
  std::vector<std::string> end() {
    Problems problems;
    end_of_ends(calibration, problems);
    std::vector<std::string> texts;
    for (const Problem& problem : problems) texts.push_back(problem.what);
    return texts;
  }
  Calibration calibration;
};

TEST(StickCalibration, FindsEndsCentreAndDeadZone) {
  Guided guided({{"ABS_X", 0, 1023}, {"ABS_GAS", 0, 255}});
  guided.rest({508, 3});
  ASSERT_EQ(guided.calibration.phase, CalibrationPhase::ends);
  guided.move({{903, 3}, {120, 3}, {510, 250}, {510, 2}});
  EXPECT_TRUE(guided.end().empty());
  ASSERT_EQ(guided.calibration.phase, CalibrationPhase::rest_again);
  guided.rest({516, 4});
  ASSERT_EQ(guided.calibration.phase, CalibrationPhase::done);
  const std::vector<AxisDef> axes = results(guided.calibration);
  ASSERT_EQ(axes.size(), 2U);
  EXPECT_EQ(axes[0].code, "ABS_X");
  EXPECT_EQ(axes[0].lowest, 120);
  EXPECT_EQ(axes[0].centre, 512);
  EXPECT_EQ(axes[0].highest, 903);
  EXPECT_DOUBLE_EQ(axes[0].dead_zone, 4.0 / 391 + 0.02);
  EXPECT_EQ(shape(axes[0], 508).value, 0);
  EXPECT_EQ(shape(axes[0], 516).value, 0);
  // the pedal rests at 2 .. 4 and has its centre at the end of its travel
  EXPECT_EQ(axes[1].lowest, 2);
  EXPECT_EQ(axes[1].centre, 2);
  EXPECT_EQ(axes[1].highest, 250);
  EXPECT_EQ(shape(axes[1], 4).value, 0);
  EXPECT_EQ(shape(axes[1], 250).value, 1);
  for (const AxisDef& axis : axes) {
    Problems problems;
    validate(axis.code, axis, problems);
    EXPECT_TRUE(problems.empty());
  }
}

TEST(StickCalibration, RefusesAnAxisThatDidNotMove) {
  Guided guided({{"ABS_X", 0, 1023}, {"ABS_Y", 0, 1023}});
  guided.rest({512, 512});
  guided.move({{1000, 512}, {20, 524}});
  EXPECT_EQ(guided.end(), std::vector<std::string>{"ABS_Y moved by 12 of 1023 counts"});
  ASSERT_EQ(guided.calibration.phase, CalibrationPhase::ends);  // goes on where it was
  guided.move({{512, 1000}});
  EXPECT_EQ(guided.end(), std::vector<std::string>{"ABS_Y moved to one side only, by 0 counts down and 488 up"});
  guided.move({{512, 20}});
  EXPECT_TRUE(guided.end().empty());
}

TEST(StickCalibration, MeasuresAgainWhatMovesAtRest) {
  Guided guided({{"ABS_X", 0, 1023}});
  guided.rest({512}, 50);
  guided.move({{600}});
  EXPECT_EQ(guided.calibration.restarts, 1U);
  guided.rest({500}, 90);
  EXPECT_EQ(guided.calibration.phase, CalibrationPhase::rest);
  guided.rest({500}, 20);
  ASSERT_EQ(guided.calibration.phase, CalibrationPhase::ends);
  guided.move({{1000}, {20}});
  EXPECT_TRUE(guided.end().empty());
  guided.rest({700}, 300);  // still held by a hand: no rest
  EXPECT_EQ(guided.calibration.phase, CalibrationPhase::rest_again);
  guided.rest({510}, 102);
  ASSERT_EQ(guided.calibration.phase, CalibrationPhase::done);
  EXPECT_EQ(results(guided.calibration)[0].centre, 505);
}

TEST(StickCalibration, RefusesADeviceWithoutRange) {
  Problems problems;
  static_cast<void>(begin_calibration({}, {{"ABS_X", 5, 5}}, problems));
  static_cast<void>(begin_calibration({}, {}, problems));
  ASSERT_EQ(problems.size(), 2U);
  EXPECT_EQ(problems[0].what, "the device states the range 5 to 5");
  EXPECT_EQ(problems[1].what, "the device has no axis");
}

}  // namespace stick_calibration_test
}  // namespace slew::devices
