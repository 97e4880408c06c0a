// SPDX-License-Identifier: Apache-2.0
#include "analysis/extremes/extremes.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>

#include "analysis/sweep/sweep.h"
#include "core/failure.h"
#include "node/identity.h"
#include "scene/name_pattern.h"

namespace slew::analysis {
namespace {

constexpr const char* kSuite[] = {"single_cylinder.yaml", "truck_crane.yaml", "truck_crane_flexible.yaml",
                                  "truck_crane_contact.yaml"};

class Examiner {
 public:
  explicit Examiner(const ExtremesOptions& options) : options_(options) {
    result_.folder = options.folder;
    for (const std::string& file : options.files) plan(file);
    choose();
  }

  Extremes run(const ExtremesProgress& progress) {
    SweepOptions sweep;
    sweep.folder = options_.folder;
    sweep.workers = options_.workers;
    sweep.is_fresh = options_.is_fresh;
    const auto report = [&progress](const SweepState& state) {
      return progress(fmt::format("{}/{}  {}", state.done, state.all, state.doing), state.share);
    };
    const std::vector<SweepResult> results = run_sweep(tasks_, sweep, report);
    for (std::size_t i = 0; i < results.size(); ++i) {
      ExtremesRow& row = result_.rows[row_of_task_[i]];
      row.is_done = results[i].is_done;
      row.failure = results[i].failure;
      row.result = results[i].value;
      if (results[i].was_kept) ++result_.kept;
    }
    return std::move(result_);
  }

 private:
  void plan(const std::string& file) {
    scene::SceneOptions scene_options;
    scene_options.file = file;
    scene_options.overrides = options_.overrides;
    scene_options.overrides.emplace_back("session.solution=split");
    const scene::Scene scene = scene::load_scene(scene_options);
    const std::string text = result_text(scene);
    for (const ExtremeCase& one : extreme_cases(scene)) {
      result_.rows.push_back(
          {.scene = scene.name,
           .name = one.name,
           .what = one.what,
           .group = one.group,
           .obstacle = one.obstacle.empty() ? lack_of_effect(one, scene_options, scene) : one.obstacle,
           .failure = {},
           .result = {}});
      files_.push_back(file);
      texts_.push_back(text);
    }
  }

  // the selected rows, and tasks for those that apply
  void choose() {
    std::vector<std::string> names;
    for (const ExtremesRow& row : result_.rows) names.push_back(row.name);
    std::set<std::string> wanted(names.begin(), names.end());
    if (!options_.only.empty()) {
      const std::vector<std::string> known(wanted.begin(), wanted.end());
      const std::vector<std::string> chosen = scene::choose(options_.only, known);
      wanted = {chosen.begin(), chosen.end()};
    }
    std::vector<ExtremesRow> rows;
    for (std::size_t i = 0; i < result_.rows.size(); ++i) {
      ExtremesRow& row = result_.rows[i];
      if (!wanted.contains(row.name)) continue;
      if (row.obstacle.empty()) {
        const std::vector<std::string> key = {texts_[i], row.name, node::build_id()};
        SweepTask task{.key = key_of(key), .label = row.scene + " " + row.name, .arguments = {}};
        task.arguments = {"extremes-case", files_[i], row.name};
        for (const std::string& one : options_.overrides) task.arguments.insert(task.arguments.end(), {"--set", one});
        tasks_.push_back(std::move(task));
        row_of_task_.push_back(rows.size());
      } else {
        row.is_done = true;
      }
      rows.push_back(std::move(row));
    }
    result_.rows = std::move(rows);
  }

  const ExtremesOptions& options_;
  Extremes result_;
  std::vector<std::string> files_, texts_;  // by planned row
  std::vector<SweepTask> tasks_;
  std::vector<std::size_t> row_of_task_;
};

}  // namespace

bool ExtremesRow::is_good() const {
  if (!obstacle.empty()) return true;
  if (!result.is_object()) return false;
  const std::string& verdict = result.at("verdict").text();
  return verdict == to_text(Verdict::within) || verdict == to_text(Verdict::refused);
}

bool Extremes::is_complete() const {
  return std::all_of(rows.begin(), rows.end(), [](const ExtremesRow& row) { return row.is_done; });
}

bool Extremes::is_good() const {
  return is_complete() && std::all_of(rows.begin(), rows.end(), [](const ExtremesRow& row) { return row.is_good(); });
}

std::vector<std::string> suite_files(const std::string& folder) {
  std::vector<std::string> files;
  for (const char* name : kSuite) {
    files.push_back((std::filesystem::path(folder) / name).string());
    if (std::filesystem::exists(files.back())) continue;
    throw Failure(
        ExitCode::bad_input,
        files.back() + " is not there; nothing was run; set --scenes to the folder of the repository's scenes");
  }
  return files;
}

Extremes run_extremes(const ExtremesOptions& options, const ExtremesProgress& progress) {
  return Examiner(options).run(progress);
}

}  // namespace slew::analysis
