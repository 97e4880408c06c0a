// SPDX-License-Identifier: Apache-2.0
// A session continues from its saved state without a difference: samples, reports, hashes and variables of every later
// step are the same bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>

#include "build_paths.h"
#include "core/allocation_guard.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "node/identity.h"
#include "session_chain.h"
#include "support/nightly.h"

namespace slew::testing {
namespace saved_state_test {

using wire::Role;

scene::Scene load(const std::string& file, const std::vector<std::string>& overrides = {}) {
  return scene::load_file(std::string(SLEWRING_SOURCE_DIR) + "/scenes/" + file, overrides);
}

// Saves at a step, continues in fresh subsystems, and compares every step of both until the end.
void expect_goes_on(const scene::Scene& scene, const Drive& drive, StepIndex at, StepIndex end) {
  SessionChain chain(scene, drive), other(scene, drive);
  chain.start();
  chain.run_to(at);
  const SavedParts saved = chain.save();
  ASSERT_NO_FATAL_FAILURE(other.go_on(saved, chain));
  EXPECT_EQ(other.save(), saved) << "saved again";
  ASSERT_TRUE(other.is_same_as(chain)) << "as loaded";
  while (chain.n() < end) {
    chain.step();
    other.step();
    ASSERT_TRUE(other.is_same_as(chain)) << "saved at step " << at;
  }
  EXPECT_EQ(other.save(), chain.save());
}

// at: of the save; fewer steps where a step is long to compute
struct Length {
  StepIndex at = 100, steps = 100;
};

// ---- every scene ------------------------------------------------------------------------------------------------

std::vector<std::string> all_scenes() {
  std::vector<std::string> names;
  const std::filesystem::path folder = SLEWRING_SOURCE_DIR "/scenes";
  for (const char* part : {"", "contact", "forces", "joints"}) {
    for (const auto& entry : std::filesystem::directory_iterator(folder / part)) {
      if (entry.path().extension() != ".yaml") continue;
      names.push_back(std::filesystem::relative(entry.path(), folder).string());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

class EveryScene : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryScene, GoesOn) {
  const scene::Scene scene = load(GetParam());
  for (const StepIndex at : {0, 100}) expect_goes_on(scene, {}, at, at + rounds<StepIndex>(60, 1000));
}

TEST_P(EveryScene, GoesOnWithAllItsLiveParametersUnderWay) {
  const scene::Scene scene = load(GetParam());
  const Drive drive{.changes = small_changes(scene)};
  ASSERT_FALSE(drive.changes.empty());
  expect_goes_on(scene, drive, 100, 100 + rounds<StepIndex>(60, 1000));
}

std::string name_of(const ::testing::TestParamInfo<std::string>& test) {
  std::string name = test.param.substr(0, test.param.find('.'));
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Scenes, EveryScene, ::testing::ValuesIn(all_scenes()), name_of);

// ---- the ways to compute one ------------------------------------------------------------------------------------

struct Way {
  const char* name;
  const char* file;
  std::vector<std::string> overrides;
  Length length{};
  bool touches = false;  // the boom goes down on a floor just below the bag
};

Drive drive_of(const Way& way) {
  return way.touches ? Drive{.held_sticks = {0, -1, 0}} : Drive{};
}

// or the case would show nothing
void expect_contacts(const scene::Scene& scene, const Drive& drive, StepIndex at) {
  SessionChain chain(scene, drive);
  chain.start();
  chain.run_to(at);
  const auto& mechanics = dynamic_cast<const mechanics_node::MechanicsSubsystem&>(*chain.part(Role::mechanics));
  EXPECT_FALSE(mechanics.state().contacts.states().empty());
}

void PrintTo(const Way& way, std::ostream* out) {
  *out << way.name;
}

class EveryWay : public ::testing::TestWithParam<Way> {};

TEST_P(EveryWay, GoesOn) {
  const auto& [name, file, overrides, length, touches] = GetParam();
  const scene::Scene scene = load(file, overrides);
  const Drive drive = drive_of(GetParam());
  if (touches) expect_contacts(scene, drive, length.at);
  expect_goes_on(scene, drive, length.at, length.at + rounds<StepIndex>(length.steps, 1000));
}

// every scene under its own way does so in the gate
class EveryWayWithChanges : public ::testing::TestWithParam<Way> {};

TEST_P(EveryWayWithChanges, GoesOnWithAllItsLiveParametersUnderWay) {
  const scene::Scene scene = load(GetParam().file, GetParam().overrides);
  Drive drive = drive_of(GetParam());
  drive.changes = small_changes(scene);
  for (const StepIndex at : {11, 100, 350}) expect_goes_on(scene, drive, at, at + 400);
}

constexpr const char* kCrane = "truck_crane.yaml";
// the floor just below the bag: it touches within the first steps
const std::string kFloor = "Ground_Mesh.position=[0, 0.936 m, 0]";
const std::string kTable13 = "hydraulics.start=table13";

constexpr const char* kFlexible = "truck_crane_flexible.yaml";

// in the gate one way for each part of the state: each formulation, integrator with memory, coupling and solver
const std::vector<Way> kCraneWays = {
    {"lagrange", kCrane, {"mechanics.formulation=lagrange"}},
    {"augmented", kCrane, {"mechanics.formulation=augmented"}},
    {"penalty", kCrane, {"mechanics.formulation=penalty"}},
    {"generalised_alpha", kCrane, {"mechanics.integrator=generalised_alpha"}},
    {"hold", kCrane, {"session.coupling=hold"}},
    {"mixed_levels", kCrane, {"Cyl_Lift.coupling=tlm", "Cyl_Jib.coupling=linear"}},
    {"every_fourth", kCrane, {"session.exchange_every=4"}, {101, 100}},
    {"rk4", kCrane, {"hydraulics.solver=rk4", "hydraulics.max_substep=2 us"}, {40, 20}},
    {"implicit_euler", kCrane, {"hydraulics.solver=implicit_euler"}},
    {"quasi_static", kCrane, {"hydraulics.quasi_static_above=2000"}},
    {"from_one_bar", kCrane, {kTable13}, {20, 100}},
    {"oil_temperature",
     kCrane,
     {"hydraulics.oil_temperature=by_volume", "hydraulics.hot_viscosity=7 cSt", "Vol_Tank.rigid_volume=50 l"}},
    {"touching", kCrane, {kFloor}, {300, 60}, true},
    {"touching_augmented", kCrane, {kFloor, "mechanics.formulation=augmented"}, {300, 30}, true}};
const std::vector<Way> kMoreCraneWays = {
    {"euler", kCrane, {"mechanics.integrator=semi_implicit_euler"}},
    {"trapezoidal", kCrane, {"mechanics.integrator=trapezoidal"}},
    {"sdirk2", kCrane, {"mechanics.integrator=sdirk2"}},
    {"lagrange_euler", kCrane, {"mechanics.formulation=lagrange", "mechanics.integrator=semi_implicit_euler"}},
    {"lagrange_alpha", kCrane, {"mechanics.formulation=lagrange", "mechanics.integrator=generalised_alpha"}},
    {"lagrange_sdirk2", kCrane, {"mechanics.formulation=lagrange", "mechanics.integrator=sdirk2"}},
    {"linear", kCrane, {"session.coupling=linear"}},
    {"tlm", kCrane, {"session.coupling=tlm"}},
    {"every_fourth_of_lines", kCrane, {"session.exchange_every=4", "session.coupling=linear"}, {102, 100}},
    {"touching_lagrange", kCrane, {kFloor, "mechanics.formulation=lagrange"}, {300, 60}, true},
    {"touching_trapezoidal", kCrane, {kFloor, "mechanics.integrator=trapezoidal"}, {300, 30}, true}};

const std::vector<Way> kFlexibleWays = {
    {"every_step", kFlexible, {"session.flexible=every_step"}, {60, 40}},
    {"condensed",
     kFlexible,
     {"session.flexible=condensed", "mechanics.integrator=trapezoidal", "mechanics.max_substep=1 ms"},
     {60, 40}},
    {"augmented", kFlexible, {"mechanics.formulation=augmented"}, {40, 20}}};
const std::vector<Way> kMoreFlexibleWays = {{"lagrange", kFlexible, {"mechanics.formulation=lagrange"}, {40, 20}},
                                            {"alpha", kFlexible, {"mechanics.integrator=generalised_alpha"}, {60, 40}}};

const std::vector<Way> kLoopsWays = {{"four_bar_lagrange", "four_bar.yaml", {"mechanics.formulation=lagrange"}},
                                     {"slider_penalty", "slider_crank.yaml", {"mechanics.formulation=penalty"}},
                                     {"slider_alpha", "slider_crank.yaml", {"mechanics.integrator=generalised_alpha"}},
                                     {"tipper_trapezoidal", "tipper.yaml", {"mechanics.integrator=trapezoidal"}}};
const std::vector<Way> kMoreLoopsWays = {
    {"slider_augmented", "slider_crank.yaml", {"mechanics.formulation=augmented"}},
    {"slider_sdirk2", "slider_crank.yaml", {"mechanics.integrator=sdirk2"}, {900, 300}}};

std::string name_of_way(const ::testing::TestParamInfo<Way>& test) {
  return test.param.name;
}

INSTANTIATE_TEST_SUITE_P(Crane, EveryWay, ::testing::ValuesIn(kCraneWays), name_of_way);
INSTANTIATE_TEST_SUITE_P(CraneNightly, EveryWay, ::testing::ValuesIn(kMoreCraneWays), name_of_way);
INSTANTIATE_TEST_SUITE_P(CraneNightly, EveryWayWithChanges, ::testing::ValuesIn(kCraneWays), name_of_way);
INSTANTIATE_TEST_SUITE_P(CraneMoreNightly, EveryWayWithChanges, ::testing::ValuesIn(kMoreCraneWays), name_of_way);
INSTANTIATE_TEST_SUITE_P(Flexible, EveryWay, ::testing::ValuesIn(kFlexibleWays), name_of_way);
INSTANTIATE_TEST_SUITE_P(FlexibleNightly, EveryWay, ::testing::ValuesIn(kMoreFlexibleWays), name_of_way);
INSTANTIATE_TEST_SUITE_P(FlexibleNightly, EveryWayWithChanges, ::testing::ValuesIn(kFlexibleWays), name_of_way);
INSTANTIATE_TEST_SUITE_P(FlexibleMoreNightly, EveryWayWithChanges, ::testing::ValuesIn(kMoreFlexibleWays), name_of_way);
INSTANTIATE_TEST_SUITE_P(Loops, EveryWay, ::testing::ValuesIn(kLoopsWays), name_of_way);
INSTANTIATE_TEST_SUITE_P(LoopsNightly, EveryWay, ::testing::ValuesIn(kMoreLoopsWays), name_of_way);
INSTANTIATE_TEST_SUITE_P(LoopsNightly, EveryWayWithChanges, ::testing::ValuesIn(kLoopsWays), name_of_way);
INSTANTIATE_TEST_SUITE_P(LoopsMoreNightly, EveryWayWithChanges, ::testing::ValuesIn(kMoreLoopsWays), name_of_way);

// ---- samples that are late --------------------------------------------------------------------------------------

TEST(SavedState, OfAFreeRunningSessionHoldsWhatLateSamplesAreComparedWith) {
  const scene::Scene scene =
      load(kCrane, {"session.mode=free_running", "session.step=0.25 ms", "session.coupling_alarm=warn"});
  const Drive drive{.ages = [](StepIndex n) { return std::min<StepIndex>(n, n % 11 == 0 ? 3 : 1 + (n / 7) % 3); }};
  for (const StepIndex at : {0, 3, 160}) expect_goes_on(scene, drive, at, at + rounds<StepIndex>(200, 2000));
}

// ---- what happened to it ----------------------------------------------------------------------------------------

TEST(SavedState, HoldsTheLevelsThatWereChangedLive) {
  const scene::Scene scene = load(kCrane);
  const Drive drive{.changes = {{20, "session.coupling", 3, {}},
                                {40, "Cyl_Lift.coupling", 2, {}},
                                {60, "Cyl_Jib.coupling", 4, {}},
                                {80, "session.coupling", 1, {}}}};
  for (const StepIndex at : {20, 21, 50, 70, 90}) expect_goes_on(scene, drive, at, 150);
}

TEST(SavedState, HoldsASessionThatHasFailed) {
  const scene::Scene scene = load(kCrane);
  const Drive drive;
  for (const Role part : {Role::mechanics, Role::hydraulics}) {
    SessionChain chain(scene, drive), other(scene, drive);
    chain.start();
    chain.run_to(50);
    auto& sample = chain.sample(part == Role::mechanics ? Role::hydraulics : Role::mechanics);
    sample.actuators.F[0] = sample.mechanism.x[0] = std::numeric_limits<double>::quiet_NaN();
    chain.step();
    ASSERT_TRUE(chain.report(part).has(StepFlag::non_finite));
    ASSERT_NO_FATAL_FAILURE(other.go_on(chain.save(), chain));
    for (int i = 0; i < 5; ++i) {
      ASSERT_TRUE(other.is_same_as(chain)) << node::to_text(part);
      chain.step();
      other.step();
    }
  }
}

TEST(SavedState, IsTakenByASubsystemThatWasSomewhereElse) {
  const scene::Scene scene = load(kCrane);
  const Drive drive, other_drive{.changes = small_changes(scene)};
  SessionChain chain(scene, drive), other(scene, other_drive);
  chain.start();
  chain.run_to(100);
  other.start();
  other.run_to(230);
  ASSERT_NO_FATAL_FAILURE(other.go_on(chain.save(), chain));
  for (int i = 0; i < 60; ++i) {
    ASSERT_TRUE(other.is_same_as(chain));
    chain.step();
    other.step();
  }
}

// ---- what cannot be saved ---------------------------------------------------------------------------------------

TEST(SavedState, OfCvodeIsRefusedByName) {
  const scene::Scene scene = load(kCrane, {"hydraulics.solver=cvode"});
  const Drive drive;
  SessionChain chain(scene, drive);
  chain.start();
  const Status status = chain.part(Role::hydraulics)->can_save();
  EXPECT_EQ(status.code, ExitCode::bad_input);
  EXPECT_NE(status.text.find("hydraulics.solver: cvode"), std::string::npos) << status.text;
  std::vector<std::byte> bytes;
  chain.part(Role::hydraulics)->save(bytes);
  EXPECT_TRUE(bytes.empty());
  EXPECT_EQ(chain.part(Role::hydraulics)->load(bytes, chain.sample(Role::hydraulics)).text, status.text);
}

// ---- cost -------------------------------------------------------------------------------------------------------

TEST(SavedState, IsWrittenWithoutAllocation) {
  if (!AllocationGuard::kCounts) GTEST_SKIP() << "a sanitizer is in front of malloc";
  for (const char* file : {kCrane, kFlexible}) {
    const scene::Scene scene = load(file);
    const Drive drive;
    SessionChain chain(scene, drive);
    chain.start();
    chain.run_to(30);
    SavedParts saved = chain.save();
    const SavedParts before = saved;
    for (auto& [role, bytes] : saved) {
      bytes.clear();
      const AllocationGuard guard;
      chain.part(role)->save(bytes);
      EXPECT_EQ(guard.allocations(), 0u) << file << " " << node::to_text(role);
    }
    EXPECT_EQ(saved, before);
  }
}

}  // namespace saved_state_test
}  // namespace slew::testing
