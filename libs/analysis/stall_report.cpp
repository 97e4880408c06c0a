// SPDX-License-Identifier: Apache-2.0
#include "analysis/stall_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/display.h"
#include "core/failure.h"
#include "hydraulics/components/l90ls_valve.h"

namespace slew::analysis {
namespace {

using hydraulics::ActuatorDef;
using hydraulics::L90lsValveDef;

constexpr double kFullyOpen = 0.9;      // share of the maximum control signal
constexpr double kSettling = 1.0;       // s: spool, load sensing and pump have answered
constexpr double kShortestStall = 0.5;  // s
constexpr double kStandstill = 2e-3;    // m/s
constexpr double kEndOfStroke = 1e-3;   // m

// An actuator, the valve that feeds it, and the side that is fed: direction +1 extends, through A.
struct Drive {
  std::string name;
  ActuatorDef actuator;
  const L90lsValveDef* valve = nullptr;
  int direction = 1;

  [[nodiscard]] double fed_area() const { return direction > 0 ? actuator.area_a : actuator.area_b; }
  [[nodiscard]] double other_area() const { return direction > 0 ? actuator.area_b : actuator.area_a; }
  [[nodiscard]] const std::string& fed_volume() const { return direction > 0 ? actuator.port_a : actuator.port_b; }
  [[nodiscard]] const char* motion() const {
    if (actuator.motion == hydraulics::Motion::rotary) return direction > 0 ? "turn forwards" : "turn back";
    return direction > 0 ? "extend" : "retract";
  }
  // pressure above tank
  [[nodiscard]] double feed_limit() const {
    return (direction > 0 ? valve->maximum_ls_pressure_a : valve->maximum_ls_pressure_b) + valve->compensator_pressure;
  }
};

struct Stall {
  double from = 0, to = 0;    // s
  double other_pressure = 0;  // Pa, at the end
  double static_force = 0;    // N, against the direction: positive
};

std::vector<Drive> drives_of(const scene::Scene& scene) {
  std::vector<Drive> drives;
  for (const auto& component : scene.hydraulics.components) {
    const std::optional<ActuatorDef> actuator = component->actuator();
    if (!actuator) continue;
    for (const auto& other : scene.hydraulics.components) {
      const auto* valve = dynamic_cast<const L90lsValveDef*>(other.get());
      if (valve == nullptr) continue;
      if (valve->port_a != actuator->port_a || valve->port_b != actuator->port_b) continue;
      drives.push_back({component->name, *actuator, valve, 1});
      drives.push_back({component->name, *actuator, valve, -1});
    }
  }
  return drives;
}

std::vector<std::string> variables_of(const Drive& drive) {
  const std::string& name = drive.name;
  const char* const position = drive.actuator.coordinate.unit == hydraulics::PortUnit::metre ? ".stroke" : ".angle";
  return {drive.valve->name + ".control_signal", name + ".speed", name + position, name + ".static_force",
          name + (drive.direction > 0 ? ".pressure_b" : ".pressure_a")};
}

// The longest stall of a drive.
std::optional<Stall> find_stall(const session::Curves& all, const Drive& drive) {
  std::vector<plotting::Series> curves = all.select(variables_of(drive), session::Units::si);
  plotting::keep_common_instants(curves);  // of nodes that did not end together
  const std::size_t size = curves[0].values.size();
  const double sign = drive.direction;
  std::optional<Stall> longest;
  Stall stall;
  double open_since = -1, standing_since = -1;
  for (std::size_t i = 0; i < size; ++i) {
    const double time = curves[0].time[i];
    const bool is_open = sign * curves[0].values[i] >= kFullyOpen * drive.valve->maximum_control_signal;
    if (!is_open) open_since = -1;
    if (is_open && open_since < 0) open_since = time;
    const bool is_at_end = drive.direction > 0
                               ? curves[2].values[i] > drive.actuator.line_force.maximum_stroke - kEndOfStroke
                               : curves[2].values[i] < drive.actuator.line_force.minimum_stroke + kEndOfStroke;
    const bool stands = is_open && time - open_since >= kSettling && !is_at_end &&
                        sign * curves[1].values[i] < kStandstill && sign * curves[3].values[i] > 0;
    if (!stands) standing_since = -1;
    if (stands && standing_since < 0) standing_since = time;
    if (!stands || time - standing_since < kShortestStall) continue;
    stall = {standing_since, time, curves[4].values[i], sign * curves[3].values[i]};
    if (!longest || stall.to - stall.from >= longest->to - longest->from) longest = stall;
  }
  return longest;
}

// The load in the mechanics: its mass and the force that each kilogram takes of the cylinder.
struct HeldLoad {
  std::string body;
  double mass = 0;   // kg, at the stall
  double slope = 0;  // N/kg, slope of the static force against the direction
};

// Value of a variable at a time.
double value_at(const session::Curves& curves, const std::string& name, double time) {
  const std::string wanted[] = {name};
  const plotting::Series curve = curves.select(wanted, session::Units::si).front();
  const auto at = std::lower_bound(curve.time.begin(), curve.time.end(), time);
  if (at == curve.time.end()) return curve.values.back();
  return curve.values[static_cast<std::size_t>(at - curve.time.begin())];
}

// The mechanics states the mass of its last moving body, and every port's static force per kilogram of it.
std::optional<HeldLoad> find_load(const session::Curves& curves, const scene::Scene& scene, const Drive& drive,
                                  double time) {
  for (const multibody::BodyDef& body : scene.mechanics.bodies) {
    if (!curves.has(body.name + ".mass")) continue;
    return HeldLoad{body.name, value_at(curves, body.name + ".mass", time),
                    drive.direction * value_at(curves, drive.name + ".static_force_per_kg", time)};
  }
  return std::nullopt;
}

std::string sentence(const session::Curves& curves, const scene::Scene& scene, const Drive& drive, const Stall& stall) {
  const hydraulics::LineForceParameters& line = drive.actuator.line_force;
  const double tank = [&] {
    for (const hydraulics::VolumeDef& volume : scene.hydraulics.volumes) {
      if (volume.name == drive.valve->port_t) return volume.initial_pressure;
    }
    return 0.0;
  }();
  const double needed = ((stall.static_force + line.seal_friction) / line.cylinder_coefficient +
                         stall.other_pressure * drive.other_area()) /
                        drive.fed_area();
  const double limit = tank + drive.feed_limit();
  std::string text = fmt::format(
      "{} did not {} from {:.1f} to {:.1f} s with {} fully open: moving the load takes {} in {}", drive.name,
      drive.motion(), stall.from, stall.to, drive.valve->name, quantity_text(needed, "Pa"), drive.fed_volume());
  if (needed <= limit) return text + ", which the valve could feed; look at the pump's pressure in a plot";
  text += fmt::format(", but {} feeds up to {} only (maximum_ls_pressure_{} and compensator_pressure above tank)",
                      drive.valve->name, quantity_text(limit, "Pa"), drive.direction > 0 ? "a" : "b");
  const double available =
      (limit * drive.fed_area() - stall.other_pressure * drive.other_area()) * line.cylinder_coefficient -
      line.seal_friction;
  const std::optional<HeldLoad> load = find_load(curves, scene, drive, stall.to);
  if (!load || !(load->slope > 0)) return text;
  const double mass = load->mass - (stall.static_force - available) / load->slope;
  if (!(mass > 0)) return text + fmt::format("; not even {} without load could be moved there", load->body);
  return text +
         fmt::format("; {} weighs {:.4g} kg, up to {:.0f} kg could be moved there", load->body, load->mass, mass);
}

}  // namespace

std::vector<std::string> stall_variables(const scene::Scene& scene) {
  std::vector<std::string> names;
  for (const Drive& drive : drives_of(scene)) {
    for (std::string& name : variables_of(drive)) names.push_back(std::move(name));
    names.push_back(drive.name + ".static_force_per_kg");
  }
  for (const multibody::BodyDef& body : scene.mechanics.bodies) {
    if (!names.empty()) names.push_back(body.name + ".mass");
  }
  return names;
}

std::vector<std::string> explain_stalls(const session::Curves& curves, const scene::Scene& scene) {
  std::vector<std::string> sentences;
  for (const Drive& drive : drives_of(scene)) {
    try {
      const std::optional<Stall> stall = find_stall(curves, drive);
      if (stall) sentences.push_back(sentence(curves, scene, drive, *stall));
    } catch (const Failure&) {
      // the scene does not record the variables that this needs
    }
  }
  return sentences;
}

}  // namespace slew::analysis
