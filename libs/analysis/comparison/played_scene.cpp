// SPDX-License-Identifier: Apache-2.0
#include "analysis/comparison/played_scene.h"

#include <utility>

#include "core/arithmetic_self_test.h"
#include "core/failure.h"
#include "io_node/scene_config.h"

namespace slew::analysis {

using wire::Role;

namespace {

io_node::SessionInputs inputs_of(const scene::Scene& scene) {
  io_node::IoConfig config = io_node::make_config(scene, scene.name, io_node::Recording::none);
  return {config, std::move(config.sources)};
}

}  // namespace

PlayedScene::PlayedScene(const scene::Scene& scene)
    : H_(scene.session.step_duration()), inputs_(inputs_of(scene)), session_(scene), controls_(inputs_.gate().size()) {
  set_floating_point_mode();
  require(session_.start());
  take_tick();
}

void PlayedScene::advance() {
  for (std::size_t i = 0; i < controls_.size(); ++i) controls_[i] = inputs_.gate().control(i);
  session_.step(n_, commands_, controls_);
  ++n_;
  take_tick();
}

void PlayedScene::take_tick() {
  // no controller holds a channel: the wall clock is never read
  inputs_.advance(n_, 0, commands_);
}

StateHashes PlayedScene::state_hashes() const noexcept {
  return {session_.state_hash(Role::mechanics), session_.state_hash(Role::hydraulics)};
}

}  // namespace slew::analysis
