// SPDX-License-Identifier: Apache-2.0
#include "analysis/description/liftable_load.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "analysis/description/instant.h"
#include "analysis/description/largest_force.h"
#include "analysis/description/port_limits.h"
#include "analysis/description/settled_pose.h"
#include "core/display.h"
#include "core/failure.h"
#include "core/json.h"
#include "core/report_table.h"
#include "hydraulics/circuit.h"
#include "hydraulics/component_def.h"
#include "hydraulics/pump_lines.h"
#include "mechanics_node/payload.h"

namespace slew::analysis {
namespace {

constexpr double kLowered = 0.01;    // part of a setting
constexpr double kOfSetting = 0.25;  // effect from which a setting limits
constexpr double kTank = 5e5;        // Pa absolute, the most of a tank
constexpr double kNoForce = 1e-9;    // share of the static force: rounding of pressures times areas

// Whether a pump, a source, an accumulator or a fixed volume above the pressure of a tank feeds the circuit.
bool has_supply(const hydraulics::HydraulicsDef& circuit) {
  const bool has_fixed = std::any_of(circuit.volumes.begin(), circuit.volumes.end(), [](const auto& volume) {
    return volume.fixed && volume.initial_pressure > kTank;
  });
  return has_fixed || std::any_of(circuit.components.begin(), circuit.components.end(), [](const auto& component) {
           hydraulics::PumpLines lines;
           component->add_lines(lines);
           return !lines.pumps.empty() || !lines.held.empty() || component->type_name() == "accumulator";
         });
}

// Valves that take a signal and that no input of the scene commands.
std::vector<std::string> uncommanded_valves(const scene::Scene& scene) {
  const hydraulics::Circuit circuit(scene.hydraulics);
  std::vector<std::string> names;
  for (const auto& component : scene.hydraulics.components) {
    const auto commands = [&](const scene::InputDef& input) { return input.primitive == component->name; };
    const bool is_commanded = std::any_of(scene.inputs.begin(), scene.inputs.end(), commands);
    const bool takes_signal = circuit.find_control(component->name) >= 0;
    if (takes_signal && !is_commanded && component->type_name().ends_with("valve")) names.push_back(component->name);
  }
  return names;
}

class Finder {
 public:
  Finder(scene::Scene& scene, const LiftingPose& pose) : scene_(scene), pose_(pose) {}

  LiftableLoad find(ListedSettings settings) {
    LiftableLoad result;
    result.at = pose_.at;
    for (const std::string& joint : pose_.joints) result.pose += (result.pose.empty() ? "" : ", ") + joint;
    if (!scene_.has_mechanics() || scene_.ports.empty()) return result;
    find_static_forces(result);
    if (!result.payload.empty() && result.refusal.empty() && !has_supply(scene_.hydraulics)) {
      result.refusal = "nothing feeds the cylinders: the circuit has no pump, source or accumulator";
    }
    if (result.payload.empty() || !result.refusal.empty()) return result;
    find_limits(result);
    if (settings == ListedSettings::named && result.has_answer()) {
      name_settings(result.ports[static_cast<std::size_t>(result.limiting)]);
    }
    return result;
  }

 private:
  // (1)
  void find_static_forces(LiftableLoad& result) {
    PlayedScene played(scene_);
    play_to(played, pose_.at);
    const mechanics_node::MechanicsSubsystem& mechanics = *mechanics_of(played);
    multibody::Model model = mechanics.model();
    multibody::State state = mechanics.state();
    std::fill(state.u.begin(), state.u.end(), 0.0);
    const int payload = mechanics_node::payload_of(scene_.mechanics, model);
    if (payload == 0) return;
    if (!pose_.joints.empty()) {
      std::vector<std::string> held;
      for (const std::string& joint : pose_.joints) held.push_back(put(joint, model, state));
      result.refusal = settle_free_joints(model, scene_.ports.size(), held, state);
      if (!result.refusal.empty()) return;
    }
    multibody::Workspace ws(model);
    const std::size_t m = scene_.ports.size();
    std::vector<double> ratio, F(m), slope(m);
    for (const scene::PortDef& port : scene_.ports) ratio.push_back(port.ratio);
    result.payload = model.bodies[static_cast<std::size_t>(payload)].name;
    result.mass = mechanics_node::mass_of(model, payload);
    if (!mechanics_node::static_line_forces(model, state, ws, ratio, payload, result.mass, F)) {
      result.refusal = "no forces of the cylinders hold the machine in this pose";
      return;
    }
    for (std::size_t i = 0; i < m; ++i) {
      const scene::PortDef& port = scene_.ports[i];
      result.ports.push_back({.name = port.name,
                              .unit = port.unit,
                              .stroke = port.offset + port.ratio * ws.row_x[i],
                              .static_force = F[i]});
    }
    W_ = mechanics_node::port_mobility(model, ws, ratio);
    mechanics_node::payload_slopes(model, state, ws, ratio, payload, result.mass, slope);
    for (std::size_t i = 0; i < m; ++i) {
      if (std::fabs(slope[i]) >= kNoShare) result.ports[i].force_per_kg = slope[i];
    }
    F_ = std::move(F);
    slope_ = std::move(slope);
  }

  // "Joint=20 deg"; gives the joint's name
  static std::string put(const std::string& text, const multibody::Model& model, multibody::State& state) {
    const std::size_t equals = text.find('=');
    const std::string name = text.substr(0, equals);
    const int index = equals == std::string::npos ? -1 : multibody::find_joint(model, name);
    if (index < 0) {
      throw Failure(ExitCode::bad_input, fmt::format("--pose: '{}' names no joint of the scene; expected Joint=angle, "
                                                     "such as 'Body_Pillar=20 deg'",
                                                     text));
    }
    if (!model.cuts.empty()) {
      throw Failure(ExitCode::bad_input,
                    "--pose: the mechanism has loops, whose joints cannot be put one by one; give the poses of the "
                    "bodies with --set, or a time of the run with --at");
    }
    const multibody::Joint& joint = model.joints[static_cast<std::size_t>(index)];
    const multibody::Link& link = model.links[static_cast<std::size_t>(joint.link)];
    const bool turns = link.joint == multibody::LinkJoint::revolute;
    if (joint.link == 0 || (!turns && link.joint != multibody::LinkJoint::prismatic)) {
      throw Failure(ExitCode::bad_input, fmt::format("--pose: {} has no single coordinate; expected a revolute or "
                                                     "prismatic joint that moves",
                                                     name));
    }
    state.q[static_cast<std::size_t>(link.q)] =
        read_option("--pose", text.substr(equals + 1), turns ? Dimension::angle : Dimension::length);
    return name;
  }

  // (2), (3)
  void find_limits(LiftableLoad& result) {
    std::vector<double> strokes;
    for (const LiftingPort& port : result.ports) strokes.push_back(port.stroke);
    largest_.emplace(scene_, std::move(strokes));
    const PortLimits limits = find_port_limits(*largest_, {W_, F_, slope_, result.mass});
    result.refusal = limits.refusal;
    if (!result.refusal.empty()) return;
    command_of_.assign(result.ports.size(), 0);
    for (std::size_t i = 0; i < result.ports.size(); ++i) {
      const PortLimit& limit = limits.ports[i];
      LiftingPort& port = result.ports[i];
      if (!limit.carries) continue;
      const double direction = port.force_per_kg > 0 ? 1 : -1;
      command_of_[i] = limit.largest.command;
      port.largest_force = limit.largest.force;
      port.pressure = limit.largest.pressure;
      port.chamber = limit.largest.chamber;
      port.input = limit.largest.input;
      port.stick = limit.largest.stick;
      port.is_steady = limit.largest.is_steady;
      port.load = limit.load;
      for (const std::size_t other : limit.with) port.with.push_back(result.ports[other].name);
      const coupling::LineForceDef& ends = scene_.ports[i].line_force;
      port.is_at_end = direction > 0 ? port.stroke >= ends.stroke_max : port.stroke <= ends.stroke_min;
      if (std::fabs(port.largest_force) <= kNoForce * std::fabs(port.static_force)) port.largest_force = 0;
      if (!result.has_answer() || port.load < result.limit().load) result.limiting = static_cast<int>(i);
    }
    if (result.has_answer() && result.limit().largest_force == 0) result.uncommanded = uncommanded_valves(scene_);
  }

  void name_settings(LiftingPort& port) {
    const auto at = static_cast<std::size_t>(
        std::find_if(scene_.ports.begin(), scene_.ports.end(), [&](const auto& one) { return one.name == port.name; }) -
        scene_.ports.begin());
    const hydraulics::Circuit circuit(scene_.hydraulics);
    const auto chamber = static_cast<std::size_t>(circuit.find_volume(port.chamber));
    for (const auto& component : scene_.hydraulics.components) {
      const hydraulics::ComponentType* type = hydraulics::find_component_type(component->type_name());
      for (const Field& field : type->fields) {
        if (field.type != FieldType::number || field.dimension != Dimension::pressure) continue;
        double& value = *static_cast<double*>(field.member(component->address()));
        const double kept = value;
        value = (1 - kLowered) * kept;
        const hydraulics::Stall lowered = largest_->stall(command_of_[at]);
        value = kept;
        const double effect = (port.pressure - lowered.pressures[chamber]) / (kLowered * kept);
        if (effect >= kOfSetting) {
          port.settings.push_back({component->name + "." + std::string(field.key), kept, effect});
        }
      }
    }
    std::stable_sort(port.settings.begin(), port.settings.end(),
                     [](const auto& a, const auto& b) { return a.value * a.effect > b.value * b.effect; });
  }

  scene::Scene& scene_;
  const LiftingPose& pose_;
  std::optional<LargestForces> largest_;
  std::vector<std::size_t> command_of_;  // by port
  std::vector<double> W_, F_, slope_;    // of StaticLoad
};

std::string settings_text(const LiftingPort& port) {
  std::string text;
  for (const LimitingSetting& setting : port.settings) {
    text += (text.empty() ? "" : " and ") + setting.path + " " + quantity_text(setting.value, "Pa");
  }
  return text.empty() ? "no pressure setting limits it" : "limited by " + text;
}

}  // namespace

LiftableLoad find_liftable(scene::Scene& scene, const LiftingPose& pose, ListedSettings settings) {
  return Finder(scene, pose).find(settings);
}

std::vector<LiftableLoad> find_liftable_of_each(scene::Scene& scene, const LiftingPose& pose, ListedSettings settings) {
  std::vector<LiftableLoad> loads = {find_liftable(scene, pose, settings)};
  const std::string first = scene.mechanics.payload;
  for (const std::string& payload : scene.other_payloads) {
    scene.mechanics.payload = payload;
    loads.push_back(find_liftable(scene, pose, settings));
  }
  scene.mechanics.payload = first;
  return loads;
}

namespace {

std::string position_text(const LiftingPort& port, double x) {
  return quantity_text(x, info(coupling::dimensions_of(port.unit).position).si_unit);
}

std::string force_text(const LiftingPort& port, double F) {
  return quantity_text(F, info(coupling::dimensions_of(port.unit).force).si_unit);
}

}  // namespace

std::string limit_text(const LiftableLoad& load) {
  const LiftingPort& port = load.limit();
  const std::string with = port.with.empty() ? "" : fmt::format(" beside {}", fmt::join(port.with, ", "));
  if (port.largest_force == 0) {
    const std::string why = load.uncommanded.empty()
                                ? "nothing feeds it at full stick of any input"
                                : fmt::format("no input commands {}", fmt::join(load.uncommanded, ", "));
    return fmt::format("0 kg of {}: {} has no force, {} in {}{}: {}", load.payload, port.name,
                       quantity_text(port.pressure, "Pa"), port.chamber, with, why);
  }
  return fmt::format("{} kg of {}: {} presses with {} at most, {} in {}{}", std::round(std::max(0.0, port.load)),
                     load.payload, port.name, force_text(port, std::fabs(port.largest_force)),
                     quantity_text(port.pressure, "Pa"), port.chamber, with);
}

std::string report_text(const LiftableLoad& load, std::size_t width) {
  const std::string when = load.pose.empty() ? "at " + duration_text(load.at) : "with " + load.pose;
  if (!load.refusal.empty()) return fmt::format("liftable load {}: {}\n", when, load.refusal);
  if (load.payload.empty()) return "liftable load: no cylinder, or no rigid body that moves\n";
  if (!load.has_answer()) return fmt::format("liftable load {}: no cylinder carries {}\n", when, load.payload);
  std::string text = fmt::format("largest liftable load {}: {}\n{}; the scene has {}\n\n", when, limit_text(load),
                                 settings_text(load.limit()), quantity_text(load.mass, "kg"));
  ReportTable table(
      {"cylinder", "stroke", "static force", "a kg more", "largest force", "pressure", "loaded by", "load"});
  for (const LiftingPort& port : load.ports) {
    if (!port.carries()) {
      table.add({port.name, position_text(port, port.stroke), force_text(port, port.static_force), "none", "-", "-",
                 "-", "carries nothing of it"});
      continue;
    }
    std::string limit = fmt::format("{:.0f} kg", port.load);
    if (port.is_at_end) limit += ", but the piston stands at its end";
    if (!port.is_steady) limit += ", pressure still rising after 30 s";
    table.add({port.name, position_text(port, port.stroke), force_text(port, port.static_force),
               force_text(port, port.force_per_kg), force_text(port, port.largest_force),
               quantity_text(port.pressure, "Pa"),
               port.input.empty() ? "always" : fmt::format("{} at {:+g}", port.input, port.stick), limit});
  }
  return text + table.text("  ", width);
}

Json report_json(const LiftableLoad& load) {
  Json ports = Json::array();
  for (const LiftingPort& port : load.ports) {
    Json json = {{"cylinder", port.name},
                 {"stroke", port.stroke},
                 {"static_force", port.static_force},
                 {"static_force_per_kg", port.force_per_kg},
                 {"carries", port.carries()}};
    if (port.carries()) {
      Json settings = Json::array();
      for (const LimitingSetting& one : port.settings) {
        settings.push_back({{"setting", one.path}, {"value", one.value}, {"effect", one.effect}});
      }
      json.put_all({{"largest_force", port.largest_force},
                    {"pressure", port.pressure},
                    {"chamber", port.chamber},
                    {"input", port.input},
                    {"stick", port.stick},
                    {"load", port.load},
                    {"with", port.with},
                    {"at_end", port.is_at_end},
                    {"steady", port.is_steady},
                    {"settings", settings}});
    }
    ports.push_back(json);
  }
  Json json = {
      {"at", load.at}, {"pose", load.pose}, {"payload", load.payload}, {"mass", load.mass}, {"cylinders", ports}};
  if (load.has_answer()) {
    json["load"] = load.limit().load;
    json["limited_by"] = load.limit().name;
  }
  return json;
}

}  // namespace slew::analysis
