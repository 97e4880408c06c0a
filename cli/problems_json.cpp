// SPDX-License-Identifier: Apache-2.0
#include "cli/problems_json.h"

#include "scene/scene_outline.h"

namespace slew::cli {

Json problems_json(const scene::LoadError& error) {
  return {{"ok", false},
          {"code", static_cast<int>(ExitCode::bad_input)},
          {"problems", scene::diagnostics_json(error)},
          {"omitted", error.omitted()}};
}

Json problems_json(const Failure& failure) {
  const Json problem = {{"file", ""},     {"line", 0},       {"column", 0}, {"path", ""}, {"what", failure.what()},
                        {"expected", ""}, {"suggestion", ""}};
  return {
      {"ok", false}, {"code", static_cast<int>(failure.code())}, {"problems", Json::array({problem})}, {"omitted", 0}};
}

}  // namespace slew::cli
