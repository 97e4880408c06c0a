// SPDX-License-Identifier: Apache-2.0
#include "bridge/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/failure.h"
#include "core/suggestion.h"
#include "lcm_log/event_log.h"

namespace slew::bridge {
namespace {

constexpr std::string_view kLongestSuffix = "_DIRECTORY";
// types of idl/slewring.lcm, without _t; in capitals the endings of their channels
constexpr std::string_view kOwnTypes[] = {"variables", "directory", "health", "bridge", "input", "parameter", "reply"};

std::string lower_case(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

}  // namespace

void require_lcm() {}

std::vector<lcm_log::SignalList> read_lists(const Settings& settings) {
  std::vector<lcm_log::SignalList> lists;
  for (const std::string& text : settings.signals) {
    lcm_log::SignalList list;
    require(read_signal_list(text, list));
    const bool is_taken = std::ranges::find(kOwnTypes, lower_case(list.name)) != std::end(kOwnTypes) ||
                          std::ranges::find(lists, list.name, &lcm_log::SignalList::name) != lists.end();
    if (is_taken) {
      throw Failure(ExitCode::bad_input, fmt::format("--signals {}: a channel or type has the name {} already; nothing "
                                                     "was started; choose another",
                                                     text, list.name));
    }
    lists.push_back(std::move(list));
  }
  return lists;
}

std::string prefix_of(const Settings& settings, const std::string& session,
                      std::span<const lcm_log::SignalList> lists) {
  const std::string prefix = settings.prefix.empty() ? "SLEWRING_" + session : settings.prefix;
  std::size_t longest = kLongestSuffix.size();
  for (const lcm_log::SignalList& list : lists) longest = std::max(longest, list.name.size() + 1);
  if (prefix.size() + longest <= lcm_log::kMaxChannelLength) return prefix;
  throw Failure(
      ExitCode::bad_input,
      fmt::format("channels of LCM have at most {} characters, and '{}' with the longest ending has {}; nothing "
                  "was started; choose a shorter prefix with --channel",
                  lcm_log::kMaxChannelLength, prefix, prefix.size() + longest));
}

void check_every(const Settings& settings, const SceneView& scene) {
  if (settings.every <= 0 || settings.every % scene.variables_every == 0) return;
  throw Failure(
      ExitCode::bad_input,
      fmt::format("--every {}: variables are there at every {}th step (recording.every of the scene); nothing "
                  "was started; expected a multiple of {}",
                  settings.every, scene.variables_every, scene.variables_every));
}

void check_names(std::span<const lcm_log::SignalList> lists, const observer::SessionView& view,
                 std::string_view source) {
  std::vector<std::string_view> names;
  for (const observer::VariableView* variable : view.variables()) names.emplace_back(variable->name);
  for (const lcm_log::SignalList& list : lists) {
    for (const std::string& variable : list.variables) {
      if (std::ranges::find(names, std::string_view(variable)) != names.end()) continue;
      const std::string meant = closest(variable, names);
      throw Failure(
          ExitCode::bad_input,
          fmt::format(
              "--signals {}: {} has no variable '{}'; nothing was written or sent; {}", list.name, source, variable,
              meant.empty() ? "'slewring variables SCENE' lists them" : fmt::format("did you mean '{}'?", meant)));
    }
  }
}

}  // namespace slew::bridge
