#include "cli_support/name_pattern.h"

#include <algorithm>
#include <string_view>

#include "cli_support/failure.h"
#include "scene/names.h"
#include "scene/suggestion.h"

namespace slew::cli_support {

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

std::vector<std::string> choose(std::span<const std::string> patterns, std::span<const std::string> names) {
  std::vector<std::string> chosen;
  for (const std::string& pattern : patterns) {
    bool fits_any = false;
    for (const std::string& name : names) {
      if (!scene::fits_pattern(name, pattern)) continue;
      fits_any = true;
      if (std::find(chosen.begin(), chosen.end(), name) == chosen.end()) chosen.push_back(name);
    }
    if (fits_any) continue;
    const std::string meant = scene::closest(pattern, std::vector<std::string_view>(names.begin(), names.end()));
    throw Failure(ExitCode::bad_input,
                  "there is no variable '" + pattern + "'; " +
                      (meant.empty() ? "'slewring variables' lists all" : "did you mean '" + meant + "'?"));
  }
  return chosen;
}

}  // namespace slew::cli_support
