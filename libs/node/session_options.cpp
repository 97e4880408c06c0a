// SPDX-License-Identifier: Apache-2.0
#include "node/session_options.h"

#include <algorithm>

#include "transport/wire.h"

namespace slew::node {
namespace {

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
}

}  // namespace

std::string problem_of_session_name(const std::string& name) {
  if (name.empty() || name.size() > wire::kMaxNameLength) return "a session's name has 1 to 63 characters";
  if (!std::all_of(name.begin(), name.end(), is_name_character)) {
    return "a session's name consists of letters, digits, '_', '-' and '.'";
  }
  return "";
}

std::string session_name_of(const std::string& scene) {
  std::string name = scene.substr(0, wire::kMaxNameLength);
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !is_name_character(c); }, '_');
  return name.empty() ? "session" : name;
}

std::vector<std::string> network_arguments(const SessionOptions& options) {
  // those that the environment would give otherwise too
  std::vector<std::string> arguments = {
      "--domain", std::to_string(options.domain), "--interface", options.interface, "--middleware", options.middleware};
  for (const std::string& peer : options.peers) {
    arguments.push_back("--peer");
    arguments.push_back(peer);
  }
  if (!options.keys.empty()) arguments.insert(arguments.end(), {"--keys", options.keys});
  if (!options.identity.empty()) arguments.insert(arguments.end(), {"--identity", options.identity});
  if (options.is_insecure_lan) arguments.emplace_back("--insecure-lan");
  return arguments;
}

}  // namespace slew::node
