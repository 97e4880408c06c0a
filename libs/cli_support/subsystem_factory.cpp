#include "cli_support/subsystem_factory.h"

#include <exception>

#include "cli_support/failure.h"
#include "cli_support/name_pattern.h"

namespace slew::cli_support {

Status check_session_assets(const wire::SessionDescription& session, const std::string& assets) {
  std::vector<scene::Asset> manifest;
  for (const wire::Asset& asset : session.assets) manifest.push_back({asset.name, asset.size, asset.sha256});
  return scene::check_assets(manifest, assets);
}

std::vector<std::uint32_t> published_variables(const scene::Scene& scene, const coupling::Subsystem& subsystem) {
  std::vector<std::string> names;
  for (const ElementVariable& variable : subsystem.variables()) names.push_back(variable.name);
  return matching(scene.recording.variables, names);
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

}  // namespace slew::cli_support
