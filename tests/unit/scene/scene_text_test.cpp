// SPDX-License-Identifier: Apache-2.0
// Edits of a scene's text by position.
#include "scene/scene_text.h"

#include <gtest/gtest.h>

#include <cctype>
#include <string>

#include "build_paths.h"
#include "core/input_file.h"
#include "scene/edited_scene.h"
#include "scene/scene.h"
#include "scene/sections.h"
#include "scene/text_references.h"

namespace slew::scene {
namespace scene_text_test {

const std::string kCrane = SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml";

std::string text_of_crane() {
  std::string text;
  EXPECT_FALSE(read_input(kCrane, 1'000'000, text));
  return text;
}

SceneText parsed(std::string text) {
  Report report;
  std::optional<SceneText> read = SceneText::read(std::move(text), report.add_source("test"), report);
  if (!read) report.fail(20);
  return *std::move(read);
}

// The text with the first occurrence of a part replaced.
std::string with(std::string text, const std::string& before, const std::string& after) {
  const std::size_t at = text.find(before);
  EXPECT_NE(at, std::string::npos) << before;
  return at == std::string::npos ? text : text.replace(at, before.size(), after);
}

std::string set(const std::string& text, std::string_view path, std::string_view value) {
  const TextEdit edit = parsed(text).set(path, value);
  EXPECT_EQ(edit.refusal, "") << path;
  return edit.text;
}

std::string refusal(const std::string& text, std::string_view path, std::string_view value) {
  const TextEdit edit = parsed(text).set(path, value);
  EXPECT_EQ(edit.text, text) << path << ": " << value;
  return edit.refusal;
}

// Every field of every element and section, with its text.
std::vector<std::pair<std::string, std::string>> fields_of(const SceneText& scene) {
  std::vector<std::pair<std::string, std::string>> fields;
  for (const Node::Entry& section : scene.root().entries) {
    const bool is_of_elements =
        std::ranges::find(element_sections(), std::string_view(section.key)) != element_sections().end();
    for (const Node::Entry& entry : section.value.entries) {
      if (!is_of_elements) {
        fields.emplace_back(section.key + "." + entry.key, scene.written(entry.value));
        continue;
      }
      for (const Node::Entry& field : entry.value.entries)
        fields.emplace_back(entry.key + "." + field.key, scene.written(field.value));
    }
  }
  return fields;
}

TEST(SceneText, EveryFieldOfTheCraneSetToItsOwnTextLeavesTheFileAsItIs) {
  const SceneText crane = parsed(text_of_crane());
  const auto fields = fields_of(crane);
  EXPECT_GT(fields.size(), 500u);
  for (const auto& [path, value] : fields) {
    const TextEdit edit = crane.set(path, value);
    EXPECT_EQ(edit.refusal, "") << path;
    EXPECT_EQ(edit.text, crane.text()) << path;
  }
}

TEST(SceneText, FieldsOfTheCraneAreSetAndSetBackToTheSameText) {
  const SceneText crane = parsed(text_of_crane());
  const auto fields = fields_of(crane);
  for (std::size_t i = 0; i < fields.size(); i += 7) {
    const auto& [path, value] = fields[i];
    if (value.find('\n') != std::string::npos) continue;
    const TextEdit edit = crane.set(path, "7");
    ASSERT_EQ(edit.refusal, "") << path;
    const SceneText other = parsed(edit.text);
    EXPECT_EQ(other.root().entries.size(), crane.root().entries.size());
    EXPECT_EQ(other.set(path, value).text, crane.text()) << path;
  }
}

TEST(SceneText, AValueChangesAloneAndItsCommentKeepsItsColumn) {
  const std::string crane = text_of_crane();
  EXPECT_EQ(set(crane, "Bag.mass", "1500 kg"), with(crane, "    mass: 500 kg\n", "    mass: 1500 kg\n"));
  const std::string text = "bodies:\n  A:\n    mass: 5 kg      # weighed\n    inertia: [1, 1, 1]  # chosen\n";
  EXPECT_EQ(set(text, "A.mass", "1500 kg"), with(text, "5 kg      #", "1500 kg   #"));
  EXPECT_EQ(set(text, "A.mass", "5"), with(text, "5 kg      #", "5         #"));
  EXPECT_EQ(set(text, "A.mass", "123456789.5 kg"), with(text, "5 kg      #", "123456789.5 kg #"));
}

TEST(SceneText, AKeyIsAddedBehindTheOthersInTheirLayout) {
  const std::string text = "bodies:\n  A: {mass: 5 kg}  # one\n  B:\n    mass: 1 kg  # two\n  # end\n  C:\n";
  EXPECT_EQ(set(text, "A.inertia", "[1, 1, 1]"), with(text, "5 kg}", "5 kg, inertia: [1, 1, 1]}"));
  EXPECT_EQ(set(text, "B.inertia", "[1, 1, 1]"), with(text, "# two\n", "# two\n    inertia: [1, 1, 1]\n"));
  EXPECT_EQ(set(text, "C.mass", "2 kg"), with(text, "  C:\n", "  C:\n    mass: 2 kg\n"));
  EXPECT_EQ(set(text, "session.step", "2 ms"), text + "\nsession:\n  step: 2 ms\n");
  // with the file's own line breaks, and without one at its end
  EXPECT_EQ(set("bodies:\r\n  A:\r\n    mass: 1 kg", "A.inertia", "[1, 1, 1]"),
            "bodies:\r\n  A:\r\n    mass: 1 kg\r\n    inertia: [1, 1, 1]");
}

TEST(SceneText, AnEmptyValueRemovesTheKey) {
  const std::string text =
      "bodies:\n  A: {mass: 5 kg, inertia: [1, 1, 1]}\n  B:\n    # weighed\n    mass: 1 kg  # two\n";
  EXPECT_EQ(set(text, "A.mass", ""), with(text, "mass: 5 kg, ", ""));
  EXPECT_EQ(set(text, "A.inertia", " "), with(text, ", inertia: [1, 1, 1]", ""));
  EXPECT_EQ(set(text, "B.mass", ""), "bodies:\n  A: {mass: 5 kg, inertia: [1, 1, 1]}\n  B: {}\n    # weighed\n");
  EXPECT_EQ(set(text, "B.inertia", ""), text);
}

TEST(SceneText, RowsOfListsAndTextsOfSeveralLinesArePlacesToo) {
  const std::string text =
      "description: >-\n  Two\n  lines.\n\nparameters: {L: 2 m, \"ä\": 1}\nforces:\n  F:\n    points:\n      - [0, 1]\n"
      "      - {x: ${ L * 2 }, y: 1}  # last\n";
  EXPECT_EQ(parsed(text).written(parsed(text).root().find("description")->value), ">-\n  Two\n  lines.");
  EXPECT_EQ(set(text, "description", "one"), with(text, ">-\n  Two\n  lines.", "one"));
  EXPECT_EQ(set(text, "F.points[0]", "[3, 4]"), with(text, "[0, 1]", "[3, 4]"));
  EXPECT_EQ(set(text, "F.points[1].y", "7"), with(text, "y: 1", "y: 7"));
  EXPECT_EQ(set(text, "F.points[1].x", "7"), with(text, "${ L * 2 }", "7"));
  EXPECT_EQ(set(text, "parameters.L", "3 m"), with(text, "2 m", "3 m"));
  EXPECT_EQ(set(text, "F.points", "[[1, 2]]"), with(text, "- [0, 1]\n      - {x: ${ L * 2 }, y: 1}", "[[1, 2]]"));
}

TEST(SceneText, ATextThatChangesMoreThanItsValueIsRefused) {
  const std::string text =
      "bodies:\n  A: {mass: 5 kg, inertia: [1, 1, 1]}\n  B:\n    mass: 1 kg\n    inertia: [1, 1, 1]\n";
  for (const char* const value :
       {"5 kg # heavy", "[1, 2", "'5", "\"5", "5 kg\n    inertia: [2, 2, 2]", "5 kg\n  C: {}", "5: 6", "- 5", "&a 5",
        "*a", "!!int 5", "5 kg\n---\nx: 1", "null", "~", "5\tkg\n}", "\x01", "\xff", "5 kg\n    mass: 6 kg"}) {
    EXPECT_NE(refusal(text, "B.mass", value), "") << value;
  }
  for (const char* const value : {"5, mass2: 6", "5}", "5} # {", "{", "5 kg\n"}) {
    if (std::string_view(value) == "5 kg\n") continue;
    EXPECT_NE(refusal(text, "A.mass", value), "") << value;
  }
  for (const char* const path : {"", ".", "C.mass", "A.mass.x", "A[0]", "A.inertia[7]", "A.inertia[", "A.inertia[1",
                                 "A.inertia[-1]", "A.", "A..x", "../A.mass", "A.inertia[99999999999999999999]"}) {
    EXPECT_NE(refusal(text, path, "1"), "") << path;
  }
  EXPECT_NE(refusal(text, "bodies", ""), "");  // the last section
}

// the text with another word in the place of a whole one, but not of a mesh's file
std::string with_word(const std::string& text, const std::string& word, const std::string& other) {
  const auto is_letter = [&](std::size_t i) {
    return i < text.size() && (std::isalnum(static_cast<unsigned char>(text[i])) != 0 || text[i] == '_');
  };
  std::string result;
  std::size_t done = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + word.size())) {
    const std::size_t end = at + word.size();
    if ((at > 0 && is_letter(at - 1)) || is_letter(end) || text.compare(end, 4, ".stl") == 0) continue;
    result += text.substr(done, at - done) + other;
    done = end;
  }
  return result + text.substr(done);
}

// The renamed scene is the same machine: the names in its canonical text are the only difference.
TEST(SceneText, RenameFollowsAllReferences) {
  const SceneText crane = parsed(text_of_crane());
  const std::string before = load_file(kCrane).expanded_text;
  for (const auto& [name, other] : {std::pair("Truck_LiftBoom", "Boom"), std::pair("Input_Lift", "Lever"),
                                    std::pair("Vol_MainPump", "Supply"), std::pair("Body_Pillar", "Ring")}) {
    const TextEdit edit = crane.rename(name, other);
    ASSERT_EQ(edit.refusal, "") << name;
    EXPECT_FALSE(edit.notes.empty());
    EXPECT_EQ(with_word(before, name, other), load_edited(kCrane, edit.text).expanded_text) << name;
    // and back
    EXPECT_EQ(parsed(edit.text).rename(other, name).text, crane.text());
  }
}

TEST(SceneText, NamesThatAreTakenReservedOrNoWordsAreRefused) {
  const SceneText crane = parsed(text_of_crane());
  for (const char* const name : {"Truck_Hook", "Ground", "session", "two words", "a.b", "", "ä", "1st", "x\ny: 1"}) {
    EXPECT_NE(crane.rename("Bag", name).refusal, "") << name;
    EXPECT_NE(crane.copy("Bag", name).refusal, "") << name;
    EXPECT_NE(crane.add("bodies", "", name).refusal, "") << name;
  }
  EXPECT_NE(crane.rename("Nothing", "X").refusal, "");
  EXPECT_NE(crane.add("bodies", "cube", "X").refusal, "");
  EXPECT_NE(crane.add("nothing", "", "X").refusal, "");
}

TEST(SceneText, ReferencesOfTemplatesGroupsScriptsAndPointsAreFound) {
  const SceneText scene = parsed(R"(templates: {T: {body1: Rod}, U: {type: Rod, mass: 1}}
groups:
  G: {forces: {F: {type: point_force, body: Rod}}}
  H: {bodies: {Rod: {mass: 1}}, forces: {F: {body: Rod}}}
instances: {I: {group: G, parameters: {b: Rod.tip}}}
bodies: {Rod: {mass: 1}, Bar: {relative_to: Rod, mass: 1}, Rod2: {mass: 1}}
joints: {J: {type: revolute, point1: Rod.tip, body2: Rod2, frame2: "Rod.end"}}
plots: {P: {variables: [Rod.position.x, Rod2.position.x, J.position]}}
payload: [Rod]
start: {J: 1 rad}
script: {parameters: [{parameter: Rod.mass, value: 2}]}
)");
  std::vector<std::string> paths;
  for (const TextReference& reference : references_to(scene.root(), "Rod")) paths.push_back(reference.path);
  const std::vector<std::string> expected = {"Bar.relative_to",
                                             "J.point1",
                                             "J.frame2",
                                             "P.variables",
                                             "script.parameters.parameter",
                                             "payload",
                                             "templates.T.body1",
                                             "instances.I.parameters.b",
                                             "groups.G.F.body"};
  EXPECT_EQ(paths, expected);
  const std::string renamed = scene.rename("J", "Hinge").text;
  EXPECT_NE(renamed.find("start: {Hinge: 1 rad}"), std::string::npos);
  EXPECT_NE(renamed.find("Rod2.position.x, Hinge.position]"), std::string::npos);
}

TEST(SceneText, AnElementIsRemovedOnlyWhenNothingNamesIt) {
  const SceneText crane = parsed(text_of_crane());
  const TextEdit refused = crane.remove("Truck_LiftBoom");
  EXPECT_NE(refused.refusal, "");
  EXPECT_EQ(refused.text, crane.text());
  EXPECT_TRUE(std::ranges::any_of(
      refused.notes, [](const std::string& note) { return note.starts_with("Pillar_LiftBoom.body2 (line "); }));
  const TextEdit removed = crane.remove("Slewing");
  EXPECT_EQ(removed.refusal, "");
  EXPECT_EQ(removed.text,
            with(crane.text(), "  Slewing: {title: Slewing angle, variables: [Body_Pillar.position]}\n", ""));
  const std::string one = "bodies:\n  # the only one\n  A: {mass: 1}\n";
  EXPECT_EQ(parsed(one).remove("A").text, "bodies: {}\n  # the only one\n");
  EXPECT_EQ(parsed(parsed(one).remove("A").text).add("bodies", "", "B").text.substr(0, 15), "bodies:\n  B:\n  ");
}

TEST(SceneText, ACopyIsTheSameElementUnderAnotherName) {
  const SceneText crane = parsed(text_of_crane());
  const TextEdit edit = crane.copy("Forces", "Forces_2");
  EXPECT_EQ(edit.text,
            with(crane.text(), "  Pressures:\n",
                 "  Forces_2: {title: Cylinder forces, variables: [Cyl_Lift.force, Cyl_Jib.force]}\n  Pressures:\n"));
  const TextEdit of_body = crane.copy("Bag", "Stone");
  const SceneText copied = parsed(of_body.text);
  const auto names = copied.root().find("bodies")->value.entries;
  EXPECT_EQ(names.back().key, "Stone");
  EXPECT_NE(of_body.text.find("  Stone:                                                 # chosen; A 1 raises"),
            std::string::npos);
  EXPECT_EQ(parsed("bodies: {A: {mass: 1}, B: {mass: 2}}\n").copy("A", "C").text,
            "bodies: {A: {mass: 1}, C: {mass: 1}, B: {mass: 2}}\n");
}

TEST(SceneText, TwoReferencesOfANewElementNameTwoElements) {
  const std::string text = parsed(text_of_crane()).add("forces", "translational", "Spring").text;
  EXPECT_NE(text.find("  Spring:\n    type: translational\n    body1: Truck_Pillar\n    body2: Truck_LiftBoom\n"),
            std::string::npos);
  EXPECT_NO_THROW(static_cast<void>(load_edited(kCrane, text)));
}

// Values that lie in their ranges: reading such an element finds no fault in a single value.
TEST(SceneText, AnElementOfEveryKindIsAddedWithItsRequiredFields) {
  const std::string path = SLEWRING_SOURCE_DIR "/scenes/single_cylinder.yaml";
  std::string text;
  ASSERT_FALSE(read_input(path, 1'000'000, text));
  const SceneText scene = parsed(text);
  for (const ElementTable& table : element_tables()) {
    const TextEdit edit = scene.add(table.section, table.type, "Added");
    ASSERT_EQ(edit.refusal, "") << table.section << " " << table.type;
    const SceneText added = parsed(edit.text);
    const SceneText::Element element = added.find("Added");
    ASSERT_NE(element.entry, nullptr);
    EXPECT_EQ(element.section->key, table.section);
    for (const Field& field : table.fields)
      EXPECT_EQ(element.entry->value.find(field.key) != nullptr, field.presence == Presence::required) << field.key;
    try {
      static_cast<void>(load_edited(path, edit.text));
    } catch (const LoadError& error) {
      for (const Diagnostic& one : error.diagnostics()) {
        EXPECT_EQ(one.what.find("out of range"), std::string::npos) << one.text();
        EXPECT_EQ(one.what.find("the key"), std::string::npos) << one.text();
        EXPECT_EQ(one.what.find("unknown key"), std::string::npos) << one.text();
      }
    }
  }
}

}  // namespace scene_text_test
}  // namespace slew::scene
