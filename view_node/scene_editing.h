// SPDX-License-Identifier: Apache-2.0
// Editing of the scene that a window was started with, and the restart of its session.
//
// The page has the text that it edits; here nothing is kept between two requests but the file. A request is answered on
// a thread of its own and of low priority, since reading a scene takes its time and the session must not wait:
//
//   GET  /scene.json   {file, text, tag, settings, kinds, elements, points, problems, warnings} of the file
//                      (scene/scene_outline.h); settings are those over the file
//   POST /scene.json   {text, edit}: {text, elements, problems, refusal, notes} of the changed text, refusal empty when
//                      it is done; nothing is written. edit: {set, value} with a path such as "Bag.mass",
//                      {add, section, type}, {copy, to}, {rename, to}, {remove}, or none
//   PUT  /scene.yaml   the text into the file: 204. If-Match names the state that it replaces: 412, 428. 422 with the
//                      problems of a text that does not load
//   POST /restart      the session begins again with the file, whose state If-Match names: 202
//
// Only this one file is written, as a whole, and never while it has changed since the page has read it.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>

#include "gateway/door.h"
#include "scene/scene.h"
#include "view_node/http_answers.h"
#include "view_node/request_thread.h"

namespace slew::view_node {

inline constexpr std::size_t kMostSceneBytes = 400'000;  // with its escapes it fits into a request

class SceneEditing {
 public:
  static constexpr std::size_t kMostWaiting = 16;

  // settings: those over the scene in this session.
  SceneEditing(std::filesystem::path file, scene::Overrides settings);

  struct Request {
    gateway::Service service = gateway::Service::scene;
    bool is_change = false;  // no GET or HEAD
    std::string if_match{};
    std::string body{};
  };
  // done is called once, from poll(), or at once where too many requests wait.
  using Done = std::function<void(const HttpAnswer&)>;
  void take(Request request, Done done);
  void poll() { thread_.poll(); }
  // True once after a restart was granted.
  [[nodiscard]] bool takes_restart() { return is_restart_wanted_.exchange(false); }

  // The answer to one request, on the caller's thread.
  [[nodiscard]] HttpAnswer answer(const Request& request);

 private:
  [[nodiscard]] HttpAnswer file() const;
  [[nodiscard]] HttpAnswer edit(const std::string& body) const;
  [[nodiscard]] HttpAnswer save(const std::string& text, const std::string& if_match) const;
  [[nodiscard]] HttpAnswer restart(const std::string& if_match);

  std::filesystem::path path_;
  scene::Overrides settings_;
  std::atomic<bool> is_restart_wanted_ = false;
  RequestThread<Request, HttpAnswer> thread_;  // the last member: its end is that of its use of the others
};

}  // namespace slew::view_node
