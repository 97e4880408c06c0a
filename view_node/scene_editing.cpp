// SPDX-License-Identifier: Apache-2.0
#include "view_node/scene_editing.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>
#include <utility>

#include "core/failure.h"
#include "core/input_file.h"
#include "core/text_output.h"
#include "gateway/client_messages.h"
#include "scene/scene_outline.h"
#include "view_node/entity_tag.h"
#include "view_node/file_lock.h"

namespace slew::view_node {
namespace {

namespace fs = std::filesystem;
using gateway::Service;

constexpr int kNiceness = 10;       // behind the nodes of the session
constexpr int kDeepestRequest = 4;  // levels

HttpAnswer json_answer(const Json& json, unsigned status = 200) {
  HttpAnswer answer;
  answer.status = status;
  answer.type = "application/json";
  answer.content = std::make_shared<const std::string>(json.dump() + "\n");
  return answer;
}

HttpAnswer too_large() {
  return sentence(413, fmt::format("the scene's text has more than {} kB, the most that the page edits; nothing was "
                                   "changed; use an editor",
                                   kMostSceneBytes / 1000));
}

// The text of the file, or the answer with its fault.
struct FileText {
  std::string text{};
  std::optional<HttpAnswer> fault{};
};
FileText read_file(const fs::path& path) {
  FileText file;
  if (const auto fault = read_input(path, kMostSceneBytes, file.text))
    file.fault = sentence(409, path.filename().string() + ": " + fault->text() + "; nothing was changed");
  return file;
}

HttpAnswer missing_condition() {
  return sentence(428, "the request does not name the state of the file with If-Match; nothing was changed");
}

HttpAnswer other_state(const std::string& tag) {
  HttpAnswer answer =
      sentence(412, "the scene's file has changed since this page read it; nothing was changed; read it again");
  answer.entity_tag = tag;
  return answer;
}

}  // namespace

SceneEditing::SceneEditing(fs::path file, scene::Overrides settings)
    : path_(std::move(file)),
      settings_(std::move(settings)),
      thread_(kMostWaiting, kNiceness, [this](const Request& request) { return answer(request); }) {}

void SceneEditing::take(Request request, Done done) {
  if (!thread_.take(std::move(request), done))
    done(sentence(503, "too many changes of the scene wait; nothing was changed; try again"));
}

HttpAnswer SceneEditing::answer(const Request& request) {
  try {
    if (request.service == Service::saving) return save(request.body, request.if_match);
    if (request.service == Service::restart) return restart(request.if_match);
    return request.is_change ? edit(request.body) : file();
  } catch (const Failure& failure) {
    return sentence(400, std::string(failure.what()) + "; nothing was changed");
  } catch (const std::exception& error) {
    return sentence(500, std::string(error.what()) + "; nothing was changed");
  }
}

HttpAnswer SceneEditing::file() const {
  FileText file = read_file(path_);
  if (file.fault) return *file.fault;
  Json json = scene::outline_json(path_.string(), file.text, settings_);
  json.put_all({{"file", path_.string()},
                {"text", file.text},
                {"tag", entity_tag(file.text)},
                {"settings", settings_},
                {"kinds", scene::kinds_json()}});
  return json_answer(json);
}

HttpAnswer SceneEditing::edit(const std::string& body) const {
  const gateway::DecodedObject decoded = gateway::decode_object(body, kDeepestRequest);
  if (!decoded.object) return sentence(400, "the request is not read: " + decoded.problem + "; nothing was changed");
  const Json* change = decoded.object->find("edit");
  if (change != nullptr && !change->is_object()) return sentence(400, "'edit' is no object; nothing was changed");
  const std::string& text = decoded.object->at("text").text();
  if (text.size() > kMostSceneBytes) return too_large();
  const scene::EditedText edited = scene::edit_text(path_.string(), text, change == nullptr ? Json::object() : *change);
  if (edited.text.size() > kMostSceneBytes) return too_large();
  Json json = scene::outline_json(path_.string(), edited.text, settings_);
  json.put_all({{"text", edited.text}, {"refusal", edited.refusal}, {"notes", edited.notes}});
  return json_answer(json);
}

HttpAnswer SceneEditing::save(const std::string& text, const std::string& if_match) const {
  if (if_match.empty()) return missing_condition();
  if (text.size() > kMostSceneBytes) return too_large();
  const Json outline = scene::outline_json(path_.string(), text, settings_);
  if (!outline.at("problems").items().empty()) return json_answer(outline, 422);
  const fs::path path = fs::canonical(path_);  // a link stays one
  // another process that waits for it compares with the new file
  const FileLock lock(path, O_RDONLY);
  // on a file system without locks the comparison alone keeps two processes apart
  const bool has_no_locks = lock.error() == ENOLCK || lock.error() == EOPNOTSUPP;
  if (lock.error() != 0 && !has_no_locks)
    return sentence(507, path.string() + ": " + std::strerror(lock.error()) + "; nothing was changed");
  const FileText present = read_file(path);
  if (present.fault) return *present.fault;
  const std::string tag = entity_tag(present.text);
  if (!has_tag(if_match, tag)) return other_state(tag);
  if (access(path.c_str(), W_OK) != 0 || access(path.parent_path().c_str(), W_OK) != 0) {
    return sentence(507, path.string() +
                             " or its folder cannot be written by this user; nothing was changed; copy the "
                             "scene and its files, and open the window for the copy");
  }
  const Status status = replace_file(path, [&](const fs::path& part) {
    const Status put = put_text(part, text);
    std::error_code ignored;
    if (put.is_ok()) fs::permissions(part, fs::status(path).permissions(), ignored);
    return put;
  });
  if (!status.is_ok()) return sentence(507, status.text);
  return {.status = 204, .entity_tag = entity_tag(text)};
}

HttpAnswer SceneEditing::restart(const std::string& if_match) {
  if (if_match.empty()) return missing_condition();
  const FileText present = read_file(path_);
  if (present.fault) return *present.fault;
  const std::string tag = entity_tag(present.text);
  if (!has_tag(if_match, tag)) return other_state(tag);
  const Json outline = scene::outline_json(path_.string(), present.text, settings_);
  if (!outline.at("problems").items().empty()) return json_answer(outline, 422);
  is_restart_wanted_ = true;
  return {.status = 202};
}

}  // namespace slew::view_node
