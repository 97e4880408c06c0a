// SPDX-License-Identifier: Apache-2.0
// Fits against a closed form with noise: a block on a rail with gravity a and viscous friction c,
//   x(t) = (a m / c) (t - (m / c) (1 - exp(-c t / m)))
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "command.h"

namespace slew::testing {
namespace fit_test {

using Json = nlohmann::json;

constexpr double kMass = 10, kA = 2.5, kC = 8;  // kg, m/s2, N s/m: the truth
constexpr double kNoise = 1e-3;                 // m
constexpr int kSamples = 150;

constexpr const char* kRail = R"(
parameters: {a: 2 m/s2}
bodies:
  Block: {mass: 10 kg, inertia: [0.1, 0.1, 0.1]}
joints:
  Rail: {type: prismatic, orientation1: [0, 90 deg, 0], body2: Block, orientation2: [0, 90 deg, 0], viscous_friction: 4 Ns/m}
mechanics: {gravity: ["${a}", 0, 0]}
session: {duration: 1 s}
)";

class Fit : public ::testing::Test {
 protected:
  Fit() {
    std::ofstream(work_.path() / "rail.yaml") << kRail;
    std::ofstream data(work_.path() / "measured.csv");
    data << "time [ms],way [mm]\n";
    std::mt19937_64 generator(11);
    const auto uniform = [&] { return (static_cast<double>(generator() >> 11) + 0.5) * 0x1p-53; };
    for (int i = 0; i < kSamples; ++i) {
      const double t = 2.0 * i / kSamples;
      const double x = kA * kMass / kC * (t - kMass / kC * (1 - std::exp(-kC * t / kMass)));
      const double normal = std::sqrt(-2 * std::log(uniform())) * std::cos(2 * M_PI * uniform());
      data << 1e3 * t << ',' << 1e3 * (x + kNoise * normal) << '\n';
    }
  }
  CommandResult fit(std::vector<std::string> more) {
    more.insert(more.begin(), {"fit", "rail.yaml", "--data", "measured.csv", "--quiet"});
    return run("slewring", more, work_.path());
  }
  [[nodiscard]] Json result(const std::string& folder) const {
    std::ifstream in(work_.path() / folder / "fit.json");
    return Json::parse(in);
  }

  WorkFolder work_;
};

TEST_F(Fit, FindsTheTruthBehindNoiseWithinItsIntervals) {
  const std::vector<std::string> arguments = {
      "--map", "way=Block.position.x", "--free", "a=1m/s2..5m/s2", "--free", "Rail.viscous_friction=1Ns/m..30Ns/m"};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = arguments;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  const CommandResult command = fit(with({"-o", "out", "--workers", "3"}));
  ASSERT_EQ(command.code, 0) << command.err << command.out;
  const Json found = result("out");
  const double truth[] = {kA, kC};
  for (std::size_t k = 0; k < 2; ++k) {
    const Json& value = found["values"][k];
    const double low = value["interval"][0], high = value["interval"][1], after = value["after"];
    // half of a 95 % interval is about two standard errors
    EXPECT_LT(std::fabs(after - truth[k]), high - low) << k;
    EXPECT_FALSE(value["is_at_bound"].get<bool>());
  }
  // standard errors of the closed form's own Jacobian at the truth
  double aa = 0, ac = 0, cc = 0;
  for (int i = 0; i < kSamples; ++i) {
    const auto x = [&](double a, double c) {
      const double t = 2.0 * i / kSamples;
      return a * kMass / c * (t - kMass / c * (1 - std::exp(-c * t / kMass)));
    };
    const double da = (x(kA + 1e-4, kC) - x(kA - 1e-4, kC)) / 2e-4, dc = (x(kA, kC + 1e-4) - x(kA, kC - 1e-4)) / 2e-4;
    aa += da * da, ac += da * dc, cc += dc * dc;
  }
  const double det = aa * cc - ac * ac;
  const double errors[] = {kNoise * std::sqrt(cc / det), kNoise * std::sqrt(aa / det)};
  for (std::size_t k = 0; k < 2; ++k) {
    const Json& interval = found["values"][k]["interval"];
    const double half = (interval[1].get<double>() - interval[0].get<double>()) / 2;
    // 1.976: quantile for 148 degrees of freedom; the noise's own estimate scatters by 6 %
    EXPECT_NEAR(half / (1.976 * errors[k]), 1, 0.2) << k;
  }
  EXPECT_NEAR(found["correlations"][1].get<double>(), -ac / std::sqrt(aa * cc), 0.02);
  EXPECT_NEAR(found["signals"][0]["rms"][1].get<double>(), kNoise, 0.2 * kNoise);
  EXPECT_GT(found["signals"][0]["rms"][0].get<double>(), 20 * kNoise);
  EXPECT_TRUE(std::filesystem::file_size(work_.path() / "out" / "index.html") > 1000);
  // the same bits with one worker, and again from the runs that are kept
  ASSERT_EQ(fit(with({"-o", "one", "--workers", "1"})).code, 0);
  EXPECT_EQ(result("one")["values"], found["values"]);
  ASSERT_EQ(fit(with({"-o", "out"})).code, 0);
  EXPECT_EQ(result("out")["values"], found["values"]);
}

// a transducer with an offset and hardly any noise: of all free values none changes its signal
TEST_F(Fit, AnOffsetThatNoValueMendsDoesNotEndTheSearch) {
  std::ifstream in(work_.path() / "measured.csv");
  std::ofstream out(work_.path() / "two.csv");
  std::string line;
  for (int row = 0; std::getline(in, line); ++row) {
    out << line << (row == 0 ? ",side [mm]" : row % 2 == 0 ? ",5.0001" : ",4.9999") << '\n';
  }
  out.close();
  const CommandResult command =
      run("slewring",
          {"fit", "rail.yaml", "--data", "two.csv", "--quiet", "--map", "way=Block.position.x", "--map",
           "side=Block.position.y", "--set", "Rail.viscous_friction=8Ns/m", "--free", "a=1m/s2..5m/s2", "-o", "out"},
          work_.path());
  ASSERT_EQ(command.code, 0) << command.err << command.out;
  const Json found = result("out");
  EXPECT_NEAR(found["values"][0]["after"].get<double>(), kA, 0.002);
  EXPECT_NEAR(found["signals"][0]["rms"][1].get<double>(), kNoise, 0.2 * kNoise);
  EXPECT_NEAR(found["signals"][1]["rms"][1].get<double>(), 5e-3, 1e-6);
}

// Errors of 1 mm in x, and y and z, which no value changes, measured without error (z is simulated as 7e-17 m, which
// has no weight): the same interval as of x alone.
TEST_F(Fit, ExactSignalsDoNotNarrowTheIntervalOfAnother) {
  std::ifstream in(work_.path() / "measured.csv");
  std::ofstream out(work_.path() / "three.csv");
  std::string line;
  for (int row = 0; std::getline(in, line); ++row) out << line << (row == 0 ? ",y [m],z [m]" : ",0,0") << '\n';
  out.close();
  const auto width = [this](const std::vector<std::string>& maps) {
    std::vector<std::string> arguments = {
        "fit",    "rail.yaml",      "--data", "three.csv", "--quiet", "--set", "Rail.viscous_friction=8Ns/m",
        "--free", "a=1m/s2..5m/s2", "-o",     "out",       "--anew"};
    for (const std::string& map : maps) arguments.insert(arguments.end(), {"--map", map});
    const CommandResult command = run("slewring", arguments, work_.path());
    EXPECT_EQ(command.code, 0) << command.err << command.out;
    EXPECT_NEAR(result("out")["values"][0]["after"].get<double>(), kA, 2e-3);
    const Json interval = result("out")["values"][0]["interval"];
    return interval[1].get<double>() - interval[0].get<double>();
  };
  const double alone = width({"way=Block.position.x"});
  EXPECT_NEAR(width({"way=Block.position.x", "y=Block.position.y", "z=Block.position.z"}), alone, 1e-3 * alone);
}

// The interval of a reaches about 0.3 mm/s2 to each side.
TEST_F(Fit, AnIntervalWiderThanItsBoundsIsNotDetermined) {
  const std::vector<std::string> map = {"--map", "way=Block.position.x", "--set", "Rail.viscous_friction=8Ns/m"};
  const auto half_of = [&](const std::string& low, const std::string& high, int code) {
    std::vector<std::string> arguments = map;
    arguments.insert(arguments.end(), {"--set", "a=" + low, "--free", "a=" + low + ".." + high, "-o", "out", "--anew"});
    const CommandResult command = fit(arguments);
    EXPECT_EQ(command.code, code) << command.err << command.out;
    const Json value = result("out")["values"][0];
    EXPECT_EQ(value["is_beyond_range"], code == 1);
    return 0.5 * (value["interval"][1].get<double>() - value["interval"][0].get<double>());
  };
  const auto at = [](double a) { return std::to_string(a) + "m/s2"; };
  const double half = half_of("1m/s2", "5m/s2", 0);
  half_of(at(kA - 0.75 * half), at(kA + 0.75 * half), 1);
  half_of(at(kA - 1.5 * half), at(kA + 1.5 * half), 0);
}

TEST_F(Fit, StopsAtABoundAndReportsIt) {
  const CommandResult command = fit({"--map", "way=Block.position.x", "--set", "Rail.viscous_friction=8Ns/m", "--free",
                                     "a=1m/s2..2.2m/s2", "-o", "out"});
  EXPECT_EQ(command.code, 0) << command.err << command.out;
  EXPECT_EQ(result("out")["values"][0]["is_at_bound"], true);
  EXPECT_NEAR(result("out")["values"][0]["after"].get<double>(), 2.2, 1e-5);
  EXPECT_NE(command.out.find("at its bound"), std::string::npos) << command.out;
}

// m x'' = m a - c x': without c the mass has no effect
TEST_F(Fit, ReportsValuesThatTheDataDoNotDetermine) {
  const CommandResult command = fit({"--map", "way=Block.position.x", "--set", "Rail.viscous_friction=0", "--free",
                                     "a=1m/s2..5m/s2", "--free", "Block.mass=5kg..20kg", "-o", "out"});
  EXPECT_EQ(command.code, 1) << command.err << command.out;
  EXPECT_NE(command.out.find("The data do not determine the values"), std::string::npos) << command.out;
}

// the motion has c / m alone, and a: an interval of a stays, c and m have none though the search finds some pair
TEST_F(Fit, NamesTheCombinationThatTheDataDoNotSeparate) {
  const CommandResult command =
      fit({"--map", "way=Block.position.x", "--free", "a=1m/s2..5m/s2", "--free", "Block.mass=5kg..20kg", "--free",
           "Rail.viscous_friction=2Ns/m..20Ns/m", "-o", "out"});
  EXPECT_EQ(command.code, 1) << command.err << command.out;
  const Json found = result("out");
  EXPECT_EQ(found["is_determined"], false);
  const Json& values = found["values"];
  ASSERT_TRUE(values[0]["interval"].is_array()) << command.out;
  EXPECT_NEAR(values[0]["after"].get<double>(), kA, 0.05);
  EXPECT_TRUE(values[1]["interval"].is_null()) << command.out;
  EXPECT_TRUE(values[2]["interval"].is_null()) << command.out;
  EXPECT_NEAR(values[2]["after"].get<double>() / values[1]["after"].get<double>(), kC / kMass, 0.02);
  // c and m by the same part of themselves
  ASSERT_EQ(found["undetermined"].size(), 1u) << command.out;
  const Json& parts = found["undetermined"][0];
  ASSERT_EQ(parts.size(), 2u) << parts;
  EXPECT_NEAR(parts[0]["change"].get<double>() / parts[1]["change"].get<double>(), 1, 0.05) << parts;
  for (const char* name : {"Block.mass by", "Rail.viscous_friction by"}) {
    EXPECT_NE(command.out.find(name), std::string::npos) << command.out;
  }
}

TEST_F(Fit, KeepsTheResultOfAnotherFitInItsFolder) {
  const std::vector<std::string> first = {"--map", "way=Block.position.x",        "--free", "a=1m/s2..5m/s2",
                                          "--set", "Rail.viscous_friction=8Ns/m", "-o",     "out"};
  ASSERT_EQ(fit(first).code, 0);
  const Json before = result("out");
  const auto refusal = [&](std::size_t place, const std::string& value, const std::string& reason) {
    std::vector<std::string> other = first;
    other[place] = value;
    const CommandResult command = fit(other);
    EXPECT_EQ(command.code, 2) << value;
    EXPECT_NE(command.err.find("holds rows of another fit: " + reason), std::string::npos) << command.err;
    EXPECT_EQ(result("out"), before) << value;
  };
  refusal(3, "a=1m/s2..4m/s2", "--free differs");
  refusal(1, "way=Block.position.x * 1", "--map differs");
  refusal(5, "Rail.viscous_friction=7Ns/m", "the scene has changed");
  std::ofstream(work_.path() / "measured.csv", std::ios::app) << "2100,5000\n";
  refusal(3, first[3], "the measured data differ");
  // no sweep either
  const CommandResult swept = run(
      "slewring",
      {"sweep", "rail.yaml", "--vary", "a=1m/s2,2m/s2", "--measure", "max(Block.position.x)", "--anew", "-o", "out"},
      work_.path());
  EXPECT_EQ(swept.code, 2);
  EXPECT_NE(swept.err.find("holds the results of a fit"), std::string::npos) << swept.err;
  EXPECT_EQ(result("out"), before);
  std::vector<std::string> repeated = first;
  repeated.emplace_back("--anew");
  EXPECT_EQ(fit(repeated).code, 0);
  EXPECT_NE(result("out"), before);
}

// the lock of a program that still runs; the kernel frees it with the program
TEST_F(Fit, RefusesAFolderInWhichAnotherProgramWorks) {
  std::filesystem::create_directories(work_.path() / "out");
  const int lock = open((work_.path() / "out" / "lock").c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666);
  ASSERT_EQ(flock(lock, LOCK_EX | LOCK_NB), 0);
  const std::vector<std::string> fitted = {"--map", "way=Block.position.x",        "--free", "a=1m/s2..5m/s2",
                                           "--set", "Rail.viscous_friction=8Ns/m", "-o",     "out"};
  const std::vector<std::string> swept = {
      "sweep", "rail.yaml", "--vary", "a=1m/s2,2m/s2", "--measure", "max(Block.position.x)", "-o", "out", "--quiet"};
  for (const CommandResult& command : {fit(fitted), run("slewring", swept, work_.path())}) {
    EXPECT_EQ(command.code, 2) << command.out;
    EXPECT_NE(command.err.find("is in use by another sweep or fit"), std::string::npos) << command.err;
  }
  close(lock);
  EXPECT_EQ(fit(fitted).code, 0);
}

TEST_F(Fit, RefusesBeforeAnyRun) {
  const auto refusal = [this](std::vector<std::string> more) {
    more.insert(more.end(), {"-o", "none"});
    const CommandResult command = fit(more);
    EXPECT_EQ(command.code, 2) << command.out;
    EXPECT_FALSE(std::filesystem::exists(work_.path() / "none"));
    return command.err;
  };
  const std::string map = "way=Block.position.x", free = "a=1m/s2..5m/s2";
  EXPECT_NE(refusal({"--map", "wey=Block.position.x", "--free", free}).find("did you mean 'way'?"), std::string::npos);
  EXPECT_NE(refusal({"--map", "way=Block.velocity.x", "--free", free}).find("the column is a length"),
            std::string::npos);
  EXPECT_NE(refusal({"--map", "way=Blok.position.x", "--free", free}).find("did you mean 'Block.position.x'?"),
            std::string::npos);
  EXPECT_NE(refusal({"--map", map, "--free", "a=3m/s2..5m/s2"}).find("lies outside of the range"), std::string::npos);
  EXPECT_NE(refusal({"--map", map, "--free", "Block.mass=-1kg..50kg"}).find("refuses the value"), std::string::npos);
  // a whole number does not vary continuously
  EXPECT_NE(
      refusal({"--map", map, "--free", "recording.every=1..8"}).find("refuses the value 'recording.every=3.67376"),
      std::string::npos);
  std::ofstream(work_.path() / "twice.csv") << "time [s],way [m],way [m]\n0,0,1\n1,1,2\n";
  const CommandResult twice = run(
      "slewring", {"fit", "rail.yaml", "--data", "twice.csv", "--map", map, "--free", free, "-o", "none", "--quiet"},
      work_.path());
  EXPECT_EQ(twice.code, 2) << twice.out;
  EXPECT_NE(twice.err.find("twice.csv:1:18: 'way [m]' and 'way [m]' are both named 'way'"), std::string::npos)
      << twice.err;
  // a signal counts once
  EXPECT_NE(refusal({"--map", map, "--map", map, "--free", free}).find("the column 'way' is given twice"),
            std::string::npos);
  EXPECT_NE(refusal({"--map", map, "--map", "way=Block.position.y", "--free", free})
                .find("the column 'way' is given twice ('way=Block.position.x' and 'way=Block.position.y')"),
            std::string::npos);
  EXPECT_NE(refusal({"--map", map, "--map", "other= Block.position.x", "--free", free})
                .find("' Block.position.x' is given twice"),
            std::string::npos);
  EXPECT_NE(refusal({"--map", map, "--free", "a=1m/s2..5m/s2:3"}).find("no count"), std::string::npos);
  EXPECT_NE(refusal({"--map", map, "--free", free, "--free", "a=1m/s2..4m/s2"}).find("--free a is given twice"),
            std::string::npos);
}

}  // namespace fit_test
}  // namespace slew::testing
