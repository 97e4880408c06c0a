// SPDX-License-Identifier: Apache-2.0
// Meshes for the eye reach clients by their names, and take the place of a body's contact shapes.
#include <gtest/gtest.h>

#include <cmath>

#include "gateway/gateway.h"
#include "scene/scene.h"

namespace assets_test {

using namespace slew;
using namespace slew::gateway;

constexpr const char* kScene =
    "bodies:\n"
    "  Drum: {mass: 40 kg, inertia: [0.5, 0.5, 0.8]}\n"
    "  Weight: {mass: 1 kg, inertia: [1, 1, 1]}\n"
    "joints:\n"
    "  Axle: {type: revolute, body2: Drum}\n"
    "  Rail: {type: floating, body2: Weight}\n"
    "shapes:\n"
    "  Drum_Box: {type: box, body: Drum, size: [1 m, 1 m, 1 m]}\n"
    "  Weight_Box: {type: box, body: Weight, size: [1 m, 1 m, 1 m]}\n"
    "graphics:\n"
    "  Drum_View: {body: Drum, file: drum.stl, unit: 1 m, up: y, position: [1 m, 2 m, 3 m]}\n"
    "  Weight_View: {body: Weight, file: weight.stl, unit: 1 m, up: y}\n";

scene::Scene scene_with_graphics() {
  return scene::load_text(kScene, "winch");
}

Assets drum_alone() {
  return {{"Drum_View.glb", std::make_shared<const std::string>("glTF of the drum")}};
}

std::vector<std::string> take_all(Gateway& gateway, ClientId client) {
  std::vector<std::string> frames;
  while (const auto frame = gateway.next_frame(client))
    frames.push_back(frame->head + (frame->body != nullptr ? *frame->body : ""));
  return frames;
}

TEST(SceneAssets, TakeThePlaceOfContactShapesWhereTheirFilesAreThere) {
  const MachineFrames frames(scene_with_graphics(), drum_alone());
  const Json update = *Json::parse(frames.scene_update({}, 0));
  const Json &drum = update.at("entities").items().at(1), &weight = update.at("entities").items().at(2);
  EXPECT_TRUE(drum.at("cubes").items().empty());
  ASSERT_EQ(drum.at("models").items().size(), 1u);
  const Json& model = drum.at("models").items()[0];
  EXPECT_EQ(model.at("url").text(), "package://slewring/Drum_View.glb");
  EXPECT_EQ(model.at("media_type").text(), "model/gltf-binary");
  EXPECT_EQ(model.at("pose").at("position").at("z").number(), 3);
  // a quarter turn back about x
  EXPECT_NEAR(model.at("pose").at("orientation").at("w").number(), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(model.at("pose").at("orientation").at("x").number(), -std::sqrt(0.5), 1e-12);
  EXPECT_EQ(weight.at("cubes").items().size(), 1u) << "its file is not there";
  EXPECT_TRUE(weight.at("models").items().empty());
}

TEST(SceneAssets, AreFetchedByTheirNames) {
  GatewayDef def;
  def.name = "winch";
  def.assets = drum_alone();
  Gateway gateway(std::move(def), scene_with_graphics());
  const ClientId client = *gateway.connect();
  const auto capabilities = Json::parse(take_all(gateway, client).at(0))->at("capabilities").texts();
  EXPECT_EQ(capabilities, (std::vector<std::string>{"time", "connectionGraph", "assets"}));
  const auto fetch = [&](const std::string& uri) {
    gateway.take_message(client, FrameType::text, R"({"op":"fetchAsset","requestId":258,"uri":")" + uri + "\"}", 1);
    const std::vector<std::string> frames = take_all(gateway, client);
    EXPECT_EQ(frames.size(), 1u);
    return frames.at(0);
  };
  // foxglove/ws-protocol, docs/spec.md: opcode 4, request u32, status u8, length of the message u32, message, data
  EXPECT_EQ(fetch("package://slewring/Drum_View.glb"), std::string("\4\2\1\0\0\0\0\0\0\0", 10) + "glTF of the drum");
  for (const char* const uri : {"package://slewring/Weight_View.glb", "package://slewring/../secret",
                                "file:///etc/passwd", "Drum_View.glb", ""}) {
    const std::string answer = fetch(uri);
    EXPECT_EQ(answer.substr(0, 6), std::string("\4\2\1\0\0\1", 6)) << uri;
    EXPECT_NE(answer.find("there is no asset"), std::string::npos) << uri;
  }
}

TEST(SceneAssets, ThatDoNotFitIntoTheQueueAreRefusedAndTheClientStays) {
  GatewayDef def;
  def.assets = {{"Drum_View.glb", std::make_shared<const std::string>(6000, 'x')}};
  def.most_event_bytes = 40'000;
  Gateway gateway(std::move(def), scene_with_graphics());
  const ClientId client = *gateway.connect();
  for (std::uint32_t i = 0; i < 20; ++i) {
    gateway.take_message(client, FrameType::text,
                         R"({"op":"fetchAsset","requestId":1,"uri":"package://slewring/Drum_View.glb"})", 1);
  }
  EXPECT_EQ(gateway.close_reason(client), "");
  std::size_t whole = 0, refused = 0;
  for (const std::string& frame : take_all(gateway, client)) {
    whole += frame[0] == 4 && frame[5] == 0 ? 1 : 0;
    refused += frame[0] == 4 && frame.find("GET /assets/Drum_View.glb") != std::string::npos ? 1 : 0;
  }
  EXPECT_GE(whole, 1u);
  EXPECT_EQ(whole + refused, 20u);
}

}  // namespace assets_test
