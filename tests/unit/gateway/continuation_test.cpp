// SPDX-License-Identifier: Apache-2.0
// The service take_over of a recording: what it starts, and what it refuses.
#include <gtest/gtest.h>

#include "gateway/gateway.h"

namespace continuation_test {

using namespace slew;
using namespace slew::gateway;

class StandingPlayback final : public Playback {
 public:
  Status control(const PlaybackControl&, std::int64_t) override { return Status::ok(); }
  PlaybackState state(std::int64_t) const override { return {}; }
};

class KeptRequests final : public Continuation {
 public:
  void start(const ContinuationRequest& request, Done done) override {
    requests.push_back(request);
    dones.push_back(std::move(done));
  }
  std::vector<ContinuationRequest> requests;
  std::vector<Done> dones;
};

class ContinuationTest : public ::testing::Test {
 protected:
  GatewayDef def(Continuation* kept_requests) {
    GatewayDef def;
    def.name = "winch";
    def.playback = &playback;
    def.range = DataRange{0, 2'000'000'000};
    def.continuation = kept_requests;
    return def;
  }
  static scene::Scene scene() {
    return scene::load_text(
        "bodies:\n  A: {mass: 1 kg, inertia: [1, 1, 1]}\njoints:\n  J: {type: revolute, body2: A}\n", "winch");
  }
  // The answer to a call: opcode, and JSON.
  static std::vector<std::string> call(Gateway& gateway, ClientId client, const std::string& request) {
    std::string bytes = {2};
    for (const std::uint32_t number : {static_cast<std::uint32_t>(Call::take_over), 77u, 4u}) {
      for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<char>(number >> (8 * i)));
    }
    gateway.take_message(client, FrameType::binary, bytes + "json" + request, 1);
    return take_all(gateway, client);
  }
  static std::vector<std::string> take_all(Gateway& gateway, ClientId client) {
    std::vector<std::string> frames;
    while (const auto frame = gateway.next_frame(client))
      frames.push_back(frame->head + (frame->body != nullptr ? *frame->body : ""));
    return frames;
  }

  StandingPlayback playback;
  KeptRequests kept;
};

TEST_F(ContinuationTest, IsAnsweredWithTheAddressOfTheSessionsWindow) {
  Gateway gateway(def(&kept), scene());
  const ClientId client = *gateway.connect();
  take_all(gateway, client);
  EXPECT_TRUE(call(gateway, client, R"({"time":1.25,"input":"script","duration":2})").empty());
  ASSERT_EQ(kept.requests.size(), 1u);
  EXPECT_EQ(kept.requests[0].time, 1.25);
  EXPECT_EQ(kept.requests[0].duration, 2);
  EXPECT_EQ(kept.requests[0].input, ContinuationInput::script);
  kept.dones[0]({.session = "winch-live", .page = "http://127.0.0.1:1/", .foxglove = "ws://127.0.0.1:1/"});
  const std::vector<std::string> frames = take_all(gateway, client);
  ASSERT_EQ(frames.size(), 1u);
  const Json answer = *Json::parse(std::string_view(frames[0]).substr(17));
  EXPECT_TRUE(answer.at("accepted").boolean());
  EXPECT_EQ(answer.at("session").text(), "winch-live");
  EXPECT_EQ(answer.at("page").text(), "http://127.0.0.1:1/");
}

TEST_F(ContinuationTest, AClientThatHasLeftReceivesNoAnswer) {
  Gateway gateway(def(&kept), scene());
  const ClientId client = *gateway.connect();
  call(gateway, client, R"({"time":1})");
  gateway.disconnect(client);
  ASSERT_EQ(kept.dones.size(), 1u);
  kept.dones[0]({.problem = "it was not to be"});
  EXPECT_EQ(gateway.clients(), 0u);
}

TEST_F(ContinuationTest, OfOtherTimesAndInputsIsRefused) {
  Gateway gateway(def(&kept), scene());
  const ClientId client = *gateway.connect();
  take_all(gateway, client);
  for (const char* const request :
       {"{}", R"({"time":-1})", R"({"time":2.1})", R"({"time":"1"})", R"({"time":1,"input":"/etc/passwd"})",
        R"({"time":1,"input":3})", R"({"time":1,"duration":-0.5})", R"({"time":1,"duration":1e300})"}) {
    const std::vector<std::string> frames = call(gateway, client, request);
    ASSERT_EQ(frames.size(), 1u) << request;
    EXPECT_EQ(Json::parse(frames[0])->at("op").text(), "serviceCallFailure") << request;
  }
  EXPECT_TRUE(kept.requests.empty());
}

TEST_F(ContinuationTest, IsNotOfferedWhereNoneCanBeStarted) {
  const auto offers_it = [](Gateway& gateway) {
    for (const std::string& frame : take_all(gateway, *gateway.connect()))
      if (frame.find("take_over") != std::string::npos) return true;
    return false;
  };
  Gateway with(def(&kept), scene()), without(def(nullptr), scene());
  EXPECT_TRUE(offers_it(with));
  EXPECT_FALSE(offers_it(without));
  const ClientId client = *without.connect();
  take_all(without, client);
  EXPECT_NE(call(without, client, R"({"time":1})").at(0).find("no service of this number"), std::string::npos);
}

}  // namespace continuation_test
