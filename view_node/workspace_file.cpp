// SPDX-License-Identifier: Apache-2.0
#include "view_node/workspace_file.h"

#include <fcntl.h>

#include <cstdlib>
#include <cstring>
#include <utility>

#include "core/failure.h"
#include "core/input_file.h"
#include "core/json.h"
#include "core/text_output.h"
#include "gateway/client_messages.h"
#include "node/session_options.h"
#include "view_node/file_lock.h"

namespace slew::view_node {
namespace {

namespace fs = std::filesystem;

constexpr int kDeepestWorkspace = 64;  // levels

// Empty: the text is a workspace.
std::string problem_of(const std::string& text) {
  if (text.size() > kMostWorkspaceBytes) return "the workspace has more than 1 MiB";
  const gateway::DecodedObject decoded = gateway::decode_object(text, kDeepestWorkspace);
  if (!decoded.object) return "the workspace is not read: " + decoded.problem;
  try {
    if (decoded.object->at("version").integer() >= 1) return "";
  } catch (const Failure&) {  // there is none, or it is no whole number
  }
  return "the workspace has no member 'version' with a whole number from 1";
}

}  // namespace

std::optional<std::string> WorkspaceFile::read() const {
  std::string text;
  if (path_.empty() || read_input(path_, kMostWorkspaceBytes, text)) return std::nullopt;
  return text;
}

WorkspaceFile::Result WorkspaceFile::replace(const std::string& text, const Conditions& conditions) const {
  const auto refuse = [](unsigned status, std::string problem, std::string tag = "") {
    return Result{status, std::move(problem) + "; nothing was written", std::move(tag)};
  };
  if (path_.empty()) return refuse(500, "neither XDG_STATE_HOME nor HOME names a folder for workspaces");
  if (std::string problem = problem_of(text); !problem.empty()) return refuse(400, std::move(problem));
  std::error_code error;
  fs::create_directories(path_.parent_path(), error);
  if (error) return refuse(507, path_.parent_path().string() + ": " + error.message());
  const FileLock lock(path_.parent_path() / ".lock", O_RDWR | O_CREAT);
  if (lock.error() != 0) return refuse(507, path_.parent_path().string() + ": " + std::strerror(lock.error()));
  const std::optional<std::string> present = read();
  const std::string tag = present ? entity_tag(*present) : "";
  const bool is_conditional = !conditions.if_match.empty() || !conditions.if_none_match.empty();
  if (present && !is_conditional)
    return refuse(428, "a workspace is there already: name the state that is replaced with If-Match", tag);
  if ((!conditions.if_match.empty() && (!present || !has_tag(conditions.if_match, tag))) ||
      (present && !conditions.if_none_match.empty() && has_tag(conditions.if_none_match, tag)))
    return refuse(412, "the workspace has changed since this page read it: read it again", tag);
  const Status status = replace_file(path_, [&](const fs::path& part) { return put_text(part, text); });
  if (!status.is_ok()) return refuse(507, status.text, tag);
  return {.status = present ? 204U : 201U, .entity_tag = entity_tag(text)};
}

fs::path workspace_path(const std::string& scene) {
  const char* const state = std::getenv("XDG_STATE_HOME");
  const char* const home = std::getenv("HOME");
  fs::path folder;
  if (state != nullptr && fs::path(state).is_absolute()) {  // relative ones are to be ignored
    folder = state;
  } else if (home != nullptr && *home != '\0') {
    folder = fs::path(home) / ".local/state";
  } else {
    return {};
  }
  return folder / "slewring/workspaces" / (node::session_name_of(scene) + ".json");
}

}  // namespace slew::view_node
