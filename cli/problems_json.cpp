// SPDX-License-Identifier: Apache-2.0
#include "cli/problems_json.h"

namespace slew::cli {

Json problems_json(const scene::LoadError& error) {
  Json problems = Json::array();
  for (const scene::Diagnostic& diagnostic : error.diagnostics()) {
    problems.push_back({{"file", diagnostic.file},
                        {"line", diagnostic.line},
                        {"column", diagnostic.column},
                        {"path", diagnostic.path},
                        {"what", diagnostic.what},
                        {"expected", diagnostic.expected},
                        {"suggestion", diagnostic.suggestion}});
  }
  return {{"ok", false},
          {"code", static_cast<int>(ExitCode::bad_input)},
          {"problems", problems},
          {"omitted", error.omitted()}};
}

Json problems_json(const Failure& failure) {
  const Json problem = {{"file", ""},     {"line", 0},       {"column", 0}, {"path", ""}, {"what", failure.what()},
                        {"expected", ""}, {"suggestion", ""}};
  return {
      {"ok", false}, {"code", static_cast<int>(failure.code())}, {"problems", Json::array({problem})}, {"omitted", 0}};
}

}  // namespace slew::cli
