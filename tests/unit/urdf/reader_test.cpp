// SPDX-License-Identifier: Apache-2.0
// Invalid contents of a URDF file are refused with their line; omitted contents are noted with their line.
#include "urdf/reader.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "build_paths.h"
#include "tests/unit/scene/temporary_folder.h"
#include "urdf/import.h"

namespace slew::urdf {
namespace reader_test {

const std::string kLink =
    "<link name=\"a\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/></inertial></link>\n";

// links base and a, line 2 and 3, then the lines of the case from 4 on
std::string robot(const std::string& lines) {
  return "<robot name=\"test\">\n<link name=\"base\"/>\n" + kLink + lines + "</robot>\n";
}

std::string joint(const std::string& attributes, const std::string& children) {
  return "<joint name=\"j\" " + attributes + "><parent link=\"base\"/><child link=\"a\"/>" + children + "</joint>\n";
}

std::string problems_of(const std::string& text) {
  scene::Report report;
  const int source = report.add_source("r.urdf");
  const auto checked = scene::check_source(text, source, report);
  if (checked && read_robot(*checked, report)) return "";
  try {
    report.fail(20);
  } catch (const scene::LoadError& error) {
    return error.what();
  }
}

std::vector<Note> notes_of(const std::string& text) {
  scene::Report report;
  const auto checked = scene::check_source(text, report.add_source("r.urdf"), report);
  const auto robot = read_robot(*checked, report);
  EXPECT_TRUE(robot.has_value()) << problems_of(text);
  return robot ? robot->notes : std::vector<Note>();
}

TEST(UrdfReader, RefusesWhatIsNoRobot) {
  EXPECT_EQ(problems_of(""), "r.urdf: is not well-formed XML: empty document; expected a URDF file");
  EXPECT_EQ(problems_of("<robot name=\"x\">\n<link name=\"a\">\n</robot>"),
            "r.urdf:2: is not well-formed XML: mismatched element; expected a URDF file");
  EXPECT_EQ(problems_of("<mujoco/>"),
            "r.urdf:1: the root element is <mujoco>; expected <robot>, the root of a URDF file");
  EXPECT_EQ(problems_of("<robot name=\"x\"/>"), "r.urdf:1: the robot has no links; expected at least one <link>");
  // thousands of levels end in a message, not in the stack
  std::string deep = "<robot name=\"x\">";
  for (int i = 0; i < 100000; ++i) deep += "<a>";
  EXPECT_EQ(problems_of(deep), "r.urdf:1: is not well-formed XML: xml element depth exceeded; expected a URDF file");
}

TEST(UrdfReader, RefusesMacros) {
  EXPECT_EQ(problems_of(robot("<xacro:arm/>\n")),
            "r.urdf:4: <xacro:arm> is a macro; expected a file without macros: xacro robot.urdf.xacro > robot.urdf")
      << "the tree is not looked at when a part could not be read";
}

TEST(UrdfReader, RefusesNumbersThatAreNone) {
  const auto with_mass = [](const std::string& value) {
    return problems_of("<robot name=\"x\">\n<link name=\"a\"><inertial>\n<mass value=\"" + value +
                       "\"/>\n<inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/></inertial></link></robot>");
  };
  EXPECT_EQ(with_mass("2.5"), "");
  EXPECT_EQ(with_mass(" +2.5e-1 "), "");
  for (const char* bad : {"", "x", "1,5", "0x10", "nan", "inf", "1e999", "1 2", "${m}", "+-1", "--1"}) {
    EXPECT_EQ(with_mass(bad),
              std::string("r.urdf:3: link 'a': <mass value> is '") + bad + "'; expected a finite number");
  }
  EXPECT_EQ(with_mass("-1"), "r.urdf:3: link 'a': <mass value> is -1; expected at least 0");
  EXPECT_EQ(with_mass("-5e-20"), "") << "rounding of a zero";
}

TEST(UrdfReader, RefusesIncompleteParts) {
  const auto with_inertial = [](const std::string& content) {
    return problems_of("<robot name=\"x\">\n<link name=\"a\">\n<inertial>" + content + "</inertial></link></robot>");
  };
  EXPECT_EQ(
      with_inertial("<mass value=\"1\"/>"),
      "r.urdf:3: link 'a': <inertial> has no <inertia>; expected <inertia ixx=... ixy=... .../>; 0 for a point mass");
  EXPECT_EQ(with_inertial("<inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/>"),
            "r.urdf:3: link 'a': <inertial> has no <mass>; expected <mass value=\"...\"/>");
  EXPECT_EQ(with_inertial("<mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\"/>"),
            "r.urdf:3: link 'a': <inertia izz> is missing; expected a number");
  EXPECT_EQ(with_inertial("<origin xyz=\"1 2\"/><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/>"),
            "r.urdf:3: link 'a': <origin xyz> is '1 2'; expected three finite numbers");
}

// none of two would be the one that is meant
TEST(UrdfReader, RefusesASecondElementOfAKindThatCountsOnce) {
  const std::string one = "<origin/>\n<axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\"/><dynamics/>";
  EXPECT_EQ(problems_of(robot(joint("type=\"revolute\"", one))), "");
  const auto refusal = [](const char* tag) {
    return "r.urdf:5: joint 'j': <joint> has a second <" + std::string(tag) + ">; expected one";
  };
  for (const auto& [tag, second] :
       {std::pair("origin", "<origin xyz=\"1 0 0\"/>"), std::pair("axis", "<axis xyz=\"1 0 0\"/>"),
        std::pair("limit", "<limit lower=\"-2\" upper=\"2\"/>"), std::pair("dynamics", "<dynamics damping=\"1\"/>"),
        std::pair("parent", "<parent link=\"base\"/>"), std::pair("child", "<child link=\"a\"/>")}) {
    EXPECT_EQ(problems_of(robot(joint("type=\"revolute\"", one + second))), refusal(tag));
  }
  const auto of_link = [](const std::string& children) {
    return problems_of("<robot name=\"x\">\n<link name=\"l\">\n" + children + "</link></robot>");
  };
  EXPECT_EQ(
      of_link("<inertial>\n<mass value=\"1\"/><mass value=\"2\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/></inertial>"),
      "r.urdf:4: link 'l': <inertial> has a second <mass>; expected one");
  EXPECT_EQ(
      of_link("<inertial>\n<mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/><inertia ixx=\"2\" iyy=\"2\" "
              "izz=\"2\"/></inertial>"),
      "r.urdf:4: link 'l': <inertial> has a second <inertia>; expected one");
  EXPECT_EQ(of_link("<collision><geometry><sphere radius=\"1\"/>\n<box size=\"1 1 1\"/></geometry></collision>"),
            "r.urdf:4: link 'l': <geometry> has a second shape, <box>; expected one; a <collision> for each shape");
}

TEST(UrdfReader, RefusesJointsThatAreNone) {
  const std::string limit = "<limit lower=\"-1\" upper=\"1\"/>";
  EXPECT_EQ(problems_of(robot(joint("type=\"revolute\"", limit))), "");
  EXPECT_EQ(
      problems_of(robot(joint("type=\"hinge\"", ""))),
      "r.urdf:4: joint 'j': the type 'hinge' is unknown; expected revolute, continuous, prismatic, fixed, floating or "
      "planar");
  EXPECT_EQ(problems_of(robot(joint("type=\"continuous\"", "<axis xyz=\"0 0 0\"/>"))),
            "r.urdf:4: joint 'j': the axis is zero; expected a direction");
  EXPECT_EQ(problems_of(robot(joint("type=\"continuous\"", "<dynamics damping=\"-1\"/>"))),
            "r.urdf:4: joint 'j': <dynamics damping> is -1; expected at least 0");
}

TEST(UrdfReader, RefusesWhatIsNoTree) {
  const auto fixed = [](const std::string& name, const std::string& parent, const std::string& child) {
    return "<joint name=\"" + name + "\" type=\"fixed\"><parent link=\"" + parent + "\"/><child link=\"" + child +
           "\"/></joint>\n";
  };
  EXPECT_EQ(problems_of(robot("")), "r.urdf:3: link 'a' has no parent, and 'base' has none either; expected one root");
  EXPECT_EQ(problems_of(robot(fixed("j", "base", "b"))),
            "r.urdf:4: joint 'j': there is no link 'b'; expected the name of a link");
  EXPECT_EQ(problems_of(robot(fixed("j", "a", "a"))),
            "r.urdf:4: joint 'j': parent and child are the same link; expected two links");
  EXPECT_EQ(problems_of(robot(fixed("j", "base", "a") + fixed("k", "base", "a"))),
            "r.urdf:5: link 'a' is the child of joint 'j' already; expected a tree: loops are closed in the scene "
            "afterwards");
  EXPECT_EQ(problems_of(robot(fixed("j", "base", "a") + fixed("k", "a", "base"))),
            "r.urdf:2: every link has a parent; expected one link without a parent");
  const std::string doubled = problems_of(robot(fixed("j", "base", "a") + fixed("j", "a", "base")));
  EXPECT_TRUE(doubled.starts_with("r.urdf:5: joint 'j': is there twice (first in line 4)")) << doubled;
  const std::string circle = "<link name=\"c\"/>\n<link name=\"d\"/>\n" + fixed("j", "base", "a") +
                             fixed("k", "c", "d") + fixed("l", "d", "c");
  EXPECT_EQ(problems_of(robot(circle)), "r.urdf:4: link 'c' is its own ancestor; expected a tree");
}

TEST(UrdfReader, ReportsEverythingAtOnce) {
  const std::string text = problems_of(robot(joint("type=\"revolut\"", "") + "<link name=\"a\"/>\n<link/>\n"));
  EXPECT_NE(text.find("r.urdf:4: "), std::string::npos) << text;
  EXPECT_NE(text.find("r.urdf:5: link 'a': is there twice (first in line 3)"), std::string::npos) << text;
  EXPECT_NE(text.find("r.urdf:6: <link name> has no value"), std::string::npos) << text;
}

std::vector<std::string> texts_of(const std::vector<Note>& notes) {
  std::vector<std::string> texts;
  for (const Note& note : notes) texts.push_back(std::to_string(note.line) + " " + note.text);
  return texts;
}

TEST(UrdfReader, NotesWhatItLeavesOut) {
  const auto notes =
      notes_of(robot(joint("type=\"continuous\"", "\n<safety_controller k_velocity=\"1\"/>\n<limit effort=\"3\"/>") +
                     "<transmission name=\"t\"/>\n<gazebo reference=\"a\"/>\n<material name=\"red\"/>\n"));
  const std::vector<std::string> expected = {
      "5 joint 'j': <safety_controller> is not taken over", "7 <transmission name=\"t\"> is not taken over",
      "8 <gazebo> is not taken over", "9 materials and colours are not taken over",
      "6 bounds of effort and velocity are not taken over: j"};
  EXPECT_EQ(texts_of(notes), expected);
}

TEST(UrdfReader, TakesLimitsWithoutMotionAsNone) {
  const auto read = [](const std::string& type, const std::string& limit) {
    const std::string text = robot(joint("type=\"" + type + "\"", limit));
    scene::Report report;
    const auto checked = scene::check_source(text, report.add_source("r.urdf"), report);
    const auto found = read_robot(*checked, report);
    return found ? *found : Robot{};
  };
  for (const char* limits : {"0\" upper=\"0", "1\" upper=\"-1", "0.5\" upper=\"0.5"}) {
    const Robot turning = read("revolute", std::string("<limit lower=\"") + limits + "\"/>");
    EXPECT_EQ(turning.joints.at(0).kind, JointKind::continuous);
    const Robot sliding = read("prismatic", std::string("<limit lower=\"") + limits + "\"/>");
    EXPECT_EQ(sliding.joints.at(0).kind, JointKind::prismatic);
    EXPECT_FALSE(sliding.joints.at(0).is_limited);
    EXPECT_NE(texts_of(sliding.notes).at(0).find("leave no motion and are not taken over"), std::string::npos);
  }
  EXPECT_EQ(texts_of(read("revolute", "").notes).at(0), "4 joint 'j': has no <limit>: it moves without limits");
  EXPECT_TRUE(read("revolute", "<limit lower=\"-1\" upper=\"1\"/>").joints.at(0).is_limited);
}

TEST(UrdfReader, RefusesToFollowWhatIsNotThereOrItself) {
  const std::string other =
      "<link name=\"b\"/>\n<joint name=\"k\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/>";
  EXPECT_EQ(problems_of(robot(joint("type=\"continuous\"", "<mimic joint=\"none\"/>"))),
            "r.urdf:4: joint 'j': follows the joint 'none', which is not there; expected the name of a joint");
  EXPECT_EQ(problems_of(robot(joint("type=\"continuous\"", "<mimic joint=\"j\"/>"))),
            "r.urdf:4: joint 'j': follows itself; expected a joint that moves by itself at the end of every chain of "
            "<mimic>");
  const std::string ring = robot(joint("type=\"continuous\"", "<mimic joint=\"k\"/>") + other +
                                 "<mimic joint=\"j\" multiplier=\"2\"/></joint>\n");
  EXPECT_NE(problems_of(ring).find("follows itself"), std::string::npos) << problems_of(ring);
}

TEST(UrdfReader, NotesShapesWithoutExtent) {
  const std::string link =
      "<link name=\"c\"><collision><geometry><box size=\"0 0 0\"/></geometry></collision>\n"
      "<visual><geometry><sphere radius=\"0\"/></geometry></visual></link>\n"
      "<joint name=\"k\" type=\"fixed\"><parent link=\"a\"/><child link=\"c\"/></joint>\n";
  const auto notes = notes_of(robot(joint("type=\"continuous\"", "") + link));
  const std::vector<std::string> expected = {"5 link 'c': <collision>: a box without extent is not taken over",
                                             "6 link 'c': <visual>: a sphere without extent is not taken over"};
  EXPECT_EQ(texts_of(notes), expected);
}

TEST(UrdfImport, ReportsProblemsOfTheSceneAtTheLineOfTheUrdf) {
  const scene::TemporaryFolder folder;
  // a point mass that turns freely
  const std::string path =
      folder.write("r.urdf",
                   "<robot name=\"x\">\n<link name=\"world\"/>\n<link name=\"a\"><inertial><mass value=\"1\"/>\n"
                   "<inertia ixx=\"0\" iyy=\"0\" izz=\"0\"/></inertial></link>\n"
                   "<joint name=\"j\" type=\"floating\"><parent link=\"world\"/><child link=\"a\"/></joint></robot>");
  try {
    (void)import_file(path);
    ADD_FAILURE() << "accepted";
  } catch (const scene::LoadError& error) {
    EXPECT_NE(std::string(error.what()).find(":5: j: the load of this joint has no inertia"), std::string::npos)
        << error.what();
  }
}

// after any deletion from a file or insertion into it: a readable scene, or problems with their places
TEST(UrdfImport, EndsWellWithDamagedFiles) {
  std::ifstream in(SLEWRING_SOURCE_DIR "/examples/urdf/two_link_arm.urdf");
  const std::string sound(std::istreambuf_iterator<char>(in), {});
  const scene::TemporaryFolder folder;
  const std::string pieces[] = {"",  "<",    ">",   "/", "\"", "0", "-", "nan", "1e308", "<link name=\"x\"/>",
                                " ", "\xff", "&#0;"};
  std::mt19937 generator(11);
  int accepted = 0, refused = 0;
  for (int i = 0; i < 400; ++i) {
    std::string text = sound;
    const std::size_t start = generator() % text.size();
    text.replace(start, generator() % 12, pieces[generator() % std::size(pieces)]);
    const std::string path = folder.write("r.urdf", text);
    try {
      EXPECT_FALSE(import_file(path).text.empty());
      ++accepted;
    } catch (const scene::LoadError& error) {
      EXPECT_FALSE(error.diagnostics().empty());
      for (const scene::Diagnostic& diagnostic : error.diagnostics()) EXPECT_EQ(diagnostic.file, path);
      ++refused;
    }
  }
  EXPECT_GT(accepted, 20);
  EXPECT_GT(refused, 100);
}

TEST(UrdfImport, CutsALongNameBetweenCharacters) {
  const scene::TemporaryFolder folder;
  std::string name(62, 'a');
  name += "\xC3\xBC\xC3\xBC";
  const std::string path = folder.write(
      "r.urdf", "<robot name=\"" + name + "\"><link name=\"world\"/>" + kLink +
                    "<joint name=\"j\" type=\"floating\"><parent link=\"world\"/><child link=\"a\"/></joint></robot>");
  EXPECT_NE(import_file(path).text.find("scene: " + name.substr(0, 62) + "\n"), std::string::npos);
}

TEST(UrdfImport, RefusesAFileThatIsNotThere) {
  EXPECT_THROW((void)import_file("no/such.urdf"), scene::LoadError);
  EXPECT_THROW((void)import_file("/dev/zero"), scene::LoadError);
}

}  // namespace reader_test
}  // namespace slew::urdf
