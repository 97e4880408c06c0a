// SPDX-License-Identifier: Apache-2.0
// Settings of the window's server.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "core/json.h"
#include "gateway/door.h"

namespace slew::view_node {

class SceneEditing;

struct ServerDef {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  // 0: any free one
  gateway::DoorDef door;
  std::string web;                               // folder of the page; empty: the built-in one
  std::filesystem::path workspace;               // file of the page's workspace; empty: none
  bool is_looking_only = false;                  // nothing is written
  std::function<Json()> description;             // /session.json
  SceneEditing* editing = nullptr;               // outlives the server; null: the window has no scene of its own
  std::shared_ptr<const std::string> circuit{};  // /circuit.svg; null: the scene has no hydraulic components
};

}  // namespace slew::view_node
