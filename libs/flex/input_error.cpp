// SPDX-License-Identifier: Apache-2.0
#include "flex/input_error.h"

namespace slew::flex {

void refuse_if_any(const Problems& problems) {
  if (problems.empty()) return;
  std::string text;
  for (const Problem& problem : problems) {
    if (!text.empty()) text += '\n';
    text += problem.path + ": " + problem.what;
    if (!problem.expected.empty()) text += "; expected " + problem.expected;
    if (!problem.suggestion.empty()) text += "; did you mean '" + problem.suggestion + "'?";
  }
  throw InputError(text);
}

void refuse_file(const std::filesystem::path& file, std::size_t line, const std::string& what,
                 const std::string& expected, const std::string& remedy) {
  std::string text = file.string();
  if (line > 0) text += ':' + std::to_string(line);
  text += ": " + what;
  if (!expected.empty()) text += "; expected " + expected;
  if (!remedy.empty()) text += "; " + remedy;
  throw InputError(text);
}

}  // namespace slew::flex
