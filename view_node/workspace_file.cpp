// SPDX-License-Identifier: Apache-2.0
#include "view_node/workspace_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "core/failure.h"
#include "core/input_file.h"
#include "core/json.h"
#include "core/text_output.h"
#include "gateway/client_messages.h"
#include "node/session_options.h"
#include "scene/assets.h"

namespace slew::view_node {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kTagDigits = 32;
constexpr int kDeepestWorkspace = 64;  // levels

// Held by one process at a time, until it is destroyed.
class FolderLock {
 public:
  explicit FolderLock(const fs::path& file) : file_(open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600)) {
    if (file_ >= 0 && flock(file_, LOCK_EX) != 0) error_ = errno;
    if (file_ < 0) error_ = errno;
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock() {
    if (file_ >= 0) close(file_);
  }
  [[nodiscard]] int error() const noexcept { return error_; }

 private:
  int file_;
  int error_ = 0;
};

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
  const FolderLock lock(path_.parent_path() / ".lock");
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

std::string entity_tag(std::string_view content) {
  return "\"" + scene::hex_text(scene::sha256_of(content)).substr(0, kTagDigits) + "\"";
}

bool has_tag(std::string_view list, std::string_view tag) noexcept {
  while (!list.empty()) {
    std::string_view one = list.substr(0, list.find(','));
    list.remove_prefix(std::min(list.size(), one.size() + 1));
    while (one.starts_with(' ')) one.remove_prefix(1);
    while (one.ends_with(' ')) one.remove_suffix(1);
    if (one == "*" || one == tag) return true;
  }
  return false;
}

}  // namespace slew::view_node
