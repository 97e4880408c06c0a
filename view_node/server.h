// SPDX-License-Identifier: Apache-2.0
// HTTP and WebSocket on one port, in front of a gateway. One thread: the caller gives it time by poll().
//
// A connection is first HTTP: one request, one answer. A request for a WebSocket makes it a client of the gateway. At
// most 64 connections are open; one that sends no whole request for 10 s, or takes no byte for 60 s, is closed. A
// client that reads slowly holds up nothing: one frame of its own is under way, its other values wait as marks
// (gateway/outbox.h).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "core/json.h"
#include "core/time.h"
#include "gateway/door.h"
#include "gateway/gateway.h"

namespace slew::view_node {

struct ServerDef {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  // 0: any free one
  gateway::DoorDef door;
  std::string web;                    // folder of the page; empty: the built-in one
  std::function<Json()> description;  // /session.json
};

class Server {
 public:
  // gateway: outlives the server. Throws Failure (resources) when the address cannot be opened.
  Server(ServerDef def, gateway::Gateway& gateway);
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  ~Server();

  [[nodiscard]] std::uint16_t port() const noexcept;
  // Handles what comes for at most so long, and sends what waits.
  void poll(SimDuration at_most);

 private:
  class State;
  std::unique_ptr<State> state_;
};

}  // namespace slew::view_node
