// SPDX-License-Identifier: Apache-2.0
// A log's inputs as a time table: values hold, silence is neutral, and what a session would refuse is left out.
#include <gtest/gtest.h>

#include <limits>

#include "lcm_log/event_log.h"
#include "lcm_log/input_table.h"
#include "tests/unit/lcm_log/input_bytes.h"

namespace input_table_test {

using namespace slew::lcm_log;
using slew::milliseconds;

const std::vector<TableChannel> kChannels = {{"Input_Lift", false}, {"Lamp", true}};

class Log {
 public:
  Log& add(std::int64_t time_us, const slewring::input_t& message) {
    writer_.add({time_us, "X_INPUT", bytes_of(message)}, bytes_);
    return *this;
  }
  Log& add(std::int64_t time_us, const std::string& channel, std::string_view data) {
    writer_.add({time_us, channel, std::as_bytes(std::span<const char>(data.data(), data.size()))}, bytes_);
    return *this;
  }
  [[nodiscard]] InputTable table() const { return input_table(bytes_, kChannels, milliseconds(1), milliseconds(200)); }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  EventLogWriter writer_;
  std::string bytes_;
};

TEST(LcmInputTable, AValueHoldsUntilTheNextAndSilenceIsNeutral) {
  // wall-clock times: the first event of any channel is time 0
  const std::int64_t t = 1'700'000'000'000'000;
  const InputTable table = Log()
                               .add(t, "OTHER", "some bytes")
                               .add(t + 10'000, lift(0, 0.5))
                               .add(t + 110'000, lift(1, 0.5))
                               .add(t + 150'000, lift(2, -0.25))
                               .add(t + 900'000, lift(3, 1))
                               .table();
  EXPECT_EQ(table.problem, "");
  EXPECT_EQ(table.warnings, std::vector<std::string>());
  EXPECT_EQ(table.csv,
            "time,Input_Lift\n"
            "0.01,0\n0.01,0.5\n"
            "0.15,0.5\n0.15,-0.25\n"
            "0.35,-0.25\n0.35,0\n"
            "0.9,0\n0.9,1\n"
            "1.1,1\n1.1,0\n");
}

TEST(LcmInputTable, TwoChannelsAtOneTimeShareTheRows) {
  slewring::input_t lamp = lift(1, 0.7);
  lamp.channel = "Lamp";
  const InputTable table = Log().add(0, lift(0, 0.5)).add(0, lamp).table();
  EXPECT_EQ(table.csv, "time,Input_Lift,Lamp\n0,0,0\n0,0.5,1\n0.2,0.5,1\n0.2,0,0\n");
}

TEST(LcmInputTable, RefusedMessagesAreNamedByCauseAndHaveNoEffect) {
  slewring::input_t other = lift(0, 1);
  other.controller = "pid";
  const InputTable table = Log()
                               .add(0, lift(0, 0.5))
                               .add(1000, lift(1, std::numeric_limits<double>::quiet_NaN()))
                               .add(2000, other)
                               .add(3000, "X_INPUT", "rubbish")
                               .add(4000, lift(5, 7))
                               .table();
  EXPECT_EQ(table.csv, "time,Input_Lift\n0,0\n0,0.5\n0.004,0.5\n0.004,1\n0.204,1\n0.204,0\n");
  ASSERT_EQ(table.warnings.size(), 3u);
  EXPECT_EQ(
      table.warnings[0],
      "inputs of the log that are not applied: 1 another type, 1 not finite, 1 for a channel of another controller");
  EXPECT_EQ(table.warnings[1], "3 inputs are missing in 1 gaps of the log");
  EXPECT_EQ(table.warnings[2], "1 values of the log beyond -1 to 1 are held at the bound");
}

TEST(LcmInputTable, LogsWithoutInputsAreProblems) {
  EXPECT_EQ(input_table("", kChannels, milliseconds(1), milliseconds(200)).problem, "is empty");
  EXPECT_EQ(input_table("time,Input_Lift\n0,1\n", kChannels, milliseconds(1), milliseconds(200)).problem,
            "is no LCM event log");
  EXPECT_EQ(Log().add(0, "OTHER", "bytes").table().problem, "has no input_t message for an input of the scene");
  slewring::input_t wrong = lift(0, 1);
  wrong.channel = "Input_Jib";
  EXPECT_EQ(Log().add(0, wrong).table().problem, "has no input_t message for an input of the scene: 1 no such channel");
  EXPECT_NE(Log()
                .add(0, lift(0, 1))
                .add(200'000, lift(1, 1))
                .add(99'999, lift(2, 1))
                .table()
                .problem.find("falls by more than 100 ms"),
            std::string::npos);
  const auto least = std::numeric_limits<std::int64_t>::min(), most = std::numeric_limits<std::int64_t>::max();
  EXPECT_NE(Log().add(least, lift(0, 1)).add(most, lift(1, 1)).table().problem, "");
}

// as lcm-logger writes them when a long message ends behind a short one
TEST(LcmInputTable, EventsWhoseTimesFallALittleKeepTheirOrder) {
  const InputTable table = Log().add(0, lift(0, 0.5)).add(5000, "OTHER", "").add(4000, lift(1, 1)).table();
  EXPECT_EQ(table.csv, "time,Input_Lift\n0,0\n0,0.5\n0.005,0.5\n0.005,1\n0.205,1\n0.205,0\n");
  EXPECT_EQ(table.warnings,
            std::vector<std::string>{"times of the log fall by up to 1000 us; its events are taken in their order"});
}

TEST(LcmInputTable, ACutLogIsUsedUpToTheCutWithAWarning) {
  const std::string whole = Log().add(0, lift(0, 1)).add(100'000, lift(1, 0.5)).bytes();
  const InputTable table =
      input_table(std::string_view(whole).substr(0, whole.size() - 1), kChannels, milliseconds(1), milliseconds(200));
  EXPECT_EQ(table.csv, "time,Input_Lift\n0,0\n0,1\n0.2,1\n0.2,0\n");
  ASSERT_EQ(table.warnings.size(), 1u);
  EXPECT_NE(table.warnings[0].find("is cut or damaged behind event 1"), std::string::npos);
}

// 1/3 ms has no whole microseconds
TEST(LcmInputTable, TimesOfStepsAreExact) {
  const InputTable table = input_table(Log().add(0, "OTHER", "").add(333, lift(0, 1)).bytes(), kChannels,
                                       slew::SimDuration{333'333}, milliseconds(200));
  EXPECT_EQ(table.csv.substr(0, 31), "time,Input_Lift\n0.000333333,0\n0");
}

}  // namespace input_table_test
