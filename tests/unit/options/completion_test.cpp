// SPDX-License-Identifier: Apache-2.0
// Words that may stand at the cursor, and manual pages, from a small tree of commands.
#include "options/completion.h"

#include <gtest/gtest.h>

#include "options/manual.h"
#include "options/options.h"

namespace slew::options {
namespace completion_test {

using Words = std::vector<std::string>;

class Tree : public ::testing::Test {
 protected:
  Tree() {
    Command run = program_.command("run", "runs a scene");
    run.option("scene", scene_, "scene file").required().value_name("SCENE");
    run.option("--pace", pace_, "how fast").one_of({"real", "free"}).value_name("PACE");
    run.option("--remote", list_, "roles").comma_separated().one_of({"io", "mechanics"}).value_name("ROLE");
    run.option("--out", out_, "folder").value_name("DIR");
    run.flag("-q,--quiet", is_quiet_, "no status\nline");
    Command control = program_.command("control", "steers a session");
    control.command("pause", "pauses");
    control.command("play", "plays .. 'again'");
    Command hidden = program_.command("row", "not for users");
    hidden.hide();
  }
  Words words(const Words& typed) {
    Words result;
    for (const Candidate& candidate : complete(program_.text(), typed).candidates) result.push_back(candidate.word);
    return result;
  }
  FileKind files(const Words& typed) { return complete(program_.text(), typed).files; }

  Program program_{"test", "a test"};
  std::string scene_, pace_, out_;
  Words list_;
  bool is_quiet_ = false;
};

TEST_F(Tree, CompletesVerbsAndTheirVerbsButNoHiddenOnes) {
  EXPECT_EQ(words({""}), (Words{"run", "control"}));
  EXPECT_EQ(words({}), words({""}));
  EXPECT_EQ(words({"r"}), (Words{"run"}));
  EXPECT_EQ(words({"control", "p"}), (Words{"pause", "play"}));
  EXPECT_EQ(words({"control", "pa"}), (Words{"pause"}));
  EXPECT_TRUE(words({"x"}).empty());
}

TEST_F(Tree, CompletesOptionsOfTheVerbAlone) {
  EXPECT_EQ(words({"run", "--"}), (Words{"--help", "--pace", "--remote", "--out", "--quiet"}));
  EXPECT_EQ(words({"run", "x.yaml", "--p"}), (Words{"--pace"}));
  EXPECT_EQ(words({"control", "--"}), (Words{"--help"}));
  EXPECT_TRUE(words({"run", "--", "--p"}).empty()) << "behind -- there are no options";
}

TEST_F(Tree, CompletesValuesOfAnOption) {
  EXPECT_EQ(words({"run", "--pace", ""}), (Words{"real", "free"}));
  EXPECT_EQ(words({"run", "--pace", "f"}), (Words{"free"}));
  EXPECT_EQ(words({"run", "--pace=f"}), (Words{"--pace=free"}));
  EXPECT_EQ(words({"run", "--remote", "io,m"}), (Words{"io,mechanics"}));
  EXPECT_EQ(files({"run", "--pace", ""}), FileKind::none);
  EXPECT_EQ(files({"run", "--out", ""}), FileKind::folders);
  EXPECT_EQ(files({"run", "--out=a"}), FileKind::folders);
}

TEST_F(Tree, TheFirstArgumentIsASceneAndThereIsNoSecondOne) {
  EXPECT_EQ(files({"run", ""}), FileKind::scenes);
  EXPECT_EQ(files({"run", "--pace", "real", "--quiet", ""}), FileKind::scenes);
  EXPECT_EQ(files({"run", "x.yaml", ""}), FileKind::none);
}

TEST_F(Tree, VerbsAreArgumentsOfHelp) {
  std::vector<std::string> verbs;
  program_.command("help", "explains a verb").option("verb", verbs, "verb").value_name("VERB");
  EXPECT_EQ(words({"help", ""}), (Words{"run", "control", "help"}));
  EXPECT_EQ(words({"help", "control", "pa"}), (Words{"pause"}));
  EXPECT_EQ(files({"help", "run", ""}), FileKind::none);
}

TEST_F(Tree, LinesBeginWithTheKindOfFilesAndStayLines) {
  EXPECT_EQ(to_lines(complete(program_.text(), {"run", "-q"})), "none\n-q\tno status\n");
  EXPECT_EQ(to_lines(complete(program_.text(), {"run", ""})), "folders .yaml\n");
}

TEST_F(Tree, ManualHasAPageForEveryVerbWithItsOptionsAndValues) {
  const std::vector<ManualPage> pages = manual_pages(program_.text(), "1.2.3");
  ASSERT_EQ(pages.size(), 3u);
  EXPECT_EQ(pages[0].name, "test-run");
  EXPECT_EQ(pages[1].name, "test-control");
  EXPECT_EQ(pages[2].name, "test");
  EXPECT_NE(pages[0].text.find("One of: real, free"), std::string::npos) << pages[0].text;
  EXPECT_NE(pages[0].text.find("\\fB\\-\\-out\\fP \\fIDIR\\fP"), std::string::npos) << pages[0].text;
  EXPECT_NE(pages[1].text.find(".SS \"test control play\""), std::string::npos) << pages[1].text;
  EXPECT_NE(pages[1].text.find("plays .. \\(aqagain\\(aq"), std::string::npos) << pages[1].text;
  EXPECT_NE(pages[2].text.find("Slewring 1.2.3"), std::string::npos);
  EXPECT_EQ(pages[2].text.find("row"), std::string::npos) << "a hidden verb";
}

}  // namespace completion_test
}  // namespace slew::options
