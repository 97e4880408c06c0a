// SPDX-License-Identifier: Apache-2.0
// Fits against a closed form with noise: a block on a rail with gravity a and viscous friction c,
//   x(t) = (a m / c) (t - (m / c) (1 - exp(-c t / m)))
#include <gtest/gtest.h>

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
  EXPECT_NE(refusal({"--map", map, "--free", "Block.mass=-1kg..50kg"}).find("refuses the bound"), std::string::npos);
  EXPECT_NE(refusal({"--map", map, "--free", "a=1m/s2..5m/s2:3"}).find("no count"), std::string::npos);
}

}  // namespace fit_test
}  // namespace slew::testing
