#include "analysis/stall_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/display.h"
#include "core/failure.h"
#include "hydraulics/components/double_acting_cylinder.h"
#include "hydraulics/components/l90ls_valve.h"
#include "session/recorded.h"

namespace slew::analysis {
namespace {

using hydraulics::DoubleActingCylinderDef;
using hydraulics::L90lsValveDef;

constexpr double kFullyOpen = 0.9;      // share of the maximum control signal
constexpr double kSettling = 1.0;       // s: spool, load sensing and pump have answered
constexpr double kShortestStall = 0.5;  // s
constexpr double kStandstill = 2e-3;    // m/s
constexpr double kEndOfStroke = 1e-3;   // m

// A cylinder, the valve that feeds it, and the fed side: direction +1 extends, through A.
struct Drive {
  const DoubleActingCylinderDef* cylinder = nullptr;
  const L90lsValveDef* valve = nullptr;
  int direction = 1;

  [[nodiscard]] double area_a() const { return std::numbers::pi / 4 * std::pow(cylinder->common.piston_diameter, 2); }
  [[nodiscard]] double area_b() const { return area_a() - std::numbers::pi / 4 * std::pow(cylinder->rod_diameter, 2); }
  [[nodiscard]] double fed_area() const { return direction > 0 ? area_a() : area_b(); }
  [[nodiscard]] double other_area() const { return direction > 0 ? area_b() : area_a(); }
  [[nodiscard]] const std::string& fed_volume() const {
    return direction > 0 ? cylinder->common.port_a : cylinder->common.port_b;
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
    const auto* cylinder = dynamic_cast<const DoubleActingCylinderDef*>(component.get());
    if (cylinder == nullptr) continue;
    for (const auto& other : scene.hydraulics.components) {
      const auto* valve = dynamic_cast<const L90lsValveDef*>(other.get());
      if (valve == nullptr) continue;
      if (valve->port_a != cylinder->common.port_a || valve->port_b != cylinder->common.port_b) continue;
      drives.push_back({cylinder, valve, 1});
      drives.push_back({cylinder, valve, -1});
    }
  }
  return drives;
}

// The longest stall of a drive.
std::optional<Stall> find_stall(const recording::Reader& reader, const Drive& drive) {
  const std::string& name = drive.cylinder->name;
  const std::vector<std::string> wanted = {drive.valve->name + ".control_signal", name + ".speed", name + ".stroke",
                                           name + ".static_force",
                                           name + (drive.direction > 0 ? ".pressure_b" : ".pressure_a")};
  std::vector<plotting::Series> curves = session::read_series(reader, wanted, session::Units::si);
  plotting::keep_common_instants(curves);  // nodes may end at different times
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
                               ? curves[2].values[i] > drive.cylinder->common.maximum_stroke - kEndOfStroke
                               : curves[2].values[i] < drive.cylinder->common.minimum_stroke + kEndOfStroke;
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
double value_at(const recording::Reader& reader, const std::string& name, double time) {
  const std::string wanted[] = {name};
  const plotting::Series curve = session::read_series(reader, wanted, session::Units::si).front();
  const auto at = std::lower_bound(curve.time.begin(), curve.time.end(), time);
  if (at == curve.time.end()) return curve.values.back();
  return curve.values[static_cast<std::size_t>(at - curve.time.begin())];
}

// The mechanics publishes the mass of its last moving body, and every port's static force per kilogram of it.
std::optional<HeldLoad> find_load(const recording::Reader& reader, const scene::Scene& scene, const Drive& drive,
                                  double time) {
  const session::SessionView view = session::view_recording(reader, session::Values::none);
  for (const multibody::BodyDef& body : scene.mechanics.bodies) {
    if (view.find(body.name + ".mass") == nullptr) continue;
    return HeldLoad{body.name, value_at(reader, body.name + ".mass", time),
                    drive.direction * value_at(reader, drive.cylinder->name + ".static_force_per_kg", time)};
  }
  return std::nullopt;
}

std::string sentence(const recording::Reader& reader, const scene::Scene& scene, const Drive& drive,
                     const Stall& stall) {
  const DoubleActingCylinderDef& cylinder = *drive.cylinder;
  const double tank = [&] {
    for (const hydraulics::VolumeDef& volume : scene.hydraulics.volumes) {
      if (volume.name == drive.valve->port_t) return volume.initial_pressure;
    }
    return 0.0;
  }();
  const double needed = ((stall.static_force + cylinder.common.seal_friction) / cylinder.common.cylinder_coefficient +
                         stall.other_pressure * drive.other_area()) /
                        drive.fed_area();
  const double limit = tank + drive.feed_limit();
  std::string text =
      fmt::format("{} did not {} from {:.1f} to {:.1f} s with {} fully open: moving the load takes {} in {}",
                  cylinder.name, drive.direction > 0 ? "extend" : "retract", stall.from, stall.to, drive.valve->name,
                  quantity_text(needed, "Pa"), drive.fed_volume());
  if (needed <= limit) return text + ", which the valve could feed; look at the pump's pressure in a plot";
  text += fmt::format(", but {} feeds up to {} only (maximum_ls_pressure_{} and compensator_pressure above tank)",
                      drive.valve->name, quantity_text(limit, "Pa"), drive.direction > 0 ? "a" : "b");
  const double available =
      (limit * drive.fed_area() - stall.other_pressure * drive.other_area()) * cylinder.common.cylinder_coefficient -
      cylinder.common.seal_friction;
  const std::optional<HeldLoad> load = find_load(reader, scene, drive, stall.to);
  if (!load || !(load->slope > 0)) return text;
  const double mass = load->mass - (stall.static_force - available) / load->slope;
  if (!(mass > 0)) return text + fmt::format("; not even {} without load could be moved there", load->body);
  return text +
         fmt::format("; {} weighs {:.4g} kg, up to {:.0f} kg could be moved there", load->body, load->mass, mass);
}

}  // namespace

std::vector<std::string> explain_stalls(const recording::Reader& reader, const scene::Scene& scene) {
  std::vector<std::string> sentences;
  for (const Drive& drive : drives_of(scene)) {
    try {
      const std::optional<Stall> stall = find_stall(reader, drive);
      if (stall) sentences.push_back(sentence(reader, scene, drive, *stall));
    } catch (const Failure&) {
      // the scene does not record the variables that this needs
    }
  }
  return sentences;
}

}  // namespace slew::analysis
