#include "analysis/comparison/played_scene.h"

#include "core/arithmetic_self_test.h"
#include "core/failure.h"

namespace slew::analysis {

using wire::Role;

PlayedScene::PlayedScene(const scene::Scene& scene)
    : config_(io_node::make_config(scene, {.session_name = scene.name, .recording = io_node::Recording::none})),
      H_(config_.session.step_duration()),
      gate_(config_.channels, config_.gate(), H_),
      session_(scene),
      script_(gate_.size()),
      controls_(gate_.size()) {
  set_floating_point_mode();
  require(session_.start());
}

void PlayedScene::advance() {
  const SimTime t = time();
  commands_.clear();
  if (config_.source != nullptr) {
    config_.source->courses(t, t + H_, script_);
    config_.source->changes(t, t + H_, commands_);
  }
  // only the script moves a channel: the wall clock is never read
  gate_.advance(n_, script_, 0);
  for (std::size_t i = 0; i < controls_.size(); ++i) controls_[i] = gate_.control(i);
  session_.step(n_, commands_, controls_);
  ++n_;
}

StateHashes PlayedScene::state_hashes() const noexcept {
  return {session_.state_hash(Role::mechanics), session_.state_hash(Role::hydraulics)};
}

}  // namespace slew::analysis
