// SPDX-License-Identifier: Apache-2.0
// The service curves of a recording: what it requests, and what it refuses.
#include <gtest/gtest.h>

#include "gateway/gateway.h"

namespace curves_test {

using namespace slew;
using namespace slew::gateway;

class StandingPlayback final : public Playback {
 public:
  Status control(const PlaybackControl&, std::int64_t) override { return Status::ok(); }
  PlaybackState state(std::int64_t) const override { return {}; }
};

class KeptRequests final : public RecordedCurves {
 public:
  std::vector<std::string> names() const override { return {"first", "second"}; }
  void read(CurvesRequest request, Done done) override {
    requests.push_back(std::move(request));
    dones.push_back(std::move(done));
  }
  std::vector<CurvesRequest> requests;
  std::vector<Done> dones;
};

class CurvesTest : public ::testing::Test {
 protected:
  // The answer to a call: opcode, and JSON.
  std::vector<std::string> call(const std::string& request) {
    std::string bytes = {2};
    for (const std::uint32_t number : {static_cast<std::uint32_t>(Call::curves), 77u, 4u}) {
      for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<char>(number >> (8 * i)));
    }
    gateway.take_message(client, FrameType::binary, bytes + "json" + request, 1);
    return take_all();
  }
  std::vector<std::string> take_all() {
    std::vector<std::string> frames;
    while (const auto frame = gateway.next_frame(client))
      frames.push_back(frame->head + (frame->body != nullptr ? *frame->body : ""));
    return frames;
  }
  static GatewayDef def(StandingPlayback& playback, KeptRequests& kept) {
    GatewayDef def;
    def.name = "winch";
    def.playback = &playback;
    def.range = DataRange{0, 2'000'000'000};
    def.curves = &kept;
    return def;
  }

  StandingPlayback playback;
  KeptRequests kept;
  Gateway gateway{def(playback, kept),
                  scene::load_text("bodies:\n  A: {mass: 1 kg, inertia: [1, 1, 1]}\njoints:\n  J: {type: revolute, "
                                   "body2: A}\n",
                                   "winch")};
  ClientId client = *gateway.connect();
};

TEST_F(CurvesTest, AreAnsweredWithTheirSamples) {
  take_all();
  EXPECT_TRUE(call(R"({"names":["A.x","A.y"],"from":0.5,"to":1.5,"most":100,"recording":1})").empty());
  ASSERT_EQ(kept.requests.size(), 1u);
  EXPECT_EQ(kept.requests[0].names, (std::vector<std::string>{"A.x", "A.y"}));
  EXPECT_EQ(kept.requests[0].from, 0.5);
  EXPECT_EQ(kept.requests[0].to, 1.5);
  EXPECT_EQ(kept.requests[0].most_values, 100u);
  EXPECT_EQ(kept.requests[0].recording, 1u);
  kept.dones[0]({.curves = Json::array({Json{{"name", "A.x"}}}), .unknown = {"A.y"}, .samples = 3});
  const std::vector<std::string> frames = take_all();
  ASSERT_EQ(frames.size(), 1u);
  const Json answer = *Json::parse(std::string_view(frames[0]).substr(17));
  EXPECT_TRUE(answer.at("accepted").boolean());
  EXPECT_EQ(answer.at("samples").integer(), 3);
  EXPECT_EQ(answer.at("unknown").texts(), (std::vector<std::string>{"A.y"}));
  EXPECT_EQ(answer.at("curves").items()[0].at("name").text(), "A.x");
}

TEST_F(CurvesTest, RequestsBeyondTheLimitsAreRefused) {
  take_all();
  std::string many = "\"A\"";
  for (int i = 0; i < 32; ++i) many += ",\"A\"";
  for (const std::string& request :
       {std::string(R"({"names":[],"from":0,"to":1})"), R"({"names":[)" + many + R"(],"from":0,"to":1})",
        std::string(R"({"names":["A"],"from":2,"to":1})"), std::string(R"({"names":["A"],"from":-1,"to":1})"),
        std::string(R"({"names":["A"],"from":0,"to":1,"most":1})"),
        std::string(R"({"names":["A"],"from":0,"to":1,"most":200001})"),
        std::string(R"({"names":["A"],"from":0,"to":1,"recording":2})"),
        std::string(R"({"names":[5],"from":0,"to":1})"), std::string(R"({"from":0,"to":1})")}) {
    const std::vector<std::string> frames = call(request);
    ASSERT_EQ(frames.size(), 1u) << request;
    EXPECT_NE(frames[0].find("serviceCallFailure"), std::string::npos) << request << frames[0];
  }
  EXPECT_TRUE(kept.requests.empty());
}

}  // namespace curves_test
