// SPDX-License-Identifier: Apache-2.0
#include "scene/name_pattern.h"

#include <algorithm>
#include <iterator>

#include "core/failure.h"
#include "core/suggestion.h"
#include "scene/names.h"

namespace slew::scene {

std::vector<std::uint32_t> matching(std::span<const std::string> patterns, std::span<const std::string> names) {
  std::vector<std::uint32_t> found;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool is_wanted = std::any_of(patterns.begin(), patterns.end(), [&](const std::string& pattern) {
      return scene::fits_pattern(names[i], pattern);
    });
    if (is_wanted) found.push_back(static_cast<std::uint32_t>(i));
  }
  return found;
}

std::vector<std::string> unmatched(std::span<const std::string> patterns, std::span<const std::string> names) {
  std::vector<std::string> left;
  std::copy_if(patterns.begin(), patterns.end(), std::back_inserter(left), [&](const std::string& pattern) {
    return std::none_of(names.begin(), names.end(),
                        [&](const std::string& name) { return scene::fits_pattern(name, pattern); });
  });
  return left;
}

bool can_meet(std::string_view a, std::string_view b) {
  // meets[i][j]: the rest of a from i and the rest of b from j have a common match
  std::vector<std::vector<bool>> meets(a.size() + 1, std::vector<bool>(b.size() + 1, false));
  for (std::size_t i = a.size() + 1; i-- > 0;) {
    for (std::size_t j = b.size() + 1; j-- > 0;) {
      const bool has_a = i < a.size(), has_b = j < b.size();
      if (has_a && a[i] == '*') {
        meets[i][j] = meets[i + 1][j] || (has_b && meets[i][j + 1]);
      } else if (has_b && b[j] == '*') {
        meets[i][j] = meets[i][j + 1] || (has_a && meets[i + 1][j]);
      } else if (has_a && has_b) {
        meets[i][j] = (a[i] == b[j] || a[i] == '?' || b[j] == '?') && meets[i + 1][j + 1];
      } else {
        meets[i][j] = !has_a && !has_b;
      }
    }
  }
  return meets[0][0];
}

std::string no_variable_text(const std::string& pattern, std::span<const std::string> names) {
  const std::string meant = closest(pattern, std::vector<std::string_view>(names.begin(), names.end()));
  return "there is no variable '" + pattern + "'; " +
         (meant.empty() ? "'slewring variables' lists all" : "did you mean '" + meant + "'?");
}

std::vector<std::string> choose(std::span<const std::string> patterns, std::span<const std::string> names) {
  std::vector<std::string> chosen;
  for (const std::string& pattern : patterns) {
    bool fits_any = false;
    for (const std::string& name : names) {
      if (!scene::fits_pattern(name, pattern)) continue;
      fits_any = true;
      if (std::find(chosen.begin(), chosen.end(), name) == chosen.end()) chosen.push_back(name);
    }
    if (!fits_any) throw Failure(ExitCode::bad_input, no_variable_text(pattern, names));
  }
  return chosen;
}

}  // namespace slew::scene
