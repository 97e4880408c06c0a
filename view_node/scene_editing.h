// SPDX-License-Identifier: Apache-2.0
// Editing of the scene that a window was started with, and the restart of its session.
//
// The page has the text that it edits; here nothing is kept between two requests but the file. A request is answered on
// a thread of its own and of low priority, since reading a scene takes its time and the session must not wait:
//
//   GET  /scene.json   {file, text, tag, settings, kinds, elements, problems, ...} of the file (scene/scene_outline.h)
//   POST /scene.json   {text, edit}: the changed text with its elements and problems; nothing is written
//   PUT  /scene.yaml   the text into the file. If-Match names the state that it replaces; a text with problems is
//   refused POST /restart      the session begins again with the file, whose state If-Match names
//
// Only this one file is written, as a whole, and never while it has changed since the page has read it.
#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "gateway/door.h"
#include "scene/scene.h"
#include "view_node/http_answers.h"

namespace slew::view_node {

inline constexpr std::size_t kMostSceneBytes = 400'000;  // with its escapes it fits into a request

class SceneEditing {
 public:
  static constexpr std::size_t kMostWaiting = 16;

  // settings: those over the scene in this session.
  SceneEditing(std::filesystem::path file, scene::Overrides settings);
  SceneEditing(const SceneEditing&) = delete;
  SceneEditing& operator=(const SceneEditing&) = delete;
  // Waits for the request that is being answered; others get no answer.
  ~SceneEditing();

  struct Request {
    gateway::Service service = gateway::Service::scene;
    bool is_change = false;  // no GET or HEAD
    std::string if_match{};
    std::string body{};
  };
  // done is called once, from poll(), or at once where too many requests wait.
  using Done = std::function<void(const HttpAnswer&)>;
  void take(Request request, Done done);
  void poll();
  // True once after a restart was granted.
  [[nodiscard]] bool takes_restart();

  // The answer to one request, on the caller's thread.
  [[nodiscard]] HttpAnswer answer(const Request& request);

 private:
  struct Job {
    Request request;
    Done done;
    HttpAnswer answer{};
  };
  void work();
  [[nodiscard]] HttpAnswer file() const;
  [[nodiscard]] HttpAnswer edit(const std::string& body) const;
  [[nodiscard]] HttpAnswer save(const std::string& text, const std::string& if_match) const;
  [[nodiscard]] HttpAnswer restart(const std::string& if_match);

  std::filesystem::path path_;
  scene::Overrides settings_;
  std::mutex mutex_;  // of all below
  std::condition_variable has_changed_;
  std::deque<Job> waiting_, answered_;
  bool is_restart_wanted_ = false, is_closing_ = false;
  std::thread thread_;
};

}  // namespace slew::view_node
