// SPDX-License-Identifier: Apache-2.0
#include "scene/without_effect.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hydraulics/components/four_way_valve.h"
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
      if (load.name != input.primitive || value != 0 || !is_zero(table)) return;
      warn(input.name + ".primitive",
           fmt::format("the input has no effect: it is multiplied by the {0} of '{1}', which is 0", key, load.name),
           fmt::format("a {0} other than 0 or a {0}_table, which the input scales", key));
    };
    for (const auto& load : scene_.mechanics.point_forces) check_load(load, load.force, load.force_table, "force");
    for (const auto& load : scene_.mechanics.point_torques) check_load(load, load.torque, load.torque_table, "torque");
    for (const auto& component : scene_.hydraulics.components) {
      const auto* valve = dynamic_cast<const hydraulics::FourWayValveDef*>(component.get());
      if (valve == nullptr || valve->name != input.primitive || valve->opening_gain != 0) continue;
      warn(input.name + ".primitive",
           fmt::format("the input has no effect: the opening_gain of '{}' is 0", valve->name),
           "an opening_gain other than 0");
    }
  }

  template <typename Load>
  void find_in(const Load& load, double value, const Table& table, std::string_view key) {
    if (value != 0 || !is_zero(table) || referenced_.contains(load.name)) return;
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
      if (friction == element.fields.end() || number(*friction) != 0) continue;
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

}  // namespace slew::scene
