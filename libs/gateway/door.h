// SPDX-License-Identifier: Apache-2.0
// Decides about an HTTP request to the gateway: which file it gets, whether it becomes a WebSocket, or why it is
// refused.
//
// A page of another site that a person looks at can send requests to this machine's ports. Two checks keep it out:
//   Host    must be an address, localhost or a name that was stated: a foreign name that resolves to this machine
//           (DNS rebinding) is refused
//   Origin  where a browser sends one, must be the gateway's own page or one that was stated
// Programs send no Origin; they are users of this machine, or have the token.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace slew::gateway {

enum class Subprotocol : std::uint8_t { sdk_v1, websocket_v1 };
[[nodiscard]] std::string_view to_text(Subprotocol subprotocol) noexcept;

struct DoorDef {
  std::vector<std::string> hosts;    // accepted names in Host beside addresses and localhost
  std::vector<std::string> origins;  // accepted origins beside the page's own, "https://app.foxglove.dev"
  std::string token;                 // required as ?token=...; empty: none
};

struct Request {
  std::string_view method, target, host, origin;
  std::string_view subprotocols;  // of Sec-WebSocket-Protocol, separated by commas
  bool has_origin = false;
  bool is_upgrade = false;
};

enum class Service : std::uint8_t {
  error,
  websocket,
  session,    // /session.json
  asset,      // /assets/NAME.glb: of the session, as the protocol has it
  circuit,    // /circuit.svg: diagram of the hydraulic circuit
  workspace,  // /workspace.json: of the page, also with PUT
  scene,      // /scene.json: the scene that can be edited; POST: with a change of a text
  saving,     // /scene.yaml, PUT: the text into the scene's file
  restart,    // /restart, POST: the session begins again with the file
  file
};

struct Verdict {
  Service service = Service::error;
  unsigned status = 400;  // of HTTP
  std::string text;       // error: what happened, what to do
  std::string path{};     // file: relative, of plain names, "index.html" for /; asset: its name
  Subprotocol subprotocol = Subprotocol::sdk_v1;
};

[[nodiscard]] Verdict judge(const DoorDef& door, const Request& request);

// The address is of this machine alone: 127.0.0.0/8 or ::1.
[[nodiscard]] bool is_loopback(std::string_view address) noexcept;

// A text that a browser can send as Origin: "https://app.foxglove.dev", "http://crane:8080", "file://", "null"; with no
// path, no capital letters, and no port that is the scheme's own.
[[nodiscard]] bool is_origin(std::string_view text) noexcept;

// An IPv4 or IPv6 address.
[[nodiscard]] bool is_address(std::string_view text) noexcept;

}  // namespace slew::gateway
