// SPDX-License-Identifier: Apache-2.0
#include "analysis/sweep/scene_job.h"

namespace slew::analysis {

void put_scene(Json& job, const scene::SceneOptions& scene) {
  job.put_all(
      {{"scene", scene.file}, {"overrides", scene.overrides}, {"duration", scene.duration}, {"input", scene.input}});
}

scene::SceneOptions scene_in(const Json& job) {
  scene::SceneOptions scene;
  scene.file = job.at("scene").text();
  scene.overrides = job.at("overrides").texts();
  scene.duration = job.at("duration").text();
  scene.input = job.at("input").text();
  scene.is_recording = false;
  return scene;
}

}  // namespace slew::analysis
