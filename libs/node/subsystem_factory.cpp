// SPDX-License-Identifier: Apache-2.0
#include "node/subsystem_factory.h"

#include <algorithm>
#include <exception>
#include <iterator>

#include "core/failure.h"
#include "scene/name_pattern.h"

namespace slew::node {

Status check_session_assets(const wire::SessionDescription& session, const std::string& assets) {
  std::vector<scene::Asset> manifest;
  for (const wire::Asset& asset : session.assets) manifest.push_back({asset.name, asset.size, asset.sha256});
  return scene::check_assets(manifest, assets);
}

std::vector<std::uint32_t> published_variables(const scene::Scene& scene, const coupling::Subsystem& subsystem) {
  std::vector<std::string> names, kept;
  for (const ElementVariable& variable : subsystem.variables()) names.push_back(variable.name);
  std::vector<std::uint32_t> published = scene::matching(scene.recording.variables, names);
  // variables of detail are published only if another pattern than "*" selects them
  std::copy_if(scene.recording.variables.begin(), scene.recording.variables.end(), std::back_inserter(kept),
               [](const std::string& pattern) { return pattern != "*"; });
  const std::vector<std::uint32_t> selected = scene::matching(kept, names);
  std::erase_if(published, [&](std::uint32_t i) {
    return subsystem.variables()[i].is_detail && !std::binary_search(selected.begin(), selected.end(), i);
  });
  return published;
}

node::SubsystemFactory subsystem_factory(MakeSubsystem make, std::string assets) {
  // a std::function is copyable, a scene is not: the copies share it
  const auto scene = std::make_shared<scene::Scene>();
  return [make = std::move(make), assets = std::move(assets), scene](const wire::SessionDescription& session,
                                                                     node::BuiltSubsystem& built) -> Status {
    if (Status status = check_session_assets(session, assets); !status.is_ok()) return status;
    try {
      *scene = scene::load_text(session.scene_text, "scene of session '" + session.name + "'", {}, assets);
      built.subsystem = make(*scene);
      built.variables_every = static_cast<std::uint32_t>(scene->recording.every);
      built.session = scene->session;
      built.exchange = exchange_rules(*scene);
      built.exchange_unit = scene->exchange_unit();
      built.published_variables = published_variables(*scene, *built.subsystem);
      return Status::ok();
    } catch (const scene::LoadError& error) {
      return Status::error(ExitCode::bad_input,
                           std::string("this program does not take the session's scene: ") + error.what());
    } catch (const Failure& failure) {
      return Status::error(failure.code(), failure.what());
    } catch (const std::exception& error) {
      return Status::error(ExitCode::failed, std::string("the scene's model was not built: ") + error.what());
    }
  };
}

}  // namespace slew::node
