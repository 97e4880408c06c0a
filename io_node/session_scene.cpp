// SPDX-License-Identifier: Apache-2.0
#include "io_node/session_scene.h"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>

#include "core/failure.h"
#include "node/identity.h"
#include "transport/roles.h"

namespace slew::io_node {
namespace {

// t in seconds, as people write it
std::string time_text(double seconds) {
  char text[32] = {};
  std::snprintf(text, sizeof text, "%.6g s", seconds);
  return text;
}

// A table of --input is one over the time of the session, which goes on at `start` [s].
void check_input_times(const scene::SceneOptions& options, double start, scene::Scene& scene) {
  if (options.input == "script" || !options.has_script()) return;
  double first = std::numeric_limits<double>::infinity(), last = 0;
  std::size_t rows = 0;
  for (const scene::ScriptTrack& track : scene.script.tracks) {
    if (track.points.empty()) continue;
    first = std::min(first, track.points.front()[0]);
    last = std::max(last, track.points.back()[0]);
    rows = std::max(rows, track.points.size());
  }
  // one row is a value that is held at all times
  if (rows < 2) return;
  const std::string table = "--input " + options.input, times = time_text(first) + " to " + time_text(last);
  if (last <= start) {
    throw Failure(ExitCode::bad_input, table + ": its times, " + times +
                                           " of the session, are over: the session goes on at " + time_text(start) +
                                           "; nothing was started; add " + time_text(start) +
                                           " to the times of the table");
  }
  if (first == start) return;
  const std::string effect = first < start ? "the rows before are not played"
                                           : "until " + time_text(first) + " the inputs have its first values";
  scene.warnings.push_back(table + ": its times, " + times + ", are those of the session, which goes on at " +
                           time_text(start) + ": " + effect);
}

}  // namespace

SessionScene load_session_scene(const scene::SceneOptions& options) {
  if (options.from.empty()) return {scene::load_scene(options), std::nullopt, {}};
  SavedSession saved;
  require(read_saved(options.from, saved));
  scene::ContinuedScene continued = scene::continue_scene(options, saved.scene_text, saved.scene_name);
  SessionScene session{std::move(continued.scene), ResumeState{}, std::move(saved.assets)};
  scene::Scene& scene = session.scene;
  if (scene.session.duration > 0 && saved.step >= scene.session.steps()) {
    throw Failure(ExitCode::bad_input, options.from + ": the session was saved at " + time_text(saved.time()) +
                                           " and its duration is " + time_text(scene.session.duration) +
                                           "; nothing was started; choose a longer --duration, or 0");
  }
  check_input_times(options, saved.time(), scene);
  for (const wire::Role role : transport::state_roles()) {
    const bool is_needed = (required_roles(scene, Recording::none) & bit(role)) != 0;
    if (!is_needed || saved.find(role) != nullptr) continue;
    throw Failure(ExitCode::bad_input, options.from + ": the file has no state of " + std::string(node::to_text(role)) +
                                           "; nothing was started");
  }
  if (saved.build != node::build_id()) {
    scene.warnings.push_back(options.from + " was saved by build '" + saved.build + "', this is '" + node::build_id() +
                             "': bits may differ from those of the session that was saved");
  }
  session.resume->step = saved.step;
  session.resume->states = std::move(saved.states);
  for (const scene::Assignment& change : continued.changes) {
    session.resume->changes.push_back({0, change.path, change.value, change.over.ns});
  }
  return session;
}

IoConfig make_config(const SessionScene& session, std::string session_name, Recording recording) {
  IoConfig config = make_config(session.scene, std::move(session_name), recording);
  if (!session.resume) return config;
  config.resume = session.resume;
  config.assets = session.assets;
  return config;
}

}  // namespace slew::io_node
