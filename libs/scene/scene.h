// SPDX-License-Identifier: Apache-2.0
// A scene: everything a session needs, read from a file, checked, in SI.
//
// A scene file is YAML (docs/scene-format.md). Reading is strict: unknown and duplicate keys, missing units, wrong
// dimensions, dangling names and values out of range are errors, all reported at once in one LoadError.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/status.h"
#include "coupling/line_force.h"
#include "coupling/port_unit.h"
#include "hydraulics/hydraulics_def.h"
#include "measurement/instruments.h"
#include "multibody/model/defs.h"
#include "scene/defs.h"
#include "scene/devices.h"
#include "scene/diagnostic.h"
#include "scene/graphics.h"
#include "sensors/sensors.h"

namespace slew::flex {
struct Reduction;
}

namespace slew::scene {

// Connection of one actuator of the circuit with one force element of the mechanism. x_port = offset + ratio * (length
// [m] or angle [rad] of the force element) is the stroke [m].
struct PortDef {
  std::string name;   // name of the actuator component
  std::string force;  // name of the force element
  double offset = 0;  // m; rad where unit is the radian
  double ratio = 1;   // 1 for a line, m/rad for an axis, 1 for an axis by its angle
  coupling::LineForceDef line_force;
  coupling::PortLevel level = coupling::PortLevel::session;
  coupling::PortUnit unit = coupling::PortUnit::metre;
  bool shares_volume = false;  // with a chamber of another actuator
  bool has_stages = false;     // areas fall with the stroke
};

// A file that belongs to the scene and must be the same on every machine.
struct Asset {
  std::string name;  // relative to the scene's folder
  std::uint64_t size = 0;
  Sha256 sha256{};
  bool operator==(const Asset&) const = default;
};

// A body with mass properties from a mesh or from shapes, for displays of a scene; the numbers are in its BodyDef.
struct SolidInertia {
  std::string body;
  std::string mesh;    // file; empty: from shapes
  std::string shapes;  // "tube", "3 parts"; empty: from a mesh
  double volume = 0;   // m3
  double density = 0;  // kg/m3; of parts: the mean
};

// A body that bends, for the flex node: its reduction, and the elastic forces of its modes.
struct FlexibleBody {
  std::string body;
  std::shared_ptr<const flex::Reduction> reduction;  // with the selected modes
  std::vector<double> stiffness, damping;            // by pair of modes
};

// A parameter of the scene language (`parameters:`) and its value, such as "L" and "2.6 m".
struct ParameterText {
  std::string name;
  std::string value;
};

struct Scene {
  // compiled once, in the source file, and not in every unit that holds one
  Scene();
  ~Scene();
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;

  std::string name;
  std::string description;
  SessionDef session;
  multibody::MechanicsDef mechanics;
  hydraulics::HydraulicsDef hydraulics;
  std::vector<sensors::SensorDef> sensors;
  std::vector<measurement::InstrumentDef> instruments;  // the types of `sensors:` that measure a variable
  std::vector<InputDef> inputs;                         // the position is the channel's index
  OutputsDef outputs;
  DevicesDef devices;
  ScriptDef script;
  RecordingDef recording;
  std::vector<PlotDef> plots;
  std::vector<GraphicDef> graphics;
  std::vector<PortDef> ports;  // one per actuator, in component order
  std::vector<std::string> warnings;
  std::vector<FlexibleBody> flexible_bodies;  // with modes, in the bodies' order; none in a scene without files
  std::vector<Asset> assets;
  std::vector<TableFile> table_files;          // tables that stay in their files; the read ones are among the assets
  std::vector<std::string> other_payloads;     // bodies that the machine lifts beside mechanics.payload
  std::vector<std::string> started_joints;     // joints that `start:` names; none in a scene from its expanded text
  std::vector<ParameterText> parameter_texts;  // of the scene's own file; none in a scene from its expanded text
  std::vector<SolidInertia> solid_inertias;    // from meshes and shapes; none in a scene from its expanded text

  // The scene after includes and overrides as canonical YAML in SI: reading it gives the same Scene (assets by name).
  std::string expanded_text;

  [[nodiscard]] bool has_mechanics() const noexcept { return !mechanics.bodies.empty(); }
  // True if some body keeps modes; a flex node then takes part.
  [[nodiscard]] bool has_modes() const noexcept;
  // A sensor node then takes part.
  [[nodiscard]] bool has_sensors() const noexcept { return !sensors.empty(); }
  // Steps between two samples for and from flexible bodies.
  [[nodiscard]] std::uint32_t flexible_every() const noexcept;
  // Steps after which all nodes have exchanged: the least common multiple of their exchange periods.
  [[nodiscard]] StepIndex exchange_unit() const noexcept;
  // True if some body bends by modes or segments; its flexible files are then needed.
  [[nodiscard]] bool has_flexible_bodies() const noexcept {
    return !mechanics.flexible_bodies.empty() || !mechanics.segmented_bodies.empty();
  }
  // True if models cannot be built without the folder of the scene's files.
  [[nodiscard]] bool needs_files() const noexcept { return has_flexible_bodies() || !table_files.empty(); }
  [[nodiscard]] bool has_hydraulics() const noexcept { return !hydraulics.volumes.empty(); }
};

// "Bag.mass=1500kg": path and YAML value of one setting.
using Overrides = std::vector<std::string>;

inline constexpr std::size_t kMaxReportedProblems = 20;

// Reads a scene file, its include and its assets. Throws LoadError, nothing else.
[[nodiscard]] Scene load_file(const std::string& path, const Overrides& overrides = {});

// Reading of a script's long tracks from its file: only io needs them.
enum class ScriptFile : std::uint8_t { left_out, read };

// Reads a scene from memory; `name` replaces the file in messages. Includes are not allowed, and assets keep their
// names only (size 0): see check_assets. files: folder of the files of flexible bodies and long tables. Without it
// these stay empty, the mechanics and hydraulics are not checked, and no model can be built (needs_files()). Throws
// LoadError, nothing else.
[[nodiscard]] Scene load_text(std::string text, const std::string& name, const Overrides& overrides = {},
                              const std::optional<std::string>& files = std::nullopt,
                              ScriptFile script = ScriptFile::left_out);

// The scene with the devices and outputs of a file in the place of its own. The file has these two sections alone.
// Throws LoadError, nothing else.
[[nodiscard]] Scene with_devices(const Scene& scene, const std::string& file);

// Error (bad_input) for a scene whose physics is solved as one system: no node can solve a part of it.
[[nodiscard]] Status check_is_split(const Scene& scene);

// Compares the files in a folder with a session's manifest; the error names every missing or different file.
[[nodiscard]] Status check_assets(std::span<const Asset> manifest, const std::string& folder);

}  // namespace slew::scene
