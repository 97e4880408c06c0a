// SPDX-License-Identifier: Apache-2.0
#include "session/run.h"

#include <cstdio>
#include <filesystem>

#include "core/printable.h"

namespace slew::session {
namespace {

// a reason that is forwarded from node to node is cut on the wire, and gets a node's name in front
constexpr std::size_t kCompared = 100;  // characters

std::string_view reason_of(std::string_view message) {
  const std::size_t colon = message.find(": ");
  return colon == std::string_view::npos ? message : message.substr(colon + 2).substr(0, kCompared);
}

}  // namespace

void RunWatcher::report(const std::string& message) {
  std::fprintf(stderr, "%s\n", printable_lines(message).c_str());
}

bool RunWatcher::update(observer::Observer&, std::int64_t, bool) {
  return true;
}

std::string RunOptions::assets() const {
  if (!scene.from.empty()) return scene.assets.empty() ? "." : scene.assets;
  const std::filesystem::path folder = std::filesystem::path(scene.file).parent_path();
  return folder.empty() ? "." : folder.string();
}

void RunClock::measure(std::int64_t now_ns, StepIndex step, bool is_paused) noexcept {
  const bool stands = is_paused && step == last_step_;
  if (last_ns_ != 0) (stands ? paused_ns_ : running_ns_) += now_ns - last_ns_;
  last_ns_ = now_ns;
  last_step_ = step;
}

std::vector<std::string> without_echoes(const std::vector<std::string>& messages) {
  std::vector<std::string> kept;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    bool is_echo = false;
    for (std::size_t j = 0; j < messages.size() && !is_echo; ++j) {
      const bool has_reason = i != j && messages[i].find(reason_of(messages[j])) != std::string::npos;
      // of two equal texts the shorter one is the source; of two of equal length the first
      const bool is_longer = messages[i].size() > messages[j].size() || (messages[i] == messages[j] && i > j);
      is_echo = has_reason && is_longer;
    }
    if (!is_echo) kept.push_back(messages[i]);
  }
  return kept;
}

}  // namespace slew::session
