// SPDX-License-Identifier: Apache-2.0
// Requests that the gateway's door lets in, and those that it refuses.
#include "gateway/door.h"

#include <gtest/gtest.h>

namespace door_test {

using namespace slew::gateway;

Request plain(std::string_view target = "/") {
  return {.method = "GET", .target = target, .host = "127.0.0.1:8765", .origin = "", .subprotocols = ""};
}
Request upgrade(std::string_view subprotocols, std::string_view target = "/") {
  Request request = plain(target);
  request.is_upgrade = true;
  request.subprotocols = subprotocols;
  return request;
}
Request from_page(Request request, std::string_view origin) {
  request.origin = origin;
  request.has_origin = true;
  return request;
}

TEST(Door, AnswersTheSubprotocolThatIsOfferedAndPrefersTheNewer) {
  const DoorDef door;
  EXPECT_EQ(judge(door, upgrade("foxglove.sdk.v1")).subprotocol, Subprotocol::sdk_v1);
  EXPECT_EQ(judge(door, upgrade("foxglove.websocket.v1")).subprotocol, Subprotocol::websocket_v1);
  EXPECT_EQ(judge(door, upgrade("x,foxglove.websocket.v1, foxglove.sdk.v1")).subprotocol, Subprotocol::sdk_v1);
  EXPECT_EQ(judge(door, upgrade("foxglove.websocket.v1")).service, Service::websocket);
}

TEST(Door, RefusesOtherSubprotocolsAndNamesBoth) {
  for (const char* const offered : {"", "foxglove.sdk.v2", "mqtt", "foxglove.sdk.v1x", ",,,"}) {
    const Verdict verdict = judge({}, upgrade(offered));
    EXPECT_EQ(verdict.status, 400u) << offered;
    EXPECT_NE(verdict.text.find("foxglove.sdk.v1"), std::string::npos);
    EXPECT_NE(verdict.text.find("foxglove.websocket.v1"), std::string::npos);
  }
}

TEST(Door, RefusesNamesInHostThatAreNotItsOwn) {
  Request request = plain();
  for (const char* const host : {"localhost:8765", "127.0.0.1", "[::1]:8765", "192.168.1.10:80"}) {
    request.host = host;
    EXPECT_EQ(judge({}, request).status, 200u) << host;
  }
  for (const char* const host : {"", "evil.com", "localhost.evil.com:8765", "[::1", "127.0.0.1.evil.com", "crane"}) {
    request.host = host;
    EXPECT_EQ(judge({}, request).status, 403u) << host;
  }
  DoorDef door;
  door.hosts = {"crane"};
  EXPECT_EQ(judge(door, request).status, 200u);
}

TEST(Door, RefusesPagesOfOtherSites) {
  DoorDef door;
  door.origins = {"https://app.foxglove.dev"};
  for (const char* const origin : {"http://127.0.0.1:8765", "https://app.foxglove.dev"})
    EXPECT_EQ(judge(door, from_page(upgrade("foxglove.sdk.v1"), origin)).status, 101u) << origin;
  for (const char* const origin :
       {"http://evil.com", "null", "", "http://127.0.0.1:8766", "https://app.foxglove.dev.x"}) {
    EXPECT_EQ(judge(door, from_page(upgrade("foxglove.sdk.v1"), origin)).status, 403u) << origin;
    EXPECT_EQ(judge(door, from_page(plain(), origin)).status, 403u) << origin;
  }
}

TEST(Door, OriginsAreThoseThatABrowserCanSend) {
  for (const char* const origin :
       {"https://app.foxglove.dev", "http://localhost:8080", "http://192.168.1.10:8766", "http://[::1]:5173",
        "https://x_y.example", "app://index", "file://", "null", "http://crane:443", "https://crane:80"})
    EXPECT_TRUE(is_origin(origin)) << origin;
  for (const char* const origin : {"",
                                   "*",
                                   "app.foxglove.dev",
                                   "localhost:8080",
                                   "https://x.example/",
                                   "https://x.example/page",
                                   "https://",
                                   "https://*.example",
                                   "https://X.example",
                                   "HTTPS://x.example",
                                   "https://x.example:443",
                                   "http://x.example:80",
                                   "http://x.example:",
                                   "http://x.example:80x",
                                   "http://x.example:1234567",
                                   "http://[::1",
                                   "http://[x]:1",
                                   "http://[::1]x",
                                   "://x.example",
                                   "https://x example",
                                   "https://user@x.example"})
    EXPECT_FALSE(is_origin(origin)) << origin;
}

TEST(Door, LetsPlainPathsOfThePageIn) {
  EXPECT_EQ(judge({}, plain("/")).path, "index.html");
  EXPECT_EQ(judge({}, plain("/assets/page-1.js?v=2")).path, "assets/page-1.js");
  EXPECT_EQ(judge({}, plain("/docs/")).path, "docs/index.html");
  EXPECT_EQ(judge({}, plain("/session.json")).service, Service::session);
  EXPECT_EQ(judge({}, plain("/circuit.svg")).service, Service::circuit);
  for (const char* const target : {"", "x", "/../etc/passwd", "/a/../b", "//etc/passwd", "/.git/config", "/a/.hidden",
                                   "/%2e%2e/x", "/a\\b", "/a b", "http://127.0.0.1/x", "/a//b", "*"}) {
    EXPECT_EQ(judge({}, plain(target)).status, 404u) << target;
  }
  EXPECT_EQ(judge({}, plain("/" + std::string(3000, 'a'))).status, 414u);
}

TEST(Door, KeepsMeshesAndTheWorkspaceApartFromThePagesFiles) {
  EXPECT_EQ(judge({}, plain("/assets/Cab_View.glb")).service, Service::asset);
  EXPECT_EQ(judge({}, plain("/assets/Cab_View.glb")).path, "Cab_View.glb");
  EXPECT_EQ(judge({}, plain("/workspace.json")).service, Service::workspace);
  Request request = plain("/workspace.json");
  request.method = "PUT";
  EXPECT_EQ(judge({}, request).service, Service::workspace);
  EXPECT_EQ(judge({}, from_page(request, "http://evil.com")).status, 403u);
  DoorDef door;
  door.token = "0123456789abcdef";
  EXPECT_EQ(judge(door, request).status, 401u);
  EXPECT_EQ(judge(door, plain("/assets/Cab_View.glb")).status, 401u);
  EXPECT_EQ(judge(door, plain("/assets/page.js")).status, 200u);
}

TEST(Door, RefusesMethodsThatWouldChangeSomething) {
  Request request = plain();
  for (const char* const method : {"POST", "PUT", "DELETE", "OPTIONS", "", "get"}) {
    request.method = method;
    EXPECT_EQ(judge({}, request).status, 405u) << method;
  }
}

TEST(Door, WithATokenValuesAreForThoseThatHaveIt) {
  DoorDef door;
  door.token = "0123456789abcdef";
  const char* const right = "/?a=1&token=0123456789abcdef";
  EXPECT_EQ(judge(door, upgrade("foxglove.sdk.v1", right)).status, 101u);
  EXPECT_EQ(judge(door, plain("/session.json?token=0123456789abcdef")).status, 200u);
  for (const char* const target : {"/", "/?token=", "/?token=0123456789abcdee", "/?token=0123456789abcdef0",
                                   "/?tokens=0123456789abcdef", "/?x=token=0123456789abcdef"}) {
    EXPECT_EQ(judge(door, upgrade("foxglove.sdk.v1", target)).status, 401u) << target;
  }
  EXPECT_EQ(judge(door, plain("/session.json")).status, 401u);
  EXPECT_EQ(judge(door, plain("/circuit.svg")).status, 401u);
  // the page itself has no values
  EXPECT_EQ(judge(door, plain("/index.html")).status, 200u);
}

TEST(Door, OnlyAddressesOfThisMachineAreLoopback) {
  for (const char* const address : {"127.0.0.1", "127.8.0.9", "::1"}) EXPECT_TRUE(is_loopback(address)) << address;
  for (const char* const address : {"0.0.0.0", "192.168.1.1", "::", "127.0.0.1.evil.com", "127.", "localhost", ""})
    EXPECT_FALSE(is_loopback(address)) << address;
}

TEST(Door, ThePathsOfTheSceneTakeTheirMethodsAndNeedTheToken) {
  const auto request = [](std::string_view method, std::string_view target, const DoorDef& door = {}) {
    Request request = plain(target);
    request.method = method;
    return judge(door, request);
  };
  EXPECT_EQ(request("GET", "/scene.json").service, Service::scene);
  EXPECT_EQ(request("POST", "/scene.json").service, Service::scene);
  EXPECT_EQ(request("PUT", "/scene.yaml").service, Service::saving);
  EXPECT_EQ(request("POST", "/restart").service, Service::restart);
  for (const auto& [method, target] :
       {std::pair("PUT", "/scene.json"), std::pair("GET", "/scene.yaml"), std::pair("POST", "/scene.yaml"),
        std::pair("GET", "/restart"), std::pair("PUT", "/restart"), std::pair("DELETE", "/scene.yaml"),
        std::pair("POST", "/session.json"), std::pair("PUT", "/other.yaml")}) {
    EXPECT_EQ(request(method, target).status, 405u) << method << " " << target;
  }
  for (const char* const target : {"/scenes/../scene.yaml", "/../scene.yaml", "/%73cene.yaml", "//scene.yaml"})
    EXPECT_NE(request("PUT", target).service, Service::saving) << target;
  DoorDef door;
  door.token = "0123456789abcdef";
  EXPECT_EQ(request("PUT", "/scene.yaml", door).status, 401u);
  EXPECT_EQ(request("POST", "/restart?token=wrong", door).status, 401u);
  EXPECT_EQ(request("PUT", "/scene.yaml?token=0123456789abcdef", door).service, Service::saving);
  Request foreign = from_page(plain("/restart"), "http://evil.com");
  foreign.method = "POST";
  EXPECT_EQ(judge({}, foreign).status, 403u);
}

}  // namespace door_test
