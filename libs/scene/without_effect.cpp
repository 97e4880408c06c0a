// SPDX-License-Identifier: Apache-2.0
#include "scene/without_effect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scene/canonical.h"
#include "scene/sections.h"

namespace slew::scene {
namespace {

bool is_zero(const Table& table) {
  return std::all_of(table.begin(), table.end(), [](const auto& point) { return point[1] == 0; });
}

class Search {
 public:
  Search(Scene& scene, Problems& warnings) : scene_(scene), warnings_(warnings), elements_(elements(scene)) {
    for (const ElementRef& element : elements_) {
      for (const Field& field : element.fields) {
        if (field.reference.empty()) continue;
        if (field.type == FieldType::text) referenced_.insert(*static_cast<std::string*>(field.member(element.def)));
        if (field.type != FieldType::texts) continue;
        const auto& names = *static_cast<std::vector<std::string>*>(field.member(element.def));
        referenced_.insert(names.begin(), names.end());
      }
    }
  }

  void run() {
    for (const ElementRef& element : elements_) find_smoothing(element);
    for (const InputDef& input : scene_.inputs) find_in(input);
    for (const auto& load : scene_.mechanics.point_forces) find_in(load, load.force, load.force_table, "force");
    for (const auto& load : scene_.mechanics.point_torques) find_in(load, load.torque, load.torque_table, "torque");
    for (const auto& spring : scene_.mechanics.translational_forces) find_in(spring, "force");
    for (const auto& spring : scene_.mechanics.rotational_forces) find_in(spring, "torque");
    for (const hydraulics::CurveDef& curve : scene_.hydraulics.curves) {
      if (!referenced_.contains(curve.name)) warn(curve.name, "nothing refers to this curve", "a component with it");
    }
    if (scene_.mechanics.contacts.empty() && scene_.session.contact == ContactUse::tested &&
        scene_.mechanics.contact_substep != multibody::MechanicsDef{}.contact_substep) {
      warn("mechanics.contact_substep", "it has no effect: the scene has no contacts", "contacts");
    }
    for (const auto& component : scene_.hydraulics.components) find_unwired(*component);
    if (!scene_.has_hydraulics()) find_without_circuit();
  }

 private:
  void warn(std::string path, std::string what, std::string expected) {
    warnings_.push_back({std::move(path), std::move(what), std::move(expected), ""});
  }

  // inputs that are multiplied by zero
  void find_in(const InputDef& input) {
    if (input.scale == 0) warn(input.name + ".scale", "the input has no effect: its scale is 0", "another scale");
    const auto check_load = [&](const auto& load, double value, const Table& table, std::string_view key) {
      if (load.name != input.primitive || value != 0 || !is_zero(table) || is_changed_live(load.name, key)) return;
      warn(input.name + ".primitive",
           fmt::format("the input has no effect: it is multiplied by the {0} of '{1}', which is 0", key, load.name),
           fmt::format("a {0} other than 0 or a {0}_table, which the input scales", key));
    };
    for (const auto& load : scene_.mechanics.point_forces) check_load(load, load.force, load.force_table, "force");
    for (const auto& load : scene_.mechanics.point_torques) check_load(load, load.torque, load.torque_table, "torque");
    for (const auto& component : scene_.hydraulics.components) {
      if (component->name == input.primitive && input.scale != 0) find_in(input, *component);
    }
  }

  // an input of a component whose signal moves nothing at full stick
  void find_in(const InputDef& input, hydraulics::ComponentDef& component) {
    constexpr double kLeastTravel = 0.02;  // share of a spool's travel that counts as a movement
    double most = 0, overlap = 1;
    bool has_overlap = false;
    for (const Field& field : hydraulics::find_component_type(component.type_name())->fields) {
      if (field.type != FieldType::number) continue;
      const double value = *static_cast<double*>(field.member(component.address()));
      const bool is_gain = field.key.ends_with("_per_signal") || field.key == "opening_gain";
      if (is_gain && value == 0 && !is_changed_live(component.name, field.key)) {
        warn(input.name + ".primitive",
             fmt::format("the input has no effect: the {} of '{}' is 0", field.key, component.name),
             fmt::format("{} other than 0", field.key));
      }
      if (field.key == "maximum_control_signal") most = value;
      if (field.key.starts_with("overlap")) overlap = std::min(overlap, value), has_overlap = true;
    }
    if (!(most > 0)) return;
    const double travel = std::fabs(input.scale) / most, dead = has_overlap ? overlap : 0;
    if (travel > std::max(dead, kLeastTravel)) return;
    warn(input.name + ".scale",
         fmt::format("the input has no effect: at full stick it moves the spool of '{}' by {:.3g} % of its travel{}",
                     component.name, 100 * travel,
                     dead > 0 ? fmt::format(", within {:.3g} % of overlap", 100 * dead) : ""),
         fmt::format("a scale up to the valve's maximum_control_signal, {:g}", most));
  }

  // a proportional valve stays at its least pressure without a signal
  void find_unwired(const hydraulics::ComponentDef& component) {
    if (!hydraulics::member_of<bool>(component, "proportional")) return;
    const bool is_wired = std::any_of(scene_.inputs.begin(), scene_.inputs.end(),
                                      [&](const InputDef& input) { return input.primitive == component.name; });
    if (is_wired) return;
    warn(component.name + ".proportional",
         fmt::format("no input names the valve: it opens at its minimum_pressure of {:.6g} bar all the time",
                     hydraulics::member_of<double>(component, "minimum_pressure") / 1e5),
         fmt::format("an input with primitive: {}, or a valve of one setting", component.name));
  }

  // by the scene's own script, to another value than 0
  [[nodiscard]] bool is_changed_live(std::string_view element, std::string_view key) const {
    const std::string path = fmt::format("{}.{}", element, key);
    return std::any_of(scene_.script.changes.begin(), scene_.script.changes.end(),
                       [&](const ScriptChange& change) { return change.set == path && change.value != 0; });
  }

  template <typename Load>
  void find_in(const Load& load, double value, const Table& table, std::string_view key) {
    if (value != 0 || !is_zero(table) || referenced_.contains(load.name) || is_changed_live(load.name, key)) return;
    warn(load.name, fmt::format("it has no effect: its {} is 0", key),
         fmt::format("a {0} other than 0 or a {0}_table", key));
  }

  // a spring and damper used by an actuator or a dummy carries their force or mass
  template <typename Spring>
  void find_in(const Spring& spring, std::string_view exerted) {
    if (referenced_.contains(spring.name) || spring.spring_constant != 0 || spring.damping_constant != 0 ||
        spring.end_spring_constant != 0 || spring.end_damping_constant != 0 || !is_zero(spring.spring_table) ||
        !is_zero(spring.damper_table)) {
      return;
    }
    for (const std::string_view key :
         {"spring_constant", "damping_constant", "end_spring_constant", "end_damping_constant"}) {
      if (is_changed_live(spring.name, key)) return;
    }
    warn(spring.name, fmt::format("it has no effect: without stiffness and damping it exerts no {}", exerted),
         "a spring_constant, damping_constant or tables, or an actuator that drives it");
  }

  // the smoothing speed of a dry friction of 0, for each coordinate of a joint
  void find_smoothing(const ElementRef& element) {
    constexpr std::string_view kSpeed = "friction_speed", kFriction = "coulomb_friction";
    const auto number = [&](const Field& field) { return *static_cast<double*>(field.member(element.def)); };
    for (const Field& speed : element.fields) {
      if (!speed.key.starts_with(kSpeed) || number(speed) == multibody::JointAxisDef{}.friction_speed) continue;
      const std::string key = std::string(kFriction) + std::string(speed.key.substr(kSpeed.size()));
      const auto friction = std::find_if(element.fields.begin(), element.fields.end(),
                                         [&](const Field& field) { return field.key == key; });
      if (friction == element.fields.end() || number(*friction) != 0 || is_changed_live(element.name, key)) continue;
      warn(fmt::format("{}.{}", element.name, speed.key), fmt::format("it has no effect: {} is 0", key),
           fmt::format("a {} above 0", key));
    }
  }

  void find_without_circuit() {
    if (scene_.session.exchange_every > 1) {
      warn("session.exchange_every", "it has no effect: the scene has no volumes to exchange samples with", "volumes");
    }
    hydraulics::HydraulicsDef defaults;
    for (const SingleTable& table : single_tables()) {
      if (table.section != "hydraulics") continue;
      for (const Field& field : table.fields) {
        if (value_text(field, &scene_.hydraulics) == value_text(field, &defaults)) continue;
        warn("hydraulics." + std::string(field.key), "it has no effect: the scene has no volumes", "volumes");
      }
    }
  }

  Scene& scene_;
  Problems& warnings_;
  std::vector<ElementRef> elements_;
  std::set<std::string> referenced_;
};

}  // namespace

void find_without_effect(Scene& scene, Problems& warnings) {
  Search(scene, warnings).run();
}

// points typed in ms; a file may be longer than the run
void find_points_behind_the_end(const Scene& scene, double end, Problems& warnings) {
  if (scene.script.file) return;
  for (const ScriptTrack& track : scene.script.tracks) {
    for (std::size_t i = 1; i < track.points.size(); ++i) {
      const auto& [time, value] = track.points[i];
      if (time <= end || value == track.points[i - 1][1]) continue;
      warnings.push_back(
          {"script.inputs." + track.input,
           fmt::format("the input does not reach its point at {:g} s: the run ends at {:g} s", time, end),
           "times in s or with a unit, or a longer session.duration", ""});
      break;
    }
  }
}

std::vector<std::string> find_unplayed_inputs(const Scene& scene, const std::string& file, double end) {
  std::vector<std::string> warnings;
  for (const ScriptTrack& track : scene.script.tracks) {
    if (track.points.size() < 2 || track.points[1][0] <= end) continue;
    const double first = track.points.front()[1];
    const auto change = std::find_if(track.points.begin(), track.points.end(),
                                     [first](const auto& point) { return point[1] != first; });
    if (change == track.points.end()) continue;
    warnings.push_back(
        fmt::format("{}: {}: the input does not reach its point at {:g} s: the run ends at {:g} s; expected times in "
                    "s, or a longer "
                    "duration",
                    file, track.input, (*change)[0], end));
  }
  return warnings;
}

}  // namespace slew::scene
