// SPDX-License-Identifier: Apache-2.0
// The whole crane at work: what docs/crane.md states of lifting, holding, slewing and lowering.
//
// Expected (computed apart from this program, from the thesis's tables): 33.5 l/min through the section, which is 17.8
// mm/s of the lift piston; slewing at 8 deg/s; a bag that sinks 1.7 mm/s by leaks. The bands leave room for the swing
// of the bag on the oil, which a mean over whole swings does not quite remove (the piston's mean is 17.4 mm/s).
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "build_paths.h"
#include "tests/validation/coupling/coupled_run.h"

namespace slew::coupling::test {
namespace crane_work_test {

constexpr double kDegree = std::numbers::pi / 180;

// A scene's default input from 0 to its end, with the named variables every 10 ms.
class Work {
 public:
  Work(const std::string& file, std::vector<std::string> variables)
      : scene_(scene::load_file(std::string(SLEWRING_SOURCE_DIR) + "/scenes/" + file)) {
    CoupledRun run(scene_);
    EXPECT_TRUE(run.start().is_ok());
    Operator lever(scene_, scene_.session.step_duration());
    const StepIndex steps = scene_.session.steps();
    for (StepIndex n = 0; n <= steps; ++n) {
      if (n % kEvery == 0) {
        for (const std::string& name : variables) curves_[name].push_back(run.variable(name));
      }
      if (n < steps) run.step(lever.controls(run.time()));
    }
    EXPECT_FALSE(run.has_failed());
    EXPECT_EQ(run.flags() & static_cast<std::uint32_t>(StepFlag::coupling_creates_energy), 0u);
  }

  [[nodiscard]] double at(const std::string& name, double t) const { return curves_.at(name)[index(t)]; }
  [[nodiscard]] double rate(const std::string& name, double from, double to) const {
    return (at(name, to) - at(name, from)) / (to - from);
  }
  [[nodiscard]] std::pair<double, double> range(const std::string& name, double from, double to) const {
    const std::vector<double>& curve = curves_.at(name);
    const auto [low, high] = std::minmax_element(curve.begin() + static_cast<std::ptrdiff_t>(index(from)),
                                                 curve.begin() + static_cast<std::ptrdiff_t>(index(to)) + 1);
    return {*low, *high};
  }

 private:
  static constexpr StepIndex kEvery = 10;  // of 1 ms
  static std::size_t index(double t) { return static_cast<std::size_t>(t / 0.01 + 0.5); }

  scene::Scene scene_;
  std::map<std::string, std::vector<double>> curves_;
};

const std::vector<std::string> kPressures = {"Vol_MainPump.pressure", "Vol_LiftCyl_A.pressure",
                                             "Vol_LiftCyl_B.pressure", "Vol_JibCyl_A.pressure"};

std::vector<std::string> with_pressures(std::vector<std::string> names) {
  names.insert(names.end(), kPressures.begin(), kPressures.end());
  return names;
}

TEST(CraneWork, LiftsHoldsAndSlewsTheBag) {
  const Work crane("truck_crane.yaml", with_pressures({"Cyl_Lift.stroke", "Bag.center_of_mass.y",
                                                       "Body_Pillar.position", "Body_Pillar.velocity"}));
  // two swings of the bag
  const double speed = crane.rate("Cyl_Lift.stroke", 2.66, 4.84);
  EXPECT_NEAR(speed, 17.8e-3, 0.04 * 17.8e-3);
  EXPECT_GT(crane.at("Bag.center_of_mass.y", 6.5), crane.at("Bag.center_of_mass.y", 1) + 3);
  // held by the closed section: only leaks move it
  const double sinking = -crane.rate("Bag.center_of_mass.y", 15, 20);
  EXPECT_GT(sinking, 0.5e-3);
  EXPECT_LT(sinking, 3e-3);
  // slewing to the left counts down
  EXPECT_NEAR(-crane.rate("Body_Pillar.position", 6.5, 12), 8 * kDegree, 0.5 * kDegree);
  const auto [slowest, fastest] = crane.range("Body_Pillar.velocity", 19, 20);
  EXPECT_GT(slowest, -0.1 * kDegree);
  EXPECT_LT(fastest, 0.1 * kDegree);
  for (const std::string& volume : kPressures) {
    const auto [low, high] = crane.range(volume, 0, 20);
    EXPECT_GT(low, 0.3e5) << volume;
    EXPECT_LT(high, 250e5) << volume;  // the relief valve opens at 270 bar
  }
}

TEST(CraneWork, LowersTheBagWithoutRunningAway) {
  const Work crane("truck_crane_lower.yaml",
                   with_pressures({"Cyl_Lift.speed", "Cyl_Lift.stroke", "Pillar_LiftBoom.velocity"}));
  // lever at full from 9.5 s to 12 s: the first swing is the fastest, each later one is smaller
  const double first = crane.range("Cyl_Lift.speed", 9.5, 10.5).first;
  const double last = crane.range("Cyl_Lift.speed", 11, 12).first;
  EXPECT_GT(first, -60e-3);
  EXPECT_GT(last, first);
  EXPECT_LT(crane.rate("Cyl_Lift.stroke", 10, 12), -20e-3);
  const auto [slowest, fastest] = crane.range("Cyl_Lift.speed", 13, 16);
  EXPECT_GT(slowest, -2e-3);
  EXPECT_LT(fastest, 2e-3);
  for (const std::string& volume : kPressures) EXPECT_LT(crane.range(volume, 0, 16).second, 250e5) << volume;
}

}  // namespace crane_work_test
}  // namespace slew::coupling::test
