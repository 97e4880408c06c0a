// SPDX-License-Identifier: Apache-2.0
// Tables that are too long for a scene's text stay in their files, which nodes, recordings and saved sessions identify
// by their content.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <string>

#include "scene/assets.h"
#include "scene/parameters.h"
#include "scene/scene.h"
#include "scene/script.h"
#include "scene_text.h"
#include "temporary_folder.h"

namespace slew::scene {
namespace table_file_test {

constexpr std::size_t kRows = 20'000;

std::string long_csv(std::size_t rows, const char* head) {
  std::string text = fmt::format("{}\n", head);
  for (std::size_t i = 0; i < rows; ++i) text += fmt::format("{},{}\n", static_cast<double>(i) * 1e-3, i % 7 * 0.1);
  return text;
}

const std::string kSlide =
    "bodies: {B: {mass: 1, inertia: [1, 1, 1]}}\n"
    "joints: {J: {type: prismatic, body2: B}}\n";

class TableFiles : public ::testing::Test {
 protected:
  [[nodiscard]] std::string scripted(const std::string& keys = "") const {
    folder_.write("long.csv", long_csv(kRows, "time,Stick"));
    return folder_.write("scene.yaml", kSlide +
                                           "forces: {F: {type: point_force, body: B, force: 1}}\n"
                                           "inputs: {Stick: {type: analog, primitive: F}}\n"
                                           "script: {file: long.csv" +
                                           keys + "}\n");
  }
  [[nodiscard]] std::string driven() const {
    folder_.write("long.csv", long_csv(kRows, "time [s],F [kN]"));
    return folder_.write("scene.yaml", kSlide + "forces: {F: {type: point_force, body: B, force_table: long.csv}}\n");
  }

  TemporaryFolder folder_;
};

std::string refusal(const std::string& text, const std::string& folder, ScriptFile script) {
  try {
    (void)load_text(text, "scene", {}, folder, script);
  } catch (const LoadError& error) {
    return error.what();
  }
  return "accepted";
}

TEST_F(TableFiles, ALongScriptIsNotInTheTextOfItsScene) {
  const Scene scene = load_file(scripted(", interpolation: step"));
  ASSERT_EQ(scene.script.tracks.size(), 1u);
  EXPECT_EQ(scene.script.tracks[0].points.size(), kRows);
  ASSERT_TRUE(scene.script.file.has_value());
  EXPECT_LT(scene.expanded_text.size(), 10'000u);
  // io needs it, no other node
  EXPECT_TRUE(scene.assets.empty());
  const Scene of_node = load_text(scene.expanded_text, "scene", {}, folder_.path());
  EXPECT_TRUE(of_node.script.tracks.empty());
  EXPECT_EQ(of_node.expanded_text, scene.expanded_text);
  const Scene of_io = load_text(scene.expanded_text, "scene", {}, folder_.path(), ScriptFile::read);
  ASSERT_EQ(of_io.script.tracks.size(), 1u);
  EXPECT_EQ(of_io.script.tracks[0].points, scene.script.tracks[0].points);
  EXPECT_EQ(of_io.script.interpolation, ScriptInterpolation::step);
  EXPECT_EQ(of_io.expanded_text, scene.expanded_text);
}

TEST_F(TableFiles, ALongForceTableIsAnAssetOfTheSession) {
  const Scene scene = load_file(driven());
  EXPECT_EQ(scene.mechanics.point_forces.front().force_table.size(), kRows);
  EXPECT_DOUBLE_EQ(scene.mechanics.point_forces.front().force_table[6][1], 600);
  EXPECT_LT(scene.expanded_text.size(), 10'000u);
  ASSERT_EQ(scene.assets.size(), 1u);
  EXPECT_EQ(scene.assets[0].name, "long.csv");
  EXPECT_TRUE(check_assets(scene.assets, folder_.path()).is_ok());
  const Scene of_node = load_text(scene.expanded_text, "scene", {}, folder_.path());
  EXPECT_EQ(of_node.mechanics.point_forces.front().force_table, scene.mechanics.point_forces.front().force_table);
  EXPECT_EQ(of_node.expanded_text, scene.expanded_text);
}

TEST_F(TableFiles, WithoutTheirFolderTheSceneIsReadAndNeedsThem) {
  const Scene scene = load_file(driven());
  const Scene plain = load_text(scene.expanded_text, "scene");
  EXPECT_TRUE(plain.needs_files());
  EXPECT_EQ(plain.expanded_text, scene.expanded_text);
  EXPECT_FALSE(parameters(plain).empty());
  ParameterDirectory directory(plain);
  EXPECT_TRUE(directory.parse_assignment("B.mass=0.5kg").status.is_ok());
}

TEST_F(TableFiles, AnotherContentIsRefused) {
  const Scene scene = load_file(driven());
  std::string changed = long_csv(kRows, "time [s],F [kN]");
  changed[changed.size() - 2] = '9';
  folder_.write("long.csv", changed);
  EXPECT_NE(refusal(scene.expanded_text, folder_.path(), ScriptFile::left_out)
                .find("long.csv: differs from the file that the scene was read with"),
            std::string::npos);
  EXPECT_FALSE(check_assets(scene.assets, folder_.path()).is_ok());
  const Scene script = load_file(scripted());
  folder_.write("long.csv", "time,Stick\n0,0\n");
  EXPECT_NE(refusal(script.expanded_text, folder_.path(), ScriptFile::read).find("differs from the file"),
            std::string::npos);
}

TEST_F(TableFiles, AShortTableIsPartOfTheText) {
  folder_.write("short.csv", long_csv(kMaxPointsInText, "time [s],F [kN]"));
  const Scene scene = load_file(
      folder_.write("scene.yaml", kSlide + "forces: {F: {type: point_force, body: B, force_table: short.csv}}\n"));
  EXPECT_TRUE(scene.assets.empty());
  EXPECT_FALSE(scene.needs_files());
  EXPECT_EQ(load_text(scene.expanded_text, "scene").mechanics.point_forces.front().force_table.size(),
            kMaxPointsInText);
}

TEST_F(TableFiles, ATrackOfItsOwnFileIsTakenLikeAnyOther) {
  folder_.write("stick.csv", long_csv(kRows, "t [s],raw"));
  const Scene scene =
      load_file(folder_.write("scene.yaml", kSlide + "forces: {F: {type: point_force, body: B, force: 1}}\n"
                                                     "inputs: {Stick: {type: analog, primitive: F}}\n"
                                                     "script: {inputs: {Stick: stick.csv}}\n"));
  EXPECT_LT(scene.expanded_text.size(), 10'000u);
  const Scene again = load_text(scene.expanded_text, "scene", {}, folder_.path());
  EXPECT_EQ(again.script.tracks[0].points, scene.script.tracks[0].points);
  const Scene plain = load_text(scene.expanded_text, "scene");
  EXPECT_EQ(plain.expanded_text, scene.expanded_text);
  EXPECT_EQ(ScriptPlayer(plain).value(0, {0}), 0.0);  // nothing to play, and no fault
}

}  // namespace table_file_test
}  // namespace slew::scene
