// SPDX-License-Identifier: Apache-2.0
// Requests of a page for the scene of its window.
#include "view_node/scene_editing.h"

#include <gtest/gtest.h>

#include <thread>

#include "tests/support/temporary_folder.h"
#include "view_node/workspace_file.h"

namespace scene_editing_test {

using namespace slew;
using namespace slew::view_node;
using gateway::Service;
namespace fs = std::filesystem;

constexpr const char* kScene =
    "# a winch\nbodies:\n  A: {mass: 1 kg, inertia: [1, 1, 1]}  # a drum\njoints:\n  J: {type: revolute, body2: A}\n";

class SceneEditingTest : public ::testing::Test {
 protected:
  HttpAnswer request(Service service, bool is_change, const std::string& body = "", const std::string& match = "") {
    return editing.answer({service, is_change, match, body});
  }
  Json edit(const std::string& text, const Json& change) {
    const HttpAnswer answer = request(Service::scene, true, Json({{"text", text}, {"edit", change}}).dump());
    EXPECT_EQ(answer.status, 200u) << *answer.content;
    return Json::parse(*answer.content).value_or(Json());
  }
  std::string on_disk() const { return folder.read("winch.yaml"); }

  slew::testing::TemporaryFolder folder{"scene_editing"};
  fs::path path = [this] {
    folder.write("winch.yaml", kScene);
    return folder.path() / "winch.yaml";
  }();
  SceneEditing editing{path, {"session.step=2 ms"}};
};

TEST_F(SceneEditingTest, TheFileIsServedWithItsElementsKindsAndTag) {
  const HttpAnswer answer = request(Service::scene, false);
  const Json file = Json::parse(*answer.content).value_or(Json());
  EXPECT_EQ(file.at("text").text(), kScene);
  EXPECT_EQ(file.at("tag").text(), entity_tag(kScene));
  EXPECT_EQ(file.at("settings").texts(), std::vector<std::string>{"session.step=2 ms"});
  EXPECT_FALSE(file.at("kinds").items().empty());
  EXPECT_FALSE(file.at("elements").items().empty());
}

TEST_F(SceneEditingTest, AnEditIsAnsweredAndNotWritten) {
  const Json edited = edit(kScene, {{"set", "A.mass"}, {"value", "2 kg"}});
  EXPECT_NE(edited.at("text").text().find("{mass: 2 kg, inertia: [1, 1, 1]}  # a drum"), std::string::npos);
  EXPECT_TRUE(edited.at("problems").items().empty());
  EXPECT_EQ(on_disk(), kScene);
  const Json faulty = edit(kScene, {{"set", "A.mass"}, {"value", "2 m"}});
  EXPECT_EQ(faulty.at("problems").items().front().at("path").text(), "A.mass");
}

TEST_F(SceneEditingTest, ASaveNamesTheStateThatItReplaces) {
  const std::string text = edit(kScene, {{"set", "A.mass"}, {"value", "2 kg"}}).at("text").text();
  EXPECT_EQ(request(Service::saving, true, text).status, 428u);
  EXPECT_EQ(request(Service::saving, true, text, "\"other\"").status, 412u);
  EXPECT_EQ(on_disk(), kScene);
  fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write);
  const HttpAnswer saved = request(Service::saving, true, text, entity_tag(kScene));
  EXPECT_EQ(saved.status, 204u);
  EXPECT_EQ(saved.entity_tag, entity_tag(text));
  EXPECT_EQ(on_disk(), text);
  EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  // another page that has the state of before
  EXPECT_EQ(request(Service::saving, true, kScene, entity_tag(kScene)).status, 412u);
  EXPECT_EQ(on_disk(), text);
}

TEST_F(SceneEditingTest, ATextWithProblemsIsNotWritten) {
  for (const char* const text : {"bodies: [", "", "bodies:\n  A: {mass: -1 kg, inertia: [1, 1, 1]}\n"}) {
    EXPECT_EQ(request(Service::saving, true, text, entity_tag(kScene)).status, 422u) << text;
    EXPECT_EQ(on_disk(), kScene);
  }
}

TEST_F(SceneEditingTest, AScenesLinkStaysALink) {
  fs::create_symlink(path, folder.path() / "link.yaml");
  SceneEditing of_link(folder.path() / "link.yaml", {});
  const std::string text = std::string(kScene) + "# end\n";
  EXPECT_EQ(of_link.answer({Service::saving, true, entity_tag(kScene), text}).status, 204u);
  EXPECT_TRUE(fs::is_symlink(folder.path() / "link.yaml"));
  EXPECT_EQ(on_disk(), text);
}

TEST_F(SceneEditingTest, ARestartNeedsTheFileAsThePageHasIt) {
  EXPECT_EQ(request(Service::restart, true).status, 428u);
  EXPECT_EQ(request(Service::restart, true, "", "\"other\"").status, 412u);
  EXPECT_FALSE(editing.takes_restart());
  EXPECT_EQ(request(Service::restart, true, "", entity_tag(kScene)).status, 202u);
  EXPECT_TRUE(editing.takes_restart());
  EXPECT_FALSE(editing.takes_restart());
  folder.write("winch.yaml", "bodies: [");
  EXPECT_EQ(request(Service::restart, true, "", entity_tag("bodies: [")).status, 422u);
  EXPECT_FALSE(editing.takes_restart());
}

TEST_F(SceneEditingTest, DamagedAndGiantRequestsAreRefused) {
  for (const char* const body :
       {"", "{", "[]", "5", R"({"text": 5})", R"({"text": "a", "edit": 5})",
        R"({"text": "bodies: {}", "edit": {"set": ["A"]}})", "\xff", R"({"a":{"b":{"c":{"d":{"e":1}}}}})"})
    EXPECT_EQ(request(Service::scene, true, body).status, 400u) << body;
  const std::string giant(kMostSceneBytes + 1, '#');
  EXPECT_EQ(request(Service::scene, true, Json({{"text", giant}}).dump()).status, 413u);
  EXPECT_EQ(request(Service::saving, true, giant, entity_tag(kScene)).status, 413u);
  EXPECT_EQ(on_disk(), kScene);
}

TEST_F(SceneEditingTest, RequestsThatWaitAreBounded) {
  std::size_t answered = 0, refused = 0;
  constexpr std::size_t kAll = 3 * SceneEditing::kMostWaiting;
  for (std::size_t i = 0; i < kAll; ++i) {
    editing.take({Service::scene, false, "", ""}, [&](const HttpAnswer& answer) {
      ++answered;
      if (answer.status == 503) ++refused;
    });
  }
  while (answered < kAll) {
    editing.poll();
    std::this_thread::yield();
  }
  EXPECT_LT(refused, kAll);
}

}  // namespace scene_editing_test
