// SPDX-License-Identifier: Apache-2.0
// What an editor of a scene is given: elements, fields, kinds, problems and refusals.
#include "scene/scene_outline.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "build_paths.h"
#include "core/failure.h"
#include "core/input_file.h"
#include "scene/sections.h"
#include "temporary_folder.h"

namespace slew::scene {
namespace scene_outline_test {

const std::string kCrane = SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml";

std::string text_of_crane() {
  std::string text;
  EXPECT_FALSE(read_input(kCrane, 1'000'000, text));
  return text;
}

const Json& element(const Json& outline, const std::string& name) {
  for (const Json& one : outline.at("elements").items()) {
    if (one.at("name").text() == name) return one;
  }
  throw Failure(ExitCode::failed, "no element " + name);
}

TEST(SceneOutline, HasEveryElementWithItsFieldsAsWritten) {
  const Json outline = outline_json(kCrane, text_of_crane(), {});
  EXPECT_TRUE(outline.at("problems").items().empty());
  const Json& bag = element(outline, "Bag");
  EXPECT_EQ(bag.at("fields").at("mass").at("text").text(), "500 kg");
  EXPECT_EQ(bag.at("fields").at("orientation").at("text").text(), "[-10 deg, 0, 0]");
  EXPECT_GT(bag.at("line").integer(), 50);
  EXPECT_EQ(element(outline, "session").at("fields").at("step").at("text").text(), "1 ms");
  EXPECT_EQ(element(outline, "Pillar_LiftBoom").at("type").text(), "revolute");
}

TEST(SceneOutline, ProblemsHaveThePathAndTheLineOfTheirField) {
  const EditedText edited = edit_text(kCrane, text_of_crane(), {{"set", "Bag.mass"}, {"value", "-1 kg"}});
  EXPECT_EQ(edited.refusal, "");
  const Json outline = outline_json(kCrane, edited.text, {});
  ASSERT_EQ(outline.at("problems").items().size(), 1u);
  const Json& problem = outline.at("problems").items().front();
  EXPECT_EQ(problem.at("path").text(), "Bag.mass");
  EXPECT_EQ(problem.at("line").integer(), element(outline, "Bag").at("fields").at("mass").at("line").integer());
  // a text that is no YAML
  EXPECT_FALSE(outline_json(kCrane, "bodies: [", {}).at("problems").items().empty());
  EXPECT_NE(edit_text(kCrane, "bodies: [", {{"set", "Bag.mass"}, {"value", "1 kg"}}).refusal, "");
}

TEST(SceneOutline, KindsHaveTheFieldsOfTheTables) {
  std::size_t count = 0;
  const Json kinds = kinds_json();
  for (const Json& kind : kinds.items()) {
    if (kind.find("is_single") != nullptr) continue;
    const auto table = std::ranges::find_if(element_tables(), [&](const ElementTable& one) {
      return one.section == kind.at("section").text() && one.type == kind.at("type").text();
    });
    ASSERT_NE(table, element_tables().end());
    EXPECT_EQ(kind.at("fields").items().size(), table->fields.size() + table->lists.size());
    ++count;
  }
  EXPECT_EQ(count, element_tables().size());
}

TEST(SceneOutline, ElementsOfOtherFilesAndInstancesAreRefusedWithTheirPlace) {
  const TemporaryFolder folder;
  folder.write("side.yaml", "bodies:\n  Rod: {mass: 2 kg, inertia: [1, 1, 1]}\n");
  folder.write("base.yaml", "bodies:\n  Base: {mass: 3 kg, inertia: [1, 1, 1]}\n");
  const std::string text =
      "include: [base.yaml, {file: side.yaml, prefix: Left_}]\ntemplates: {T: {mass: 4 kg}}\ngroups:\n"
      "  G: {bodies: {Rod: {mass: 1 kg, inertia: [1, 1, 1]}}}\ninstances: {Own: {group: G}}\nbodies:\n"
      "  A: {use: T, inertia: [1, 1, 1]}\njoints:\n";
  std::string joints;
  for (const char* const body : {"A", "Base", "Left_Rod", "Own_Rod"})
    joints += std::string("  J_") + body + ": {type: revolute, body2: " + body + "}\n";
  const std::string path = folder.write("scene.yaml", text + joints);
  const Json outline = outline_json(path, text + joints, {});
  EXPECT_TRUE(outline.at("problems").items().empty()) << outline.dump(2);
  EXPECT_EQ(element(outline, "Left_Rod").at("place").text(), folder.path() + "/side.yaml:2");
  EXPECT_EQ(element(outline, "Base").at("place").text(), folder.path() + "/base.yaml:2");
  EXPECT_EQ(element(outline, "Own_Rod").at("place").text(), path + ":4");
  EXPECT_EQ(element(outline, "A").at("given").at("mass").at("text").text(), "4 kg");
  EXPECT_EQ(element(outline, "A").at("given").at("mass").at("place").text(), path + ":2");
  for (const Json& request : {Json{{"set", "Left_Rod.mass"}, {"value", "1 kg"}}, Json{{"remove", "Left_Rod"}},
                              Json{{"rename", "Left_Rod"}, {"to", "X"}}, Json{{"copy", "Left_Rod"}, {"to", "X"}}}) {
    const EditedText edited = edit_text(path, text + joints, request);
    EXPECT_NE(edited.refusal.find("side.yaml:2"), std::string::npos) << edited.refusal;
    EXPECT_EQ(edited.text, text + joints);
  }
  // over a template the element has a key of its own
  EXPECT_EQ(edit_text(path, text + joints, {{"set", "A.mass"}, {"value", "5 kg"}}).refusal, "");
}

TEST(SceneOutline, ARenameIsRefusedWhileIncludedFilesNameTheElement) {
  const TemporaryFolder folder;
  folder.write("side.yaml",
               "joints:\n  Side: {type: revolute, body2: Arm}\n\nbodies:\n  Base: {mass: 3 kg, inertia: [1, 1, 1]}\n");
  const std::string text =
      "include: side.yaml\nbodies:\n  Arm: {mass: 1 kg, inertia: [1, 1, 1]}\n  Own: {mass: 1 kg, inertia: [1, 1, 1]}\n"
      "  Base: {mass: 4 kg}\njoints:\n  J: {type: revolute, body1: Arm, body2: Own}\n  K: {type: revolute, body2: "
      "Base}\n";
  const std::string path = folder.write("scene.yaml", text);
  ASSERT_TRUE(outline_json(path, text, {}).at("problems").items().empty()) << outline_json(path, text, {}).dump(2);
  const EditedText refused = edit_text(path, text, {{"rename", "Arm"}, {"to", "Boom"}});
  EXPECT_NE(refused.refusal.find("included files name 'Arm'"), std::string::npos) << refused.refusal;
  EXPECT_EQ(refused.notes, std::vector<std::string>{"Side.body2 (" + folder.path() + "/side.yaml:2)"});
  EXPECT_EQ(refused.text, text);
  // a part of the element itself
  const EditedText overlay = edit_text(path, text, {{"rename", "Base"}, {"to", "Foot"}});
  ASSERT_FALSE(overlay.notes.empty()) << overlay.refusal;
  EXPECT_NE(overlay.notes[0].find("side.yaml:5"), std::string::npos) << overlay.notes[0];
  const EditedText done = edit_text(path, text, {{"rename", "Own"}, {"to", "Boom"}});
  EXPECT_EQ(done.refusal, "");
  EXPECT_TRUE(outline_json(path, done.text, {}).at("problems").items().empty());
}

TEST(SceneOutline, HasTheNamedPointsOfBodiesInMetres) {
  const TemporaryFolder folder;
  const std::string text =
      "parameters: {reach: 2.5 m}\nbodies:\n  Arm:\n    mass: 1 kg\n    inertia: [1, 1, 1]\n"
      "    points: {tip: [\"${reach}\", 0, -20 mm], eye: {position: [1, 2, 3]}, wrong: [1 kg, 0, 0]}\n"
      "joints:\n  J: {type: revolute, body2: Arm}\n";
  const Json points = outline_json(folder.write("scene.yaml", text), text, {}).at("points");
  ASSERT_EQ(points.items().size(), 2u) << points.dump(2);
  EXPECT_EQ(points.items()[0].at("name").text(), "Arm.eye");
  EXPECT_EQ(points.items()[1].at("name").text(), "Arm.tip");
  EXPECT_EQ(points.items()[1].at("body").text(), "Arm");
  EXPECT_EQ(points.items()[1].at("position").dump(), "[2.5,0.0,-0.02]");
}

TEST(SceneOutline, RequestsOfAnotherFormAreRefused) {
  for (const Json& request : {Json{{"set", 5}}, Json{{"set", "Bag.mass"}}, Json{{"copy", "Bag"}}, Json{{"add", "X"}}})
    EXPECT_THROW(static_cast<void>(edit_text(kCrane, text_of_crane(), request)), Failure);
  EXPECT_EQ(edit_text(kCrane, text_of_crane(), Json::object()).text, text_of_crane());
}

}  // namespace scene_outline_test
}  // namespace slew::scene
