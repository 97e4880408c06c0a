// SPDX-License-Identifier: Apache-2.0
// Answers to HTTP requests: packed files, entity tags, the workspace.
#include "view_node/http_answers.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>

#include "tests/support/temporary_folder.h"

namespace http_answers_test {

using namespace slew;
using namespace slew::view_node;
using gateway::Service;
namespace fs = std::filesystem;

class HttpAnswersTest : public ::testing::Test {
 protected:
  static gateway::Verdict file(const std::string& path) { return {Service::file, 200, "", path}; }
  static gateway::Verdict verdict(Service service, const std::string& path = "") { return {service, 200, "", path}; }
  HttpAnswer get(const gateway::Verdict& verdict, std::string_view encodings = "", std::string_view none_match = "") {
    return answers.answer(verdict, {"GET", encodings, {"", none_match}, ""});
  }
  HttpAnswer put(const std::string& text, std::string_view match = "", std::string_view none_match = "") {
    return answers.answer(verdict(Service::workspace), {"PUT", "", {match, none_match}, text});
  }
  ServerDef server_def() const {
    ServerDef made;
    made.web = folder.path().string();
    made.workspace = folder.path() / "state/workspaces/winch.json";
    made.description = [] { return Json({{"session", "winch"}}); };
    return made;
  }
  static gateway::GatewayDef gateway_def() {
    gateway::GatewayDef def;
    def.assets = {{"Drum.glb", std::make_shared<const std::string>("glTF")}};
    return def;
  }

  slew::testing::TemporaryFolder folder{"http_answers"};
  ServerDef def = server_def();
  gateway::Gateway gateway{gateway_def(), scene::load_text("bodies:\n  A: {mass: 1 kg, inertia: [1, 1, 1]}\njoints:\n"
                                                           "  J: {type: revolute, body2: A}\n",
                                                           "winch")};
  HttpAnswers answers{def, gateway};
};

// a refusal of the door is the answer, whatever comes with the request
TEST_F(HttpAnswersTest, ARefusedRequestWithABodyIsRefusedForItsReason) {
  gateway::Verdict foreign;
  foreign.status = 403;
  foreign.text = "the page that made this request is not the gateway's own";
  const HttpAnswer answer = answers.answer(foreign, {"PUT", "", {"", ""}, "{}"});
  EXPECT_EQ(answer.status, 403u);
  EXPECT_EQ(*answer.content, foreign.text + "\n");
  EXPECT_EQ(answers.answer(file("page.js"), {"GET", "", {"", ""}, "{}"}).status, 413u);
}

TEST_F(HttpAnswersTest, APackedFileIsForClientsThatTakeIt) {
  folder.write("page.js", "plain");
  folder.write("page.js.gz", "packed");
  const HttpAnswer plain = get(file("page.js")), packed = get(file("page.js"), "br, gzip;q=0.5");
  EXPECT_EQ(*plain.content, "plain");
  EXPECT_FALSE(plain.is_compressed);
  EXPECT_EQ(*packed.content, "packed");
  EXPECT_TRUE(packed.is_compressed && packed.depends_on_encoding && plain.depends_on_encoding);
  EXPECT_EQ(packed.type, "text/javascript; charset=utf-8");
  EXPECT_NE(packed.entity_tag, plain.entity_tag);
  // a file that was changed after it was packed
  fs::last_write_time(folder.path() / "page.js.gz",
                      fs::last_write_time(folder.path() / "page.js") - std::chrono::seconds(1));
  EXPECT_EQ(*get(file("page.js"), "gzip").content, "plain");
  EXPECT_EQ(get(file("none.js"), "gzip").status, 404u);
}

TEST_F(HttpAnswersTest, EncodingsAreReadAsTheyAreWritten) {
  for (const char* const text : {"gzip", "deflate, gzip", "gzip ; q=0.1", "br;q=1.0,gzip;q=1.000"})
    EXPECT_TRUE(accepts_gzip(text)) << text;
  for (const char* const text : {"", "br", "gzip;q=0", "gzip; q=0.000", "xgzip", "gzipx,br"})
    EXPECT_FALSE(accepts_gzip(text)) << text;
}

TEST_F(HttpAnswersTest, WhatAClientHasIsNotSentAgain) {
  folder.write("index.html", "<p>");
  folder.write("page-3F2A9C1B.js", "1");
  const HttpAnswer first = get(file("index.html"));
  EXPECT_EQ(first.cache, "no-cache");
  const HttpAnswer again = get(file("index.html"), "", "\"other\", " + first.entity_tag);
  EXPECT_EQ(again.status, 304u);
  EXPECT_EQ(again.content, nullptr);
  folder.write("index.html", "<p>new");
  EXPECT_EQ(get(file("index.html"), "", first.entity_tag).status, 200u);
  EXPECT_NE(get(file("page-3F2A9C1B.js")).cache.find("immutable"), std::string_view::npos);
  for (const char* const name : {"page.js", "page-part.js", "page-3f2a9c1b.js", "page-3F2A9C1.js", "a-3F2A9C1B/b.js"})
    EXPECT_FALSE(has_hash_in_name(name)) << name;
}

TEST_F(HttpAnswersTest, TheDescriptionAndMeshesHaveTheirTypes) {
  EXPECT_EQ(get(verdict(Service::session)).type, "application/json");
  const HttpAnswer mesh = get(verdict(Service::asset, "Drum.glb"));
  EXPECT_EQ(mesh.type, "model/gltf-binary");
  EXPECT_EQ(*mesh.content, "glTF");
  EXPECT_EQ(get(verdict(Service::asset, "Other.glb")).status, 404u);
  EXPECT_EQ(answers.answer(verdict(Service::session), {"GET", "", {"", ""}, "x"}).status, 413u);
}

TEST_F(HttpAnswersTest, AWorkspaceIsReplacedByThoseThatHaveReadIt) {
  EXPECT_EQ(get(verdict(Service::workspace)).status, 404u);
  EXPECT_EQ(put(R"({"version":1,"panels":["a"]})").status, 201u);
  const HttpAnswer read = get(verdict(Service::workspace));
  EXPECT_EQ(*read.content, R"({"version":1,"panels":["a"]})");
  // two pages have read the same state
  const HttpAnswer first = put(R"({"version":1,"panels":["b"]})", read.entity_tag);
  EXPECT_EQ(first.status, 204u);
  const HttpAnswer second = put(R"({"version":1,"panels":["c"]})", read.entity_tag);
  EXPECT_EQ(second.status, 412u);
  EXPECT_EQ(second.entity_tag, first.entity_tag);
  EXPECT_EQ(put(R"({"version":1})").status, 428u);
  EXPECT_EQ(put(R"({"version":1})", "", "*").status, 412u);
  EXPECT_EQ(*get(verdict(Service::workspace)).content, R"({"version":1,"panels":["b"]})");
  EXPECT_EQ(get(verdict(Service::workspace), "", first.entity_tag).status, 304u);
}

TEST_F(HttpAnswersTest, WhatIsNoWorkspaceIsRefusedAndNothingIsWritten) {
  std::string deep = R"({"version":1,"a":)";
  for (int i = 0; i < 100; ++i) deep += '[';
  for (const std::string& text :
       {std::string("{"), std::string("[]"), std::string("{}"), std::string(R"({"version":"1"})"),
        std::string(R"({"version":0})"), std::string(R"({"version":1.5})"), deep,
        R"({"version":1,"a":")" + std::string(kMostWorkspaceBytes, 'x') + "\"}"}) {
    const HttpAnswer answer = put(text);
    EXPECT_EQ(answer.status, 400u) << text.substr(0, 40);
    EXPECT_NE(answer.content->find("nothing was written"), std::string::npos);
  }
  EXPECT_FALSE(fs::exists(folder.path() / "state"));
  def.is_looking_only = true;
  EXPECT_EQ(put(R"({"version":1})").status, 403u);
  EXPECT_FALSE(fs::exists(folder.path() / "state"));
}

TEST_F(HttpAnswersTest, AFolderThatCannotBeWrittenIsAnError) {
  folder.write("state", "a file in the place of the folder");
  EXPECT_EQ(put(R"({"version":1})").status, 507u);
}

TEST_F(HttpAnswersTest, AWorkspaceLiesInTheStateFolderUnderThePlainNameOfItsScene) {
  setenv("XDG_STATE_HOME", "/var/state", 1);
  EXPECT_EQ(workspace_path("crane"), "/var/state/slewring/workspaces/crane.json");
  EXPECT_EQ(workspace_path("../a b").parent_path(), "/var/state/slewring/workspaces");
  setenv("XDG_STATE_HOME", "relative", 1);
  setenv("HOME", "/home/x", 1);
  EXPECT_EQ(workspace_path("crane"), "/home/x/.local/state/slewring/workspaces/crane.json");
}

TEST_F(HttpAnswersTest, AWindowWithoutASceneOfItsOwnNeitherEditsNorRestarts) {
  for (const Service service : {Service::scene, Service::saving, Service::restart}) {
    const HttpAnswer other = answers.answer(verdict(service), {"POST", "", {}, "{}"});
    EXPECT_EQ(other.status, 404u);
    EXPECT_NE(other.content->find("slewring window SCENE"), std::string::npos);
  }
  def.is_looking_only = true;
  for (const Service service : {Service::scene, Service::saving, Service::restart})
    EXPECT_EQ(answers.answer(verdict(service), {"POST", "", {}, "{}"}).status, 403u);
}

}  // namespace http_answers_test
