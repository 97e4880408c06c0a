// SPDX-License-Identifier: Apache-2.0
#include "recording/session_identity.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>

namespace slew::recording {
namespace {

constexpr const char* kVersionKey = "format_version";
constexpr const char* kSceneKey = "scene";
constexpr const char* kSessionNameKey = "session_name";
constexpr const char* kSessionIdKey = "session_id";
constexpr const char* kBuildKey = "build";
constexpr const char* kStepKey = "communication_step_ns";
constexpr const char* kStartedKey = "started_ns";
constexpr const char* kStepsKey = "steps";  // absent: all

constexpr const char* kStepsNames[] = {"all", "ticks", "none"};

bool parse(const TextMap& entries, const char* key, std::int64_t& value) {
  const auto found = entries.find(key);
  if (found == entries.end()) return false;
  const std::string& text = found->second;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

TextMap to_entries(const SessionIdentity& identity) {
  TextMap entries = identity.more;
  entries[kVersionKey] = fmt::to_string(identity.format_version);
  entries[kSceneKey] = identity.scene;
  entries[kSessionNameKey] = identity.session_name;
  entries[kSessionIdKey] = identity.session_id;
  entries[kBuildKey] = identity.build;
  entries[kStepKey] = fmt::to_string(identity.communication_step.ns);
  entries[kStartedKey] = fmt::to_string(identity.started_ns);
  if (identity.steps != RecordedSteps::all) entries[kStepsKey] = kStepsNames[static_cast<std::size_t>(identity.steps)];
  return entries;
}

bool from_entries(const TextMap& entries, SessionIdentity& identity, std::string& problem) {
  std::int64_t version = 0;
  if (!parse(entries, kVersionKey, version) || version < 1) {
    problem = "the recording names no format version; nothing was read; look for an intact copy of the file";
    return false;
  }
  if (version > kFormatVersion) {
    problem = fmt::format(
        "the recording has format version {} and this program reads versions up to {}; nothing was read; use the "
        "slewring that wrote it, or a newer one",
        version, kFormatVersion);
    return false;
  }
  identity.format_version = static_cast<int>(version);
  if (!parse(entries, kStepKey, identity.communication_step.ns) || identity.communication_step.ns < 1) {
    problem = "the recording names no communication step; nothing was read; look for an intact copy of the file";
    return false;
  }
  if (!parse(entries, kStartedKey, identity.started_ns)) identity.started_ns = 0;
  identity.more = entries;
  const auto move_out = [&identity](const char* key) {
    const auto node = identity.more.extract(key);
    return node.empty() ? std::string() : node.mapped();
  };
  identity.scene = move_out(kSceneKey);
  identity.session_name = move_out(kSessionNameKey);
  identity.session_id = move_out(kSessionIdKey);
  identity.build = move_out(kBuildKey);
  const std::string steps = move_out(kStepsKey);
  const auto* const named = std::find(std::begin(kStepsNames), std::end(kStepsNames), steps);
  identity.steps =
      named == std::end(kStepsNames) ? RecordedSteps::all : static_cast<RecordedSteps>(named - std::begin(kStepsNames));
  for (const char* key : {kVersionKey, kStepKey, kStartedKey}) identity.more.erase(key);
  return true;
}

}  // namespace slew::recording
