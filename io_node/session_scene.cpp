// SPDX-License-Identifier: Apache-2.0
#include "io_node/session_scene.h"

#include <cstdio>
#include <utility>

#include "core/failure.h"
#include "node/identity.h"

namespace slew::io_node {
namespace {

// t in seconds, as people write it
std::string time_text(double seconds) {
  char text[32] = {};
  std::snprintf(text, sizeof text, "%.6g s", seconds);
  return text;
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
  for (const wire::Role role : wire::kStateRoles) {
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
