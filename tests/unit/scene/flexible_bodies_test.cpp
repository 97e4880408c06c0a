// SPDX-License-Identifier: Apache-2.0
// Flexible bodies of a scene: their files, the selection from them, and all mismatches.
#include "scene/flexible_bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "flex/flexible_files.h"
#include "scene/parameters.h"
#include "scene_text.h"
#include "support/flex_beams.h"
#include "temporary_folder.h"

namespace slew::scene {
namespace flexible_bodies_test {

constexpr const char* kBoom = R"(scene: crane
bodies:
  Boom:
    type: flexible
    flex_file_prefix: beam_hard
    flex_modes: "1;2"
    relative_damping: "0.005;0.01"
  Load: {relative_to: Boom, position: [-6.5 m, 0.02904 m, 0.1507 m], mass: 500 kg, inertia: [10, 10, 10]}
joints:
  Root: {type: revolute, body2: Boom}
  Hook: {type: fixed, body1: Boom, point1: [-6.5 m, 0.02904 m, 0.1507 m], body2: Load}
)";

class FlexibleScene : public ::testing::Test {
 protected:
  void SetUp() override {
    const flex::Reduction reduction =
        flex::reduce(flex::build_beam(flex::testing::jib_boom()), flex::testing::with_modes(4));
    flex::write_flexible_files({folder_.path(), "crane", "beam_hard"}, reduction);
  }

  [[nodiscard]] Scene load(const std::string& text = kBoom, const Overrides& overrides = {}) const {
    return load_file(folder_.write("scene.yaml", text), overrides);
  }
  [[nodiscard]] std::string problems(const std::string& text, const Overrides& overrides = {}) const {
    try {
      (void)load(text, overrides);
    } catch (const LoadError& error) {
      return error.what();
    }
    return {};
  }
  static std::string with(std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  }
  static void expect_part(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  }

  TemporaryFolder folder_;
};

TEST_F(FlexibleScene, FourLinesMakeABodyFlexible) {
  const Scene scene = load();
  ASSERT_EQ(scene.mechanics.flexible_bodies.size(), 1U);
  const multibody::FlexibleBodyDef& boom = scene.mechanics.flexible_bodies[0];
  EXPECT_EQ(boom.body, "Boom");
  EXPECT_EQ(boom.modes->modes(), 2U);
  EXPECT_EQ(boom.relative_damping, (std::vector<double>{0.005, 0.01}));
  EXPECT_NEAR(boom.modes->mass, 127.56, 0.01);
  EXPECT_EQ(scene.assets.size(), flex::flexible_matrices().size());
  EXPECT_EQ(scene.assets[0].name, "crane_beam_hard_Source.dat");
  EXPECT_GT(scene.assets[0].size, 0U);
  EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
}

TEST_F(FlexibleScene, TheTextReadsBackWithTheFilesAndWithout) {
  const Scene scene = load();
  const Scene again = load_text(scene.expanded_text, "again", {}, folder_.path());
  EXPECT_EQ(again.expanded_text, scene.expanded_text);
  EXPECT_EQ(again.mechanics.flexible_bodies[0].modes->stiffness, scene.mechanics.flexible_bodies[0].modes->stiffness);
  const Scene plain = load_text(scene.expanded_text, "again");
  EXPECT_EQ(plain.expanded_text, scene.expanded_text);
  EXPECT_TRUE(plain.has_flexible_bodies());
  EXPECT_EQ(plain.mechanics.flexible_bodies[0].modes, nullptr);
}

TEST_F(FlexibleScene, ModesAreTakenByListByFrequencyOrNotAtAll) {
  const std::string line = "    flex_modes: \"1;2\"\n", damping = "    relative_damping: \"0.005;0.01\"\n";
  const std::string plain = with(kBoom, damping, "");
  const std::string implicit = "mechanics: {integrator: trapezoidal}\n";
  const auto modes = [&](const std::string& instead) {
    return load(with(plain, line, instead) + implicit).mechanics.flexible_bodies[0].modes->modes();
  };
  EXPECT_EQ(modes(line), 2U);
  EXPECT_GE(modes(""), 10U);
  EXPECT_EQ(modes("    flex_frequency_limit: 20 Hz\n"), 2U);
  EXPECT_EQ(modes("    flex_modes: none\n"), 0U);
}

TEST_F(FlexibleScene, OneSettingFreezesTheModes) {
  EXPECT_EQ(load(kBoom, {"Boom.flex_modes=none"}).mechanics.flexible_bodies[0].modes->modes(), 0U);
}

TEST_F(FlexibleScene, DampingAndModesNeedARestartAndARefusalNamesIt) {
  ParameterDirectory directory{load()};
  for (const std::string key : {"Boom.relative_damping", "Boom.flex_modes"}) {
    EXPECT_EQ(directory.parse_assignment(key + "=0.02").status.text,
              key + " takes a text and cannot be changed while the session runs; start it again with --set " + key +
                  "=VALUE");
  }
  EXPECT_EQ(directory.parse_assignment("Boom.flex_frequency_limit=20 Hz").status.text,
            "Boom.flex_frequency_limit cannot be changed while the session runs; start it again with --set "
            "Boom.flex_frequency_limit=VALUE");
}

TEST_F(FlexibleScene, ANodeIsNamedAsIfItWereABody) {
  const std::string named = with(kBoom, "body1: Boom, point1: [-6.5 m, 0.02904 m, 0.1507 m]", "body1: Boom.Node20");
  EXPECT_EQ(problems(named), "");
  expect_part(problems(with(named, "Node20", "Node21")),
              "there is no body 'Boom.Node21'; expected Boom.Node1 to "
              "Boom.Node20, 20 nodes");
  expect_part(problems(with(named, "Boom.Node20", "Load.Node20")), "no body 'Load.Node20'");
}

TEST_F(FlexibleScene, TheModelIsTheSceneUnlessItIsNamed) {
  expect_part(problems(with(kBoom, "scene: crane", "scene: other")), "other_beam_hard_Source.dat");
  EXPECT_EQ(problems(with(with(kBoom, "scene: crane", "scene: other"), "    flex_file",
                          "    flex_model: crane\n    flex_file")),
            "");
}

TEST_F(FlexibleScene, RigidKeysMayStayAndAreComparedWithTheFiles) {
  const auto warnings = [&](const std::string& keys) {
    return load(with(kBoom, "    flex_modes", keys + "    flex_modes")).warnings;
  };
  EXPECT_TRUE(
      warnings("    mass: 127.5618 kg\n    center_of_mass: [-3.25 m, 0.029 m, 0.15 m]\n    inertia: [1, 2, 2]\n")
          .empty());
  const auto other = warnings("    mass: 500 kg\n    center_of_mass: [0, 0, 0]\n");
  ASSERT_EQ(other.size(), 2U);
  expect_part(other[0], "Boom.mass: 500 kg has no effect: the flexible files give 127.55");
  expect_part(other[1], "Boom.center_of_mass: it has no effect: the flexible files give [-3.25");
}

// one line makes a body with a mesh or shapes flexible and back; the mesh is not read
TEST_F(FlexibleScene, KeysOfAMeshOrOfShapesMayStay) {
  for (const char* keys :
       {"inertia: from_mesh\n    mesh: none.stl\n    mesh_unit: 1 m\n    mesh_up: y\n    density: 7850\n",
        "inertia: from_shape\n    shape: sphere\n    radius: 1 m\n    mass: 3 kg\n",
        "inertia: from_parts\n    density: 1\n    parts: [{shape: sphere, radius: 1 m}]\n"}) {
    const std::string text = with(kBoom, "    flex_modes:", std::string("    ") + keys + "    flex_modes:");
    EXPECT_EQ(problems(text), "");
    const Scene scene = load(text);
    EXPECT_TRUE(scene.solid_inertias.empty()) << keys;
    EXPECT_TRUE(scene.warnings.empty()) << keys;
  }
  expect_part(problems(with(kBoom, "    flex_modes:", "    inertia: from_shape\n    shap: sphere\n    flex_modes:")),
              "Boom.shap: unknown key; did you mean 'shape'?");
}

TEST_F(FlexibleScene, StartsByModeOrUndeformed) {
  const auto scene_with = [&](const std::string& keys) {
    return with(kBoom, "    flex_modes", keys + "    flex_modes");
  };
  const auto boom = [&](const std::string& keys) { return load(scene_with(keys)).mechanics.flexible_bodies[0]; };
  EXPECT_TRUE(boom("").start.empty());
  EXPECT_TRUE(boom("").start_rates.empty());
  const std::string given = "    modal_coordinates: \"0.01;-2e-3\"\n    modal_rates: \"0;0.5\"\n";
  EXPECT_EQ(boom(given).start, (std::vector<double>{0.01, -2e-3}));
  EXPECT_EQ(boom(given).start_rates, (std::vector<double>{0, 0.5}));
  EXPECT_EQ(boom("    start_shape: undeformed\n").start, (std::vector<double>{0, 0}));
  const Scene scene = load(scene_with(given));
  EXPECT_EQ(load_text(scene.expanded_text, "again", {}, folder_.path()).expanded_text, scene.expanded_text);
  expect_part(problems(scene_with(given + "    start_shape: undeformed\n")),
              "Boom.start_shape: nothing reads this key with modal_coordinates");
  expect_part(problems(scene_with("    modal_coordinates: 0.01\n")),
              "Boom.modal_coordinates: holds 1 numbers for 2 modes");
  expect_part(problems(scene_with("    modal_rates: \"0;x\"\n")), "Boom.modal_rates: '0;x' is no list of numbers");
}

TEST_F(FlexibleScene, RigidIsTheDefaultType) {
  const std::string named = with(kPendulum, "{mass", "{type: rigid, mass");
  EXPECT_EQ(load_text(named, "test").expanded_text, load_text(kPendulum, "test").expanded_text);
  expect_part(problems_of(with(kPendulum, "{mass", "{type: flexibel, mass")), "did you mean 'flexible'");
}

TEST_F(FlexibleScene, WhatDoesNotFitIsReportedByKey) {
  const auto fault = [&](const std::string& from, const std::string& to) { return problems(with(kBoom, from, to)); };
  expect_part(fault("beam_hard", "beam_soft"), "Boom.flex_file_prefix: ");
  expect_part(fault("beam_hard", "beam_soft"), "slewring flex build");
  expect_part(fault("    flex_file_prefix: beam_hard\n", ""), "the key 'flex_file_prefix' is missing");
  expect_part(fault("\"1;2\"", "\"1;99\""), "Boom.flex_modes: ");
  expect_part(fault("\"1;2\"", "\"1;two\""), "Boom.flex_modes: ");
  expect_part(fault("\"0.005;0.01\"", "\"0.005;0.01;0.02\""), "Boom.relative_damping: holds 3 numbers for 2 modes");
  expect_part(fault("\"0.005;0.01\"", "\"0.005;x\""), "'0.005;x' is no list of numbers");
  expect_part(fault("\"0.005;0.01\"", "\"-1\""), "Boom.relative_damping: -1 is out of range");
  expect_part(fault("    flex_modes: \"1;2\"\n", "    flex_frequency_limit: 1 Hz\n"), "no mode is left below 1 Hz");
  expect_part(fault("    flex_modes", "    flex_mods: 1\n    flex_modes"), "did you mean 'flex_modes'");
}

// the same body, files and joints
std::string in_segments(const std::string& keys) {
  std::string text = kBoom;
  const std::string from = "    type: flexible\n",
                    modes = "    flex_modes: \"1;2\"\n    relative_damping: \"0.005;0.01\"\n";
  text.replace(text.find(modes), modes.size(), keys);
  return text.replace(text.find(from), from.size(), "    type: segmented\n") + "mechanics: {integrator: trapezoidal}\n";
}

TEST_F(FlexibleScene, TheTypeAloneMakesSegmentsOfIt) {
  const Scene scene = load(in_segments("    relative_damping: 0.01\n"));
  EXPECT_TRUE(scene.mechanics.flexible_bodies.empty());
  ASSERT_EQ(scene.mechanics.segmented_bodies.size(), 1U);
  const multibody::SegmentedBodyDef& boom = scene.mechanics.segmented_bodies[0];
  EXPECT_EQ(boom.chain->connectors.size(), 20U);
  EXPECT_EQ(boom.chain->source, "crane_beam_hard");
  EXPECT_EQ(boom.relative_damping, 0.01);
  EXPECT_NEAR(boom.chain->first_frequency, 51.29, 0.01);
  EXPECT_EQ(scene.assets.size(), flex::flexible_matrices().size());
  EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
  EXPECT_EQ(load(in_segments("    segments: 7\n")).mechanics.segmented_bodies[0].chain->connectors.size(), 7U);
  EXPECT_TRUE(scene.has_flexible_bodies());
  const Scene plain = load_text(scene.expanded_text, "again");
  EXPECT_EQ(plain.expanded_text, scene.expanded_text);
  EXPECT_EQ(plain.mechanics.segmented_bodies[0].chain, nullptr);
}

TEST_F(FlexibleScene, NodesOfSegmentsAreNamedAsThoseOfModes) {
  const std::string named =
      with(in_segments(""), "body1: Boom, point1: [-6.5 m, 0.02904 m, 0.1507 m]", "body1: Boom.Node20");
  EXPECT_EQ(problems(named), "");
  expect_part(problems(with(named, "Node20", "Node21")),
              "there is no body 'Boom.Node21'; expected Boom.Node1 to Boom.Node20, 20 nodes");
}

TEST_F(FlexibleScene, KeysOfTheOtherWayAreRefused) {
  expect_part(problems(in_segments("    flex_modes: 1\n")), "Boom.flex_modes: a segmented body has no modes");
  expect_part(problems(in_segments("    flex_frequency_limit: 9 Hz\n")), "a segmented body has no modes");
  expect_part(problems(in_segments("    modal_rates: 1\n")), "Boom.modal_rates: a segmented body has no modes");
  EXPECT_EQ(load(in_segments("    start_shape: undeformed\n")).mechanics.segmented_bodies[0].start,
            multibody::SegmentStart::straight);
  expect_part(problems(with(kBoom, "    flex_modes", "    segments: 3\n    flex_modes")),
              "Boom.segments: a flexible body has no segments");
  expect_part(problems(in_segments("    relative_damping: \"0.005;0.005\"\n")), "is not one number");
  expect_part(problems(in_segments("    relative_damping: -1\n")), "Boom.relative_damping: -1 is out of range");
  expect_part(problems(in_segments("    segments: 0\n")), "Boom.segments: '0' is out of range; expected 1 to 200");
}

TEST_F(FlexibleScene, SegmentsTakeStraightBeamsOnly) {
  flex::BeamDef bent = flex::testing::jib_boom();
  bent.nodes[10].position[1] += 0.1;
  flex::write_flexible_files({folder_.path(), "crane", "beam_hard"},
                             flex::reduce(flex::build_beam(bent), flex::testing::with_modes(4)));
  expect_part(problems(in_segments("")), "Boom.flex_file_prefix: node 11 is off the line");
}

TEST_F(FlexibleScene, AFileThatIsDamagedIsNamed) {
  const std::string file = folder_.path() + "/crane_beam_hard_Modes.dat";
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  expect_part(problems(kBoom), "crane_beam_hard_Modes.dat");
}

TEST_F(FlexibleScene, AManifestDetectsAnotherFile) {
  const Scene scene = load();
  EXPECT_TRUE(check_assets(scene.assets, folder_.path()).is_ok());
  folder_.write("crane_beam_hard_Frequencies.dat", "other");
  const Status status = check_assets(scene.assets, folder_.path());
  EXPECT_EQ(status.code, ExitCode::bad_input);
  expect_part(status.text, "crane_beam_hard_Frequencies.dat");
}

}  // namespace flexible_bodies_test
}  // namespace slew::scene
