// SPDX-License-Identifier: Apache-2.0
// Verdicts of a stress test on a cell, against stated bounds and a yardstick.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "analysis/stress/stress.h"

namespace slew::analysis {
namespace stress_verdict_test {

// health of 10000 steps; misses come alone
wire::Health timing(double missed, double p99, std::uint64_t longest_row = 1) {
  wire::Health health;
  health.response.count = health.release_jitter.count = 10000;
  health.overruns = static_cast<std::uint64_t>(10000 * missed);
  health.longest_overrun = longest_row;
  health.response.p99 = p99;
  return health;
}

struct Reported {
  std::string verdict;
  int code;
};

Reported report_of(const wire::Health& session, const wire::Health& yardstick, StressBounds bounds = {0.01, 500e-6}) {
  Stress stress;
  stress.bounds = bounds;
  StressCell& cell = stress.cells.emplace_back();
  cell.nodes[static_cast<std::size_t>(wire::Role::io)] = session;
  cell.yardstick = yardstick;
  const auto json = nlohmann::json::parse(report_json(stress));
  return {json.at("cells").at(0).at("verdict"), json.at("exit_code")};
}

TEST(StressVerdict, NamesTheBoundsThatTheBareLoopsBreakToo) {
  const wire::Health good = timing(0.005, 400e-6), late = timing(0.02, 400e-6), slow = timing(0.005, 600e-6),
                     bad = timing(0.02, 600e-6);
  EXPECT_EQ(report_of(good, bad).verdict, "within");
  EXPECT_EQ(report_of(good, bad).code, 0);
  EXPECT_EQ(report_of(bad, bad).verdict, "over, as the yardstick");
  EXPECT_EQ(report_of(bad, bad).code, 3);
  EXPECT_EQ(report_of(late, bad).verdict, "over, as the yardstick");
  EXPECT_EQ(report_of(bad, good).verdict, "over; the yardstick misses 0.500 %, p99 400 us");
  EXPECT_EQ(report_of(late, slow).verdict, "over; the yardstick misses 0.500 %, p99 600 us")
      << "each is over another bound";
  EXPECT_EQ(report_of(bad, {}).verdict, "over") << "no text on a yardstick that did not run";
  EXPECT_EQ(report_of(bad, late).verdict, "over, as the yardstick in misses alone");
  EXPECT_EQ(report_of(bad, slow).verdict, "over, as the yardstick at p99 alone");
}

TEST(StressVerdict, AYardstickThatMissesLessIsNoExcuse) {
  // 2 % of 10000 beside as many: two standard errors are 0.4 % when misses come alone
  EXPECT_EQ(report_of(timing(0.0239, 0), timing(0.02, 0)).verdict, "over, as the yardstick");
  EXPECT_EQ(report_of(timing(0.0241, 0), timing(0.02, 0)).verdict, "over; the yardstick misses 2.000 %, p99 0 us");
  EXPECT_EQ(report_of(timing(0.0241, 0), timing(0.02, 0)).code, 3);
  EXPECT_EQ(report_of(timing(0.0239, 0), timing(0.02, 0)).code, 3);
  // 0.8 % when they come four in a row, and never more than half of the yardstick's
  EXPECT_EQ(report_of(timing(0.0279, 0, 100), timing(0.02, 0, 4)).verdict, "over, as the yardstick");
  EXPECT_EQ(report_of(timing(0.0281, 0, 100), timing(0.02, 0, 4)).verdict,
            "over; the yardstick misses 2.000 %, p99 0 us");
  EXPECT_EQ(report_of(timing(0.0299, 0), timing(0.02, 0, 200)).verdict, "over, as the yardstick");
  EXPECT_EQ(report_of(timing(0.0301, 0), timing(0.02, 0, 200)).verdict, "over; the yardstick misses 2.000 %, p99 0 us");
  // a tenth at p99
  EXPECT_EQ(report_of(timing(0, 659e-6), timing(0, 600e-6)).verdict, "over, as the yardstick");
  EXPECT_EQ(report_of(timing(0, 661e-6), timing(0, 600e-6)).verdict, "over; the yardstick misses 0.000 %, p99 600 us");
  EXPECT_EQ(report_of(timing(0.5, 660e-6), timing(0.02, 600e-6)).verdict, "over, as the yardstick at p99 alone");
}

TEST(StressVerdict, StepsThatWereGivenUpAreMissesAndHaveAColumn) {
  Stress stress;
  stress.bounds = {0.1, -1};
  StressCell& cell = stress.cells.emplace_back();
  cell.steps = 6000;
  cell.step = 1e-3;
  cell.response.name = "a cell";
  cell.response.time = cell.response.values = {1, 2};
  wire::Health& io = cell.nodes[static_cast<std::size_t>(wire::Role::io)];
  io.response.count = 8000;
  io.release_jitter.count = 5600;  // finished steps
  io.overruns = 2408;
  const auto json = nlohmann::json::parse(report_json(stress)).at("cells").at(0);
  EXPECT_EQ(json.at("verdict"), "over");
  EXPECT_EQ(json.at("session").at("skipped"), 2400);
  EXPECT_EQ(json.at("session").at("missed_share"), 0.301);
  const std::string text = report_text(stress);
  EXPECT_NE(text.find("skipped  missed"), std::string::npos) << text;
  EXPECT_NE(text.find("8000   2400     2408    30.100"), std::string::npos) << text;
  EXPECT_NE(report_html(stress).find("a cell: 30.100 % of 8000 steps missed, 2400 of them skipped"), std::string::npos);
}

TEST(StressReport, HasTheLatencyOfEachDevice) {
  Stress stress;
  StressCell& cell = stress.cells.emplace_back();
  cell.steps = 6000;
  cell.step = 1e-3;
  cell.load = Load::mixed;
  session::DeviceOutcome& rig = cell.devices.emplace_back();
  rig.name = "Rig";
  rig.summary =
      Json{{"packets", {{"used", 500}, {"lost", 3}, {"refused", Json::object()}}},
           {"inputs", {{"written", 490}, {"latency", {{"count", 480}, {"p50", 2e-3}, {"p99", 4e-3}, {"max", 9e-3}}}}}};
  cell.devices.push_back(
      {.name = "Stick", .summary = std::nullopt, .fault = "killed by signal 9 (Killed)", .hangs = 1});
  const std::string text = report_text(stress);
  EXPECT_NE(text.find("normal, load mixed, 0 us: device Rig: 500 packets used, 3 lost; 490 values written; 2 ms from "
                      "an event to the first sample that used it, 4 ms p99, 9 ms max\n"),
            std::string::npos)
      << text;
  EXPECT_NE(
      text.find("device Stick: ended early, its inputs went to neutral: killed by signal 9 (Killed); 1 time without "
                "a sign of life for 2 s; no summary\n"),
      std::string::npos)
      << text;
  const auto devices = nlohmann::json::parse(report_json(stress)).at("cells").at(0).at("devices");
  EXPECT_EQ(devices.at("Rig").at("summary").at("inputs").at("latency").at("p99"), 4e-3);
  EXPECT_EQ(devices.at("Stick").at("hangs"), 1);
}

TEST(StressVerdict, IsGivenOfWhatIsStatedAlone) {
  EXPECT_EQ(report_of(timing(1, 1), timing(1, 1), {}).verdict, "");
  EXPECT_EQ(report_of(timing(1, 1), timing(1, 1), {}).code, 0);
  EXPECT_EQ(report_of(timing(1, 400e-6), timing(1, 1), {-1, 500e-6}).verdict, "within");
}

TEST(StressVerdict, NothingMeasuredKeepsNoBound) {
  EXPECT_EQ(report_of({}, {}).verdict, "over");
  EXPECT_EQ(report_of({}, {}).code, 3);
}

// a cell that ended with this code before its first step, and without a word
Stress not_begun(ExitCode code) {
  Stress stress;
  StressCell& cell = stress.cells.emplace_back();
  cell.code = code;
  cell.step = 1e-3;
  cell.yardstick_loops.resize(4);
  return stress;
}

TEST(StressVerdict, ACellThatDidNotBeginHasNoResults) {
  const Stress stress = not_begun(ExitCode::failed);
  const std::string text = report_text(stress);
  EXPECT_NE(text.find("failed with code 1"), std::string::npos) << text;
  EXPECT_EQ(text.find("steps due"), std::string::npos) << text;
  EXPECT_EQ(text.find("yardstick"), std::string::npos) << text;
  EXPECT_EQ(text.find("0.000"), std::string::npos) << text;
  const auto json = nlohmann::json::parse(report_json(stress)).at("cells").at(0);
  EXPECT_EQ(json.at("exit_code"), 1);
  EXPECT_EQ(json.at("steps"), 0);
  for (const char* measured : {"session", "yardstick", "books"}) EXPECT_FALSE(json.contains(measured)) << measured;
}

TEST(StressVerdict, ACellEndedByASignalIsInterrupted) {
  for (const ExitCode code : {ExitCode::interrupted, ExitCode::terminated}) {
    Stress stress = not_begun(code);
    const std::string text = report_text(stress);
    EXPECT_NE(text.find("interrupted"), std::string::npos) << text;
    EXPECT_EQ(text.find("failed"), std::string::npos) << text;
    EXPECT_EQ(text.find("steps due"), std::string::npos) << text;
    // a cell that had begun is reported
    stress.cells.front().steps = 100;
    EXPECT_NE(report_text(stress).find("steps due"), std::string::npos);
  }
}

}  // namespace stress_verdict_test
}  // namespace slew::analysis
