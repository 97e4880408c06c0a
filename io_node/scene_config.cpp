#include "io_node/scene_config.h"

#include "scene/parameters.h"
#include "transport/roles.h"

namespace slew::io_node {

// a scene that was loaded fits the wire
static_assert(scene::kMaxSceneNameLength <= wire::kMaxNameLength);
static_assert(scene::kMaxAssetNameLength <= wire::kMaxReasonLength);
static_assert(scene::kMaxExpandedBytes <= wire::kMaxSceneBytes);

void ScriptSource::courses(SimTime from, SimTime to, std::span<SignalCourse> raw) {
  for (std::size_t i = 0; i < raw.size(); ++i) player_.read_course(i, from, to, raw[i]);
}

std::size_t ScriptSource::most_pieces(SimDuration length) const noexcept {
  return player_.most_pieces(length);
}

void ScriptSource::changes(SimTime from, SimTime to, std::vector<wire::Command>& due) {
  for (const scene::ScriptChange& change : player_.changes(from, to)) {
    wire::Command command;
    command.path = change.set;
    command.value = change.value;
    command.over_ns = duration_of_seconds(change.over).ns;
    due.push_back(std::move(command));
  }
}

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

std::string obstacle_to_saving(const scene::Scene& scene) {
  const std::string_view of_session = scene::obstacle_to_saving(scene.session);
  if (!of_session.empty()) return std::string(of_session);
  if (scene.has_hydraulics() && scene.hydraulics.solver == hydraulics::Solver::cvode) {
    return "hydraulics.solver: cvode keeps a history that cannot be put back; expected another solver";
  }
  return "";
}

}  // namespace

IoConfig make_config(const scene::Scene& scene, const SessionWish& wish) {
  IoConfig config;
  config.session_name = wish.session_name;
  config.session = scene.session;
  config.scene_name = scene.name;
  config.scene_text = scene.expanded_text;
  for (const scene::Asset& asset : scene.assets) config.assets.push_back({asset.name, asset.size, asset.sha256});
  config.save_obstacle = obstacle_to_saving(scene);
  config.exchange_unit = scene.exchange_unit();
  config.required_roles = required_roles(scene, wish.recording);
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
  if (wish.operating == Operator::script && !scene.script.is_empty()) {
    config.source = std::make_unique<ScriptSource>(scene);
  }
  // std::function needs a copyable owner; the directory itself is built once
  const auto directory = std::make_shared<const scene::ParameterDirectory>(scene);
  for (const scene::ParameterInfo& parameter : directory->all()) {
    if (parameter.change == Change::live) config.parameters.push_back({parameter.path, parameter.value});
  }
  config.judge_parameter = [directory](const std::string& path, double value, std::int64_t over_ns) {
    const auto over = over_ns >= 0 ? std::optional(SimDuration{over_ns}) : std::nullopt;
    const scene::Assignment assignment = directory->check(path, value, over);
    return ParameterVerdict{assignment.status.is_ok(), assignment.status.text, assignment.over.ns};
  };
  config.variables_every = scene.recording.every;
  config.flexible_every = scene.flexible_every();
  return config;
}

}  // namespace slew::io_node
