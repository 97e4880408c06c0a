// SPDX-License-Identifier: Apache-2.0
// HTTP and WebSocket on one port, in front of a gateway. One thread: the caller gives it time by poll().
//
// A connection is first HTTP: one request, one answer. A request for a WebSocket makes it a client of the gateway. At
// most 64 connections are open; one that sends no whole request for 10 s, or takes no byte for 60 s, is closed. A
// client that reads slowly holds up nothing: one frame of its own is under way, its other values wait as marks
// (gateway/outbox.h).
#pragma once

#include <cstdint>
#include <memory>

#include "core/time.h"
#include "gateway/gateway.h"
#include "view_node/server_def.h"

namespace slew::view_node {

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
