// SPDX-License-Identifier: Apache-2.0
#include "scene/ports.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>

#include "coupling/samples.h"
#include "hydraulics/curve.h"
#include "hydraulics/end_cushion.h"
#include "multibody/formulations/dynamics.h"

namespace slew::scene {
namespace {

// tolerance for a start at the end of the stroke, with numbers of six digits
constexpr double kStrokeTolerance = 1e-6;  // m

// the hydraulics' choices equal the coupling's
static_assert(static_cast<int>(hydraulics::PortCoupling::session) == static_cast<int>(coupling::PortLevel::session));
static_assert(static_cast<int>(hydraulics::PortCoupling::tlm) == static_cast<int>(coupling::PortLevel::tlm));
static_assert(static_cast<int>(hydraulics::PortUnit::radian) == static_cast<int>(coupling::PortUnit::radian));

template <typename Def>
bool has_element(const std::vector<Def>& defs, std::string_view name) {
  return std::any_of(defs.begin(), defs.end(), [&](const Def& def) { return def.name == name; });
}

PortDef port_of(const std::string& name, const hydraulics::ActuatorDef& actuator) {
  PortDef port;
  port.name = name;
  port.force = actuator.force;
  port.offset = actuator.coordinate.offset;
  port.ratio = actuator.coordinate.ratio;
  port.level = static_cast<coupling::PortLevel>(actuator.coupling);
  port.line_force.efficiency = actuator.line_force.cylinder_coefficient;
  port.line_force.seal_friction = actuator.line_force.seal_friction;
  port.line_force.viscous_friction = actuator.line_force.viscous_friction;
  port.line_force.stroke_min = actuator.line_force.minimum_stroke;
  port.line_force.stroke_max = actuator.line_force.maximum_stroke;
  port.line_force.stop_stiffness = actuator.line_force.end_stiffness;
  port.line_force.stop_damping = actuator.line_force.end_damping;
  port.line_force.seal_speed = actuator.line_force.seal_speed;
  port.line_force.breakaway_friction = actuator.line_force.breakaway_friction;
  port.line_force.stribeck_speed = actuator.line_force.stribeck_speed;
  port.unit = static_cast<coupling::PortUnit>(actuator.coordinate.unit);
  port.has_stages = actuator.has_stages;
  if (actuator.line_force.friction_curve.empty() &&
      actuator.line_force.friction_without_curve == hydraulics::FrictionWithoutCurve::constant) {
    port.line_force.friction_curve = {{0, 0}, {actuator.line_force.seal_speed, 1}};
  }
  return port;
}

void take_curve(PortDef& port, const std::string& name, const Scene& scene, Problems& problems) {
  const hydraulics::CurveDef* curve = hydraulics::find_curve(scene.hydraulics, name);
  // empty if the file of the curve was not read
  if (curve == nullptr || curve->points.empty()) return;
  port.line_force.friction_curve = hydraulics::straight_lines(*curve);
  if (curve->points.front()[0] < 0) {
    problems.push_back({name + ".points",
                        "a friction curve ('" + port.name + "' uses it) is over the magnitude of the speed",
                        "speeds of 0 and more", ""});
  }
}

// The kind of the force element fits what the actuator moves.
void check_force(const PortDef& port, hydraulics::Motion motion, const Scene& scene, Problems& problems) {
  const bool is_linear = motion == hydraulics::Motion::linear;
  const bool fits = is_linear ? has_element(scene.mechanics.translational_forces, port.force)
                              : has_element(scene.mechanics.rotational_forces, port.force);
  if (fits) return;
  const std::string_view wanted = is_linear ? "translational" : "rotational";
  problems.push_back({port.name + ".force", fmt::format("'{}' is not a {} force", port.force, wanted),
                      fmt::format("a force of type {}", wanted), ""});
}

// Piston positions at the start, from the poses of the scene.
std::vector<double> start_strokes(const Scene& scene, const multibody::Model& model) {
  multibody::Workspace workspace(model);
  multibody::evaluate(model, multibody::start_state(model), workspace);
  std::vector<double> strokes;
  for (std::size_t i = 0; i < scene.ports.size(); ++i) {
    strokes.push_back(scene.ports[i].offset + scene.ports[i].ratio * workspace.row_x[i]);
  }
  return strokes;
}

// stroke = offset + ratio angle, with an angle between -180 and 180 deg
void check_half_turn(const PortDef& port, Problems& problems) {
  constexpr double kHalfTurn = std::numbers::pi;
  for (const bool is_max : {false, true}) {
    const double stroke = is_max ? port.line_force.stroke_max : port.line_force.stroke_min;
    const double angle = (stroke - port.offset) / port.ratio;
    if (!std::isfinite(angle) || std::fabs(angle) <= kHalfTurn) continue;
    problems.push_back(
        {port.name + (is_max ? ".maximum_stroke" : ".minimum_stroke"),
         fmt::format("{:.4g} m is {:.4g} deg of '{}', whose angle cannot count turns: revolute joints about its axis "
                     "do not connect its bodies",
                     stroke, angle * 180 / kHalfTurn, port.force),
         "a stroke within 180 deg, or a rotational force about the axis of the revolute joint between its bodies", ""});
  }
}

// A port whose coordinate is an angle turns on and on: its angle must count full turns. So must the angle of a rack and
// pinion whose stroke goes beyond half a turn.
void check_turns(const Scene& scene, const multibody::Model& model, Problems& problems) {
  for (const PortDef& port : scene.ports) {
    for (const multibody::AngleElement& angle : model.angles) {
      if (angle.name != port.force || angle.is_coaxial) continue;
      if (port.unit != coupling::PortUnit::radian) {
        check_half_turn(port, problems);
        continue;
      }
      problems.push_back(
          {port.name + ".force",
           fmt::format("the angle of '{}' cannot count full turns: revolute joints about its axis do not "
                       "connect its bodies",
                       port.force),
           "a rotational force about the axis of the revolute joint between its bodies", ""});
    }
  }
}

}  // namespace

std::string_view obstacle_of(const PortDef& port, coupling::Level level) noexcept {
  if (level != coupling::Level::tlm) return "";
  if (port.unit == coupling::PortUnit::radian) {
    return "level tlm is not for motors: the oil of one step is a large part of the motor's own";
  }
  if (port.has_stages) {
    return "level tlm is not for telescopic cylinders: the area of their lines would change with the stroke";
  }
  if (port.shares_volume) {
    return "level tlm is not for cylinders that share a volume: the waves between their lines grow at any step";
  }
  return "";
}

void make_ports(Scene& scene, Problems& problems) {
  std::map<std::string, int> chambers;  // by volume that is not fixed
  for (const auto& component : scene.hydraulics.components) {
    const std::optional<hydraulics::ActuatorDef> actuator = component->actuator();
    if (!actuator) continue;
    for (const std::string& volume : {actuator->port_a, actuator->port_b}) ++chambers[volume];
  }
  for (const hydraulics::VolumeDef& volume : scene.hydraulics.volumes) {
    if (volume.fixed) chambers.erase(volume.name);
  }
  for (const auto& component : scene.hydraulics.components) {
    const std::optional<hydraulics::ActuatorDef> actuator = component->actuator();
    if (!actuator) continue;
    PortDef port = port_of(component->name, *actuator);
    port.shares_volume = chambers[actuator->port_a] > 1 || chambers[actuator->port_b] > 1;
    take_curve(port, actuator->line_force.friction_curve, scene, problems);
    port.line_force.cushion_min = hydraulics::cushion_law(actuator->line_force.minimum_cushion, scene.hydraulics);
    port.line_force.cushion_max = hydraulics::cushion_law(actuator->line_force.maximum_cushion, scene.hydraulics);
    check_force(port, actuator->motion, scene, problems);
    scene.ports.push_back(std::move(port));
  }
  for (const PortDef& port : scene.ports) {
    if (port.level == coupling::PortLevel::session) continue;
    const std::string_view obstacle = obstacle_of(scene.session, coupling::level_of(port.level));
    if (!obstacle.empty()) problems.push_back({port.name + ".coupling", std::string(obstacle), "session", ""});
  }
  for (const PortDef& port : scene.ports) {
    const bool follows = port.level == coupling::PortLevel::session;
    const coupling::Level level = follows ? scene.session.coupling : coupling::level_of(port.level);
    std::string_view obstacle = obstacle_of(port, level);
    if (obstacle.empty() && !follows) obstacle = obstacle_of(scene.session, level);
    if (obstacle.empty()) continue;
    problems.push_back({port.name + ".coupling", std::string(obstacle),
                        follows ? "coupling: two for this port, or another session.coupling" : "another level", ""});
  }
  if (scene.ports.size() > coupling::kMaxPorts) {
    problems.push_back({scene.ports[coupling::kMaxPorts].name,
                        fmt::format("there are {} cylinders and motors", scene.ports.size()),
                        fmt::format("at most {}", coupling::kMaxPorts), ""});
  }
}

coupling::PortLevels port_levels(const Scene& scene) {
  std::vector<coupling::PortLevels::Port> ports;
  for (const PortDef& port : scene.ports) ports.push_back({port.name, port.level});
  return {scene.session.coupling, std::move(ports)};
}

std::vector<std::string> row_names(const Scene& scene) {
  std::vector<std::string> names;
  for (const PortDef& port : scene.ports) names.push_back(port.force);
  for (std::string& joint : multibody::joint_rows(scene.mechanics)) names.push_back(std::move(joint));
  return names;
}

void check_start(const Scene& scene, Problems& problems) {
  const multibody::Model model = multibody::build_model(scene.mechanics, row_names(scene));
  check_turns(scene, model, problems);
  const std::vector<double> strokes = start_strokes(scene, model);
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    const PortDef& port = scene.ports[i];
    const double min = port.line_force.stroke_min, max = port.line_force.stroke_max;
    const bool is_below = strokes[i] < min - kStrokeTolerance;
    if (!is_below && strokes[i] <= max + kStrokeTolerance) continue;
    problems.push_back({port.name + (is_below ? ".minimum_stroke" : ".maximum_stroke"),
                        fmt::format("the stroke at the start is {:.4g} m, outside of its limits", strokes[i]),
                        fmt::format("lengths and poses that start between {:.4g} and {:.4g} m", min, max), ""});
  }
}

}  // namespace slew::scene
