// SPDX-License-Identifier: Apache-2.0
// Mass properties judged by what fixed joints make one, repairs on request, and links that move without mass.
// References: sums by hand with parallel axes; principal moments of diagonal tensors.
#include <fmt/format.h>

#include <algorithm>

#include "multibody/build/validate.h"
#include "tests/validation/urdf/imported.h"

namespace slew::urdf {
namespace mass_properties_test {

using testing::Imported;

std::string link(const std::string& name, double mass, const Triple& moments, const Triple& products = {},
                 const std::string& origin = "") {
  return fmt::format(
      "<link name=\"{}\"><inertial>{}<mass value=\"{}\"/><inertia ixx=\"{}\" iyy=\"{}\" izz=\"{}\" ixy=\"{}\" "
      "ixz=\"{}\" iyz=\"{}\"/></inertial></link>\n",
      name, origin, mass, moments[0], moments[1], moments[2], products[0], products[1], products[2]);
}

std::string bare(const std::string& name) {
  return "<link name=\"" + name + "\"/>\n";
}

std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& more = "") {
  return fmt::format("<joint name=\"{}\" type=\"{}\"><parent link=\"{}\"/><child link=\"{}\"/>{}</joint>\n", name, type,
                     parent, child, more);
}

std::string robot(const std::string& lines) {
  return "<robot name=\"r\">\n" + lines + "</robot>\n";
}

constexpr const char* kUp = "<origin xyz=\"0 0 0.5\"/><axis xyz=\"0 1 0\"/>";
constexpr Triple kBall{0.01, 0.01, 0.01};

struct Outcome {
  Import made;
  std::string refusal;
};

Outcome outcome(const std::string& urdf, const Repairs& repairs = {}, RootMount mount = RootMount::fixed) {
  const scene::TemporaryFolder folder;
  const std::string path = folder.write("r.urdf", urdf);
  try {
    return {import_file(path, mount, "", repairs), ""};
  } catch (const scene::LoadError& error) {
    std::string text = error.what();
    for (std::size_t at = text.find(path); at != std::string::npos; at = text.find(path)) text.erase(at, path.size());
    return {{}, text};
  }
}

bool has(const std::vector<Note>& notes, int line, const std::string& part) {
  return std::any_of(notes.begin(), notes.end(),
                     [&](const Note& note) { return note.line == line && note.text.find(part) != std::string::npos; });
}

// a milligram with a tensor that no body has, fixed to a trunk: on Ground it has no effect
TEST(MassProperties, OfTheRootThatBecomesGroundHaveNoEffect) {
  const std::string text = robot(link("base", 1e-6, {1e-6, 1e-6, 1e-6}, {1e-6, 1e-6, 1e-6}) +
                                 link("trunk", 20, {0.2, 0.8, 0.9}) + link("leg", 2, {0.01, 0.01, 0.001}) +
                                 joint("fix", "fixed", "base", "trunk") + joint("hip", "continuous", "trunk", "leg"));
  const Outcome found = outcome(text);
  ASSERT_EQ(found.refusal, "");
  EXPECT_TRUE(has(found.made.notes, 2, "it is part of Ground, where they have no effect"));
  EXPECT_EQ(found.made.bodies, 2U);
  const Imported machine(text);
  EXPECT_EQ(machine.mechanism.model.degrees_of_freedom(), 1);
}

TEST(MassProperties, OfWhatFixedJointsHoldAreSummed) {
  // the same group, free: the sum about its own centre, by hand
  const std::string text = robot(bare("world") + link("base", 0.5, {1e-3, 1e-3, 0.1}) +
                                 link("trunk", 20, {0.2, 0.8, 0.9}, {}, "<origin xyz=\"0.1 0 0\"/>") +
                                 joint("free", "floating", "world", "base") +
                                 joint("fix", "fixed", "base", "trunk", "<origin xyz=\"0 0 0.4\"/>"));
  const Imported machine(text);
  ASSERT_EQ(machine.scene.mechanics.bodies.size(), 1U);
  const multibody::BodyDef& trunk = machine.body("trunk");
  EXPECT_DOUBLE_EQ(trunk.mass, 20.5);
  // centre in the trunk's frame: base at (0, 0, -0.4), trunk at (0.1, 0, 0)
  const double x = 20 * 0.1 / 20.5, z = -0.5 * 0.4 / 20.5;
  EXPECT_NEAR(trunk.center_of_mass[0], x, 1e-15);
  EXPECT_NEAR(trunk.center_of_mass[2], z, 1e-15);
  const double dx1 = -x, dz1 = -0.4 - z, dx2 = 0.1 - x, dz2 = -z;
  EXPECT_NEAR(trunk.inertia[0], 1e-3 + 0.2 + 0.5 * dz1 * dz1 + 20 * dz2 * dz2, 1e-14);
  EXPECT_NEAR(trunk.inertia[1], 1e-3 + 0.8 + 0.5 * (dx1 * dx1 + dz1 * dz1) + 20 * (dx2 * dx2 + dz2 * dz2), 1e-14);
  EXPECT_NEAR(trunk.inertia[2], 0.1 + 0.9 + 0.5 * dx1 * dx1 + 20 * dx2 * dx2, 1e-14);
  EXPECT_NEAR(trunk.products[1], -0.5 * dx1 * dz1 - 20 * dx2 * dz2, 1e-14);
  EXPECT_TRUE(has(outcome(text).made.notes, 4, "links base, trunk: fixed to each other"));
}

// 0.01, 0.01, 0.5 misses the triangle rule by (0.5 - 0.02) / 0.5
TEST(MassProperties, ThatNoBodyHasAreRefusedWithTheirLineAndRepairedOnRequest) {
  const std::string text =
      robot(link("base", 1, kBall) + link("a", 1, {0.01, 0.01, 0.5}) + joint("ja", "continuous", "base", "a", kUp));
  EXPECT_EQ(outcome(text).refusal,
            ":3: link 'a': principal moments 0.01, 0.01, 0.5 kg m2 break the triangle rule by 96 % of the largest; "
            "expected no principal moment below 0 or larger than the sum of the other two; --repair raises those that "
            "are too small");
  const Outcome repaired = outcome(text, {.is_repairing = true});
  ASSERT_EQ(repaired.refusal, "");
  ASSERT_EQ(repaired.made.changes.size(), 1U);
  EXPECT_TRUE(has(repaired.made.changes, 3, "they are now 0.25, 0.25, 0.5 kg m2"));
  EXPECT_NE(repaired.made.text.find("# Changed on request, by its lines:\n#     3  link 'a'"), std::string::npos);
  EXPECT_NE(outcome(text, {.is_repairing = true, .share = 0.9}).refusal.find("--repair-share is 0.9"),
            std::string::npos);
}

TEST(MassProperties, AreRepairedInTheirOwnAxes) {
  // the same tensor turned by 0.5 about x: the repaired tensor keeps the largest moment and its axis
  const double s = std::sin(0.5), c = std::cos(0.5), low = 0.01, high = 0.5;
  const Outcome repaired = outcome(
      robot(bare("base") +
            link("a", 1, {low, low * c * c + high * s * s, low * s * s + high * c * c}, {0, 0, (low - high) * s * c}) +
            joint("ja", "continuous", "base", "a", kUp)),
      {.is_repairing = true});
  ASSERT_EQ(repaired.refusal, "");
  const scene::Scene scene = scene::load_text(repaired.made.text, "repaired");
  const multibody::BodyDef& a = scene.mechanics.bodies.at(0);
  EXPECT_NEAR(a.inertia[0], 0.25, 1e-12);
  EXPECT_NEAR(a.inertia[1], 0.25 * c * c + 0.5 * s * s, 1e-12);
  EXPECT_NEAR(a.products[2], -0.25 * s * c, 1e-12);
}

TEST(MassProperties, NearZeroByRoundingAreZero) {
  const Outcome found = outcome(robot(link("base", 1, {-5e-20, -5e-20, -5e-20}) + link("a", 1, kBall) +
                                      joint("ja", "continuous", "base", "a", kUp)));
  EXPECT_EQ(found.refusal, "");
}

TEST(MassProperties, OfAnInertiaWithoutMassAreNamed) {
  const std::string text =
      robot(link("base", 1, kBall) + link("a", 0, {1, 1, 1}) + link("b", 1, kBall) +
            joint("ja", "continuous", "base", "a", kUp) + joint("jb", "continuous", "a", "b", kUp));
  EXPECT_EQ(outcome(text).refusal.substr(0, 62), ":3: link 'a': the mass is 0 and the inertia is not; expected a");
  const Outcome repaired = outcome(text, {.is_repairing = true, .is_merging = true});
  EXPECT_EQ(repaired.refusal, "");
  EXPECT_TRUE(has(repaired.made.changes, 3, "the inertia is left out"));
}

// ---- what moves without mass ----------------------------------------------------------------------------------------

const std::string kChain = robot(link("base", 1, kBall) + bare("a") + link("b", 1, kBall) +
                                 joint("ja", "revolute", "base", "a",
                                       "<origin xyz=\"0 0 0.2\"/><axis xyz=\"0 1 0\"/><limit lower=\"0.2\" "
                                       "upper=\"0.6\"/>") +
                                 joint("jb", "continuous", "a", "b", kUp));

TEST(MasslessMovers, ThatCarryMassAreRefusedAndMergedOnRequest) {
  EXPECT_EQ(
      outcome(kChain).refusal,
      ":3: link 'a' moves and has no mass; expected an <inertial> in it or in a link fixed to it; --merge fixes its "
      "joint 'ja'");
  const Outcome merged = outcome(kChain, {.is_merging = true});
  ASSERT_EQ(merged.refusal, "");
  EXPECT_TRUE(has(merged.made.changes, 5, "joint 'ja' is fixed: 'a' moves and has no mass"));
  const scene::Scene scene = scene::load_text(merged.made.text, "merged");
  multibody::testing::Mechanism machine(scene.mechanics, scene::row_names(scene));
  EXPECT_EQ(machine.model.degrees_of_freedom(), 1);
  // it stays where it starts, in the middle of its limits: b's joint is 0.5 m further on along the turned z
  const Triple b = machine.pose("b").position;
  EXPECT_NEAR(b[0], 0.5 * std::sin(0.4), 1e-12);
  EXPECT_NEAR(b[2], 0.2 + 0.5 * std::cos(0.4), 1e-12);
}

TEST(MasslessMovers, ThatCarryNoMassAreFixedWithANote) {
  const Outcome found =
      outcome(robot(link("base", 1, kBall) + link("a", 1, kBall) + bare("tool") +
                    joint("ja", "continuous", "base", "a", kUp) + joint("jt", "continuous", "a", "tool", kUp)));
  ASSERT_EQ(found.refusal, "");
  EXPECT_TRUE(has(found.made.notes, 6, "joint 'jt' moves 'tool', which has no mass and carries none: it is fixed"));
  EXPECT_EQ(found.made.bodies, 2U);
}

TEST(MasslessMovers, WithoutInertiaAboutTheirAxisAreRefusedAndMergedOnRequest) {
  const std::string text =
      robot(link("base", 1, kBall) + link("a", 1, {0, 0, 0}) + joint("ja", "continuous", "base", "a", kUp));
  EXPECT_EQ(outcome(text).refusal,
            ":4: what hangs on joint 'ja' has no inertia about its axis; expected an inertia about the axis; --merge "
            "fixes the joint");
  const Outcome merged = outcome(text, {.is_merging = true});
  EXPECT_EQ(merged.refusal, "");
  EXPECT_TRUE(has(merged.made.changes, 4, "it is fixed"));
}

TEST(MasslessMovers, AloneAreNoMachine) {
  const Outcome found = outcome(robot(bare("base") + bare("a") + joint("ja", "continuous", "base", "a", kUp)));
  EXPECT_EQ(found.refusal, ": no link of the robot has mass; expected a machine: <inertial> in its links");
}

// ---- mimic ----------------------------------------------------------------------------------------------------------

std::string follower(const std::string& type, const std::string& mimic, const std::string& axis = "0 1 0") {
  return joint("jb", type, "base", "b", "<axis xyz=\"" + axis + "\"/>" + mimic);
}

std::string pair(const std::string& leader_type, const std::string& follower_type, const std::string& mimic,
                 const std::string& limits = "") {
  return robot(bare("base") + link("a", 1, kBall, {}, "<origin xyz=\"0 0 0.1\"/>") +
               link("b", 2, kBall, {}, "<origin xyz=\"0 0 0.2\"/>") +
               joint("ja", leader_type, "base", "a", "<axis xyz=\"0 1 0\"/>" + limits) +
               follower(follower_type, mimic));
}

struct Coordinates {
  double q1, q2;
};
Coordinates after(const std::string& urdf, double time) {
  Imported robot(urdf);
  robot.mechanism.run(time, 1e-3);
  return {robot.mechanism.value("ja.position"), robot.mechanism.value("jb.position")};
}

TEST(Mimic, HoldsItsRatioAndOffsetBetweenAnglesAndWays) {
  const auto turning =
      after(pair("continuous", "continuous", "<mimic joint=\"ja\" multiplier=\"-2\" offset=\"0.3\"/>"), 0.7);
  EXPECT_GT(std::fabs(turning.q1), 0.1) << "it moves";
  EXPECT_NEAR(turning.q2, -2 * turning.q1 + 0.3, 1e-10);
  const auto sliding = after(pair("prismatic", "prismatic", "<mimic joint=\"ja\" multiplier=\"0.5\"/>"), 0.3);
  EXPECT_NEAR(sliding.q2, 0.5 * sliding.q1, 1e-10);
  const auto rack =
      after(pair("continuous", "prismatic", "<mimic joint=\"ja\" multiplier=\"0.1\" offset=\"0.02\"/>"), 0.3);
  EXPECT_NEAR(rack.q2, 0.1 * rack.q1 + 0.02, 1e-10);
  const auto pinion =
      after(pair("prismatic", "continuous", "<mimic joint=\"ja\" multiplier=\"4\" offset=\"0.2\"/>"), 0.3);
  EXPECT_NEAR(pinion.q2, 4 * pinion.q1 + 0.2, 1e-10);
}

TEST(Mimic, StartsWhereBothLimitsAllow) {
  const std::string text =
      pair("revolute", "revolute", "<mimic joint=\"ja\" multiplier=\"2\"/><limit lower=\"0.6\" upper=\"0.8\"/>",
           "<limit lower=\"-1\" upper=\"1\"/>");
  const Coordinates start = after(text, 0);
  EXPECT_NEAR(start.q1, 0.35, 1e-12);
  EXPECT_NEAR(start.q2, 0.7, 1e-12);
}

TEST(Mimic, OfAMultiplierOfZeroIsAFixedJoint) {
  const std::string text = pair("continuous", "continuous", "<mimic joint=\"ja\" multiplier=\"0\" offset=\"0.4\"/>");
  const Outcome found = outcome(text);
  ASSERT_EQ(found.refusal, "");
  EXPECT_TRUE(has(found.made.notes, 6, "follows 'ja' with the multiplier 0: it is fixed"));
  Imported machine(text);
  EXPECT_EQ(machine.mechanism.model.degrees_of_freedom(), 1);
}

TEST(Mimic, OfALeaderWithoutMassLeavesTheFollowersCoupled) {
  const std::string text =
      robot(bare("base") + bare("drum") + link("a", 1, kBall, {}, "<origin xyz=\"0 0 0.1\"/>") +
            link("b", 2, kBall, {}, "<origin xyz=\"0 0 0.2\"/>") + joint("jd", "continuous", "base", "drum") +
            joint("ja", "continuous", "base", "a", "<axis xyz=\"0 1 0\"/><mimic joint=\"jd\" multiplier=\"2\"/>") +
            joint("jb", "continuous", "base", "b", "<axis xyz=\"0 1 0\"/><mimic joint=\"jd\" multiplier=\"-3\"/>"));
  Imported machine(text);
  EXPECT_EQ(machine.mechanism.model.degrees_of_freedom(), 1);
  const Coordinates later = after(text, 0.5);
  EXPECT_NEAR(later.q2, -1.5 * later.q1, 1e-10);
}

// the cap of 32 rows is gone
TEST(ManyJoints, WithLimitsAreTaken) {
  std::string lines = bare("l0");
  for (int i = 1; i <= 60; ++i) {
    lines += link(fmt::format("l{}", i), 1, kBall) +
             joint(fmt::format("j{}", i), "revolute", fmt::format("l{}", i - 1), fmt::format("l{}", i),
                   "<origin xyz=\"0 0 0.1\"/><axis xyz=\"0 1 0\"/><limit lower=\"-1\" upper=\"1\"/>");
  }
  const Imported machine(robot(lines));
  EXPECT_EQ(machine.mechanism.model.row_count(), 60);
}

}  // namespace mass_properties_test
}  // namespace slew::urdf
