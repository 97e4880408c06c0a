// SPDX-License-Identifier: Apache-2.0
#include "io_node/scene_config.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "scene/parameters.h"
#include "scene/script.h"
#include "transport/roles.h"

namespace slew::io_node {

// a scene that was loaded fits the wire
static_assert(scene::kMaxSceneNameLength <= wire::kMaxNameLength);
static_assert(scene::kMaxAssetNameLength <= wire::kMaxReasonLength);
static_assert(scene::kMaxExpandedBytes <= wire::kMaxSceneBytes);

std::uint32_t required_roles(const scene::Scene& scene, Recording recording) noexcept {
  using transport::Needed;
  const auto is_needed = [&](Needed needed) {
    return needed == Needed::always || (needed == Needed::with_mechanics && scene.has_mechanics()) ||
           (needed == Needed::with_hydraulics && scene.has_hydraulics()) ||
           (needed == Needed::with_modes && scene.has_modes()) ||
           (needed == Needed::with_sensors && scene.has_sensors()) ||
           (needed == Needed::to_record && recording == Recording::required);
  };
  std::uint32_t roles = 0;
  for (const transport::RoleTraits& role : transport::roles()) {
    if (is_needed(role.needed)) roles |= bit(role.role);
  }
  return roles;
}

namespace {

// The scene's script drives the inputs for which it has a track.
class ScriptSource final : public InputSource {
 public:
  explicit ScriptSource(const scene::Scene& scene) : player_(scene) {
    for (const scene::ScriptTrack& track : scene.script.tracks) {
      names_.push_back(track.input);
      const auto input = std::ranges::find(scene.inputs, track.input, &scene::InputDef::name);
      inputs_.push_back(static_cast<std::size_t>(input - scene.inputs.begin()));
    }
  }
  [[nodiscard]] std::span<const std::string> channels() const noexcept override { return names_; }
  void read(std::size_t channel, SimTime from, SimTime to, SignalCourse& raw) const override {
    player_.read_course(inputs_[channel], from, to, raw);
  }
  [[nodiscard]] std::size_t most_pieces(SimDuration length) const noexcept override {
    return player_.most_pieces(length);
  }

 private:
  scene::ScriptPlayer player_;
  std::vector<std::string> names_;
  std::vector<std::size_t> inputs_;  // by place in names_: of the scene
};

std::string obstacle_to_saving(const scene::Scene& scene) {
  const std::string_view of_session = scene::obstacle_to_saving(scene.session);
  if (!of_session.empty()) return std::string(of_session);
  if (scene.has_hydraulics() && scene.hydraulics.solver == hydraulics::Solver::cvode) {
    return "hydraulics.solver: cvode keeps a history that cannot be put back; expected another solver";
  }
  return "";
}

}  // namespace

IoConfig make_config(const scene::Scene& scene, std::string session_name, Recording recording) {
  IoConfig config;
  config.session_name = std::move(session_name);
  config.session = scene.session;
  config.scene_name = scene.name;
  config.scene_text = scene.expanded_text;
  for (const scene::Asset& asset : scene.assets) config.assets.push_back({asset.name, asset.size, asset.sha256});
  config.save_obstacle = obstacle_to_saving(scene);
  config.exchange_unit = scene.exchange_unit();
  config.required_roles = required_roles(scene, recording);
  for (const scene::InputDef& input : scene.inputs) {
    ChannelConfig channel;
    channel.name = input.name;
    channel.is_digital = input.type == scene::InputType::digital;
    channel.scale = input.scale;
    channel.dead_zone = input.dead_zone;
    channel.ramp = input.ramp;
    channel.rate_limit = input.rate_limit;
    channel.controller = input.controller;
    channel.delay = input.controller_delay;
    channel.wait = duration_of_seconds(input.controller_wait);
    channel.supervisor = input.supervisor;
    config.channels.push_back(std::move(channel));
  }
  if (!scene.script.tracks.empty()) config.sources.push_back(std::make_unique<ScriptSource>(scene));
  const SimDuration step = scene.session.step_duration();
  for (const scene::ScriptChange& change : scene.script.changes) {
    const SimDuration over = scene::whole_steps(duration_of_seconds(change.over), step);
    config.changes.push_back(
        {start_of(scene::first_step_at(change.at, step), step), {0, change.set, change.value, over.ns}});
  }
  // std::function needs a copyable owner; the directory itself is built once
  const auto directory = std::make_shared<const scene::ParameterDirectory>(scene);
  for (const scene::ParameterInfo& parameter : directory->all()) {
    if (parameter.change == Change::live) config.parameters.push_back({parameter.path, parameter.value});
  }
  config.check_parameter = [directory](const std::string& path, double value, std::int64_t over_ns) {
    const auto over = over_ns >= 0 ? std::optional(SimDuration{over_ns}) : std::nullopt;
    const scene::Assignment assignment = directory->check(path, value, over, scene::Beside::session);
    return ParameterCheck{assignment.status.is_ok(), assignment.status.text, assignment.over.ns};
  };
  config.check_course = [directory](const wire::Command& change, const LiveCourse& course) {
    return directory->refusal_of_course(change.path, change.value, course.present, course.changes);
  };
  config.variables_every = scene.recording.every;
  config.flexible_every = scene.flexible_every();
  return config;
}

}  // namespace slew::io_node
