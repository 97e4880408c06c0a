// SPDX-License-Identifier: Apache-2.0
// The hard cases of one or more scenes, each run in a process of its own, and the table of how they ended.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/extremes/cases.h"
#include "core/json.h"
#include "scene/scene_options.h"

namespace slew::analysis {

struct ExtremesOptions {
  std::vector<std::string> files;  // scenes
  scene::Overrides overrides;      // for all of them
  std::vector<std::string> only;   // patterns of names; empty: all cases
  std::string folder = "runs/extremes";
  int workers = 2;
  bool is_fresh = false;
};

struct ExtremesRow {
  std::string scene, name, what;
  CaseGroup group = CaseGroup::machine;
  std::string obstacle;  // why it does not apply
  bool is_done = false;
  std::string failure;  // failure of its process
  Json result;          // result of case_run.h; null: none

  // within its bounds, refused by name, or not for this scene
  [[nodiscard]] bool is_good() const;
};

struct Extremes {
  std::vector<ExtremesRow> rows;
  std::size_t kept = 0;  // cases of an earlier run
  std::string folder;

  [[nodiscard]] bool is_complete() const;
  [[nodiscard]] bool is_good() const;
};

using ExtremesProgress = std::function<bool(std::string_view doing, double share)>;

// Scenes of this repository that represent its machines: a boom on one cylinder, the crane, the crane with a jib that
// bends, and the crane setting its load down. folder: that of the scenes. Throws Failure when one is missing.
[[nodiscard]] std::vector<std::string> suite_files(const std::string& folder);

// Throws LoadError for a wrong scene, Failure for a pattern without a match.
[[nodiscard]] Extremes run_extremes(const ExtremesOptions& options, const ExtremesProgress& progress);

// width [characters]: of the lines of a table; 0: no limit.
[[nodiscard]] std::string report_text(const Extremes& extremes, std::size_t width = 0);
[[nodiscard]] std::string report_json(const Extremes& extremes);

}  // namespace slew::analysis
