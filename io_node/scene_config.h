// From a scene to what io_node needs: channels, script, parameter directory, asset manifest, roles.
#pragma once

#include <memory>
#include <string>

#include "io_node/io_node.h"
#include "scene/scene.h"
#include "scene/script.h"

namespace slew::io_node {

// The scene's script as a source of raw values and parameter changes.
class ScriptSource final : public InputSource {
 public:
  explicit ScriptSource(const scene::Scene& scene) : player_(scene) {}
  void courses(SimTime from, SimTime to, std::span<SignalCourse> raw) override;
  [[nodiscard]] std::size_t most_pieces(SimDuration length) const noexcept override;
  void changes(SimTime from, SimTime to, std::vector<wire::Command>& due) override;

 private:
  scene::ScriptPlayer player_;
};

// Who moves the inputs that no controller holds.
enum class Operator : std::uint8_t { script, nobody };
enum class Recording : std::uint8_t { required, none };

struct SessionWish {
  std::string session_name;
  Operator operating = Operator::script;
  Recording recording = Recording::required;
};

// Roles that take part: io always, mechanics with bodies, hydraulics with components, the recorder when recording.
[[nodiscard]] std::uint32_t required_roles(const scene::Scene& scene, Recording recording) noexcept;

// Everything about step, pace and duration is the scene's, overrides included.
[[nodiscard]] IoConfig make_config(const scene::Scene& scene, const SessionWish& wish);

}  // namespace slew::io_node
