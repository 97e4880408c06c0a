// SPDX-License-Identifier: Apache-2.0
#include "urdf/names.h"

#include <algorithm>
#include <string_view>

#include "multibody/model/defs.h"
#include "scene/defs.h"
#include "scene/sections.h"
#include "urdf/transliteration.h"

namespace slew::urdf {
namespace {

// a name of letters, digits and _ that begins with a letter or _
std::string word_of(const std::string& name) {
  std::string word = in_ascii(name);
  for (char& c : word) {
    const bool is_kept = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (!is_kept) c = '_';
  }
  if (word.empty() || (word[0] >= '0' && word[0] <= '9')) word.insert(0, "_");
  return word;
}

// Long words lose their middle: names of parts differ at both ends ("..._left", "..._right").
std::string joined(const std::string& word, const std::string& end) {
  const std::size_t room = scene::kMaxNameLength - std::min(end.size(), scene::kMaxNameLength);
  if (word.size() <= room) return word + end;
  if (room < 3) return word.substr(0, room) + end;
  const std::size_t tail = room / 2, head = room - tail - 1;
  return word.substr(0, head) + '_' + word.substr(word.size() - tail) + end;
}

}  // namespace

namespace {

// words that are no text in YAML, in any script of small and capital letters
bool is_value_of_yaml(std::string word) {
  for (char& c : word) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  constexpr std::string_view kValues[] = {"null", "true", "false", "yes", "no", "on", "off", "y", "n"};
  return std::find(std::begin(kValues), std::end(kValues), word) != std::end(kValues);
}

}  // namespace

SceneNames::SceneNames() {
  taken_.emplace(multibody::kGroundName);
  for (const std::string_view key : scene::top_level_keys()) taken_.emplace(key);
}

std::string SceneNames::take(const std::string& name, const std::string& suffix) {
  const std::string word = word_of(name);
  std::string given = joined(word, "");
  if (taken_.contains(given) || is_value_of_yaml(given)) given = joined(word, suffix);
  for (int number = 2; taken_.contains(given); ++number) given = joined(word, suffix + "_" + std::to_string(number));
  taken_.insert(given);
  return given;
}

}  // namespace slew::urdf
