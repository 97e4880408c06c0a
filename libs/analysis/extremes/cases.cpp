// SPDX-License-Identifier: Apache-2.0
#include "analysis/extremes/cases.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hydraulics/components/hose.h"
#include "scene/parameters.h"
#include "session/direct_session.h"

namespace slew::analysis {
namespace {

constexpr const char* kOilWithModulus = "hydraulics.oil_law=oil_and_air";  // the law that uses a case's numbers
constexpr double kHeavyLoad = 1500;                                        // kg
constexpr double kLeastLoad = 1e-3;                        // kg, in the place of a mass that must be more than 0
constexpr double kSmallVolume = 1e-6;                      // m3
constexpr double kSoftOil = 70e6, kHardOil = 2e9;          // Pa
constexpr double kFullStroke = 12;                         // s of full input one way
constexpr std::int64_t kLateTime = std::int64_t{1} << 62;  // ns
constexpr std::int64_t kLateStep = std::int64_t{1} << 32;

std::string set(const std::string& path, double value) {
  return fmt::format("{}={:.17g}", path, value);
}

// Parts of a scene that cases can be made of.
class Parts {
 public:
  explicit Parts(const scene::Scene& scene) : scene_(scene), directory_(scene) {
    for (const scene::ParameterInfo& one : directory_.all()) paths_.push_back(one.path);
    const session::DirectSession session(scene);
    const coupling::Subsystem* mechanics = session.subsystem(wire::Role::mechanics);
    if (mechanics == nullptr) return;
    // only the payload shows its mass
    for (const ElementVariable& variable : mechanics->variables()) {
      if (variable.name.ends_with(".mass")) payload_ = variable.name;
    }
  }

  [[nodiscard]] const std::string& payload() const noexcept { return payload_; }
  [[nodiscard]] bool may_be(const std::string& path, double value) const {
    return directory_.check(path, value).status.is_ok();
  }
  [[nodiscard]] bool is_already(const std::string& path, double value) const {
    const scene::ParameterInfo* const parameter = directory_.find(path);
    return parameter != nullptr && parameter->value == value;
  }
  // every parameter of this name, of whatever element
  [[nodiscard]] scene::Overrides all(std::string_view field, double value) const {
    scene::Overrides overrides;
    for (const std::string& path : paths_) {
      if (path.ends_with("." + std::string(field))) overrides.push_back(set(path, value));
    }
    return overrides;
  }
  [[nodiscard]] bool has(std::string_view field) const { return !all(field, 0).empty(); }
  // parameters of elements that take an input
  [[nodiscard]] scene::Overrides of_driven(std::string_view field, double value) const {
    scene::Overrides overrides;
    for (const scene::InputDef& input : scene_.inputs) {
      const std::string path = input.primitive + "." + std::string(field);
      if (directory_.find(path) != nullptr) overrides.push_back(set(path, value));
    }
    return overrides;
  }

  [[nodiscard]] std::string without_hydraulics() const { return scene_.has_hydraulics() ? "" : "no circuit"; }
  [[nodiscard]] std::string without_inputs() const { return scene_.inputs.empty() ? "no input" : ""; }
  [[nodiscard]] std::string without_ports() const {
    return scene_.ports.empty() ? "no actuator between circuit and mechanism" : "";
  }
  [[nodiscard]] std::string without(std::string_view field) const {
    return has(field) ? "" : fmt::format("nothing has a {}", field);
  }

 private:
  const scene::Scene& scene_;
  scene::ParameterDirectory directory_;
  std::vector<std::string> paths_;
  std::string payload_;
};

void append(scene::Overrides& to, const scene::Overrides& more) {
  to.insert(to.end(), more.begin(), more.end());
}

bool has_ground_pair(const scene::Scene& scene) {
  return std::any_of(scene.mechanics.contacts.begin(), scene.mechanics.contacts.end(),
                     [&](const multibody::ContactPairDef& pair) { return ground_shape(scene, pair) != nullptr; });
}

using Cases = std::vector<ExtremeCase>;

void add_machine(const scene::Scene& scene, const Parts& parts, Cases& cases) {
  const auto add = [&cases](ExtremeCase one) { cases.push_back(std::move(one)); };
  const std::string no_inputs = parts.without_inputs(), no_circuit = parts.without_hydraulics();
  add({.name = "start_at_1_bar",
       .what = "every volume starts at its initial pressure, the load falls onto oil and air",
       .obstacle = no_circuit,
       .overrides = {"hydraulics.start=table13"}});
  const std::string no_payload = parts.payload().empty() ? "no body moves" : "";
  const auto load = [&](const char* name, double mass) {
    ExtremeCase one{.name = name,
                    .what = fmt::format("{} to {} kg within one step", parts.payload(), mass),
                    .obstacle = no_payload};
    if (no_payload.empty()) one.changes = {{0.5, parts.payload(), mass}};
    if (parts.is_already(parts.payload(), mass)) one.obstacle = "it changes nothing: the mass is this already";
    return one;
  };
  add(load("load_1500_kg", kHeavyLoad));
  const bool may_vanish = no_payload.empty() && parts.may_be(parts.payload(), 0);
  ExtremeCase lightest = load("load_0_kg", may_vanish ? 0 : kLeastLoad);
  if (!may_vanish && no_payload.empty()) lightest.what += " (0 kg is refused: a mass is more than 0)";
  add(std::move(lightest));
  add({.name = "end_stops",
       .what = "full input until the strokes end, then full input the other way",
       .obstacle = no_inputs,
       .duration = 2 * kFullStroke,
       .inputs = {{0.2, 1}, {kFullStroke, -1}},
       .aim = Aim::limit});
  add({.name = "valves_closed_rising",
       .what = "all inputs to 0 at once in full motion, opening strokes",
       .obstacle = no_inputs,
       .inputs = {{0.2, 1}, {1.5, 0}}});
  add({.name = "valves_closed_falling",
       .what = "all inputs to 0 at once in full motion, closing strokes",
       .obstacle = no_inputs,
       .inputs = {{0.2, -1}, {1.5, 0}}});
  add({.name = "zero_gravity",
       .what = "no gravity, full input and back to 0",
       .obstacle = scene.has_mechanics() ? "" : "no mechanism",
       .overrides = {"mechanics.gravity=[0, 0, 0]"},
       .inputs = {{0.5, 1}, {1.5, 0}}});
  add({.name = "start_in_penetration",
       .what = "a shape of a body that moves starts inside its partner",
       .obstacle = has_ground_pair(scene) ? "" : "no pair of a shape of Ground and one of a body",
       .penetrates = true});
}

void add_hydraulics(const scene::Scene& scene, const Parts& parts, Cases& cases) {
  const std::string no_circuit = parts.without_hydraulics(), no_inputs = parts.without_inputs();
  const std::vector<InputPoint> there_and_back = {{0.2, 1}, {1, -1}, {2, 0}};
  const auto add = [&](std::string name, std::string what, std::string obstacle, scene::Overrides overrides,
                       std::vector<InputPoint> inputs, Aim aim = Aim::none) {
    if (!no_circuit.empty()) obstacle = no_circuit;
    cases.push_back({.name = std::move(name),
                     .group = CaseGroup::hydraulics,
                     .what = std::move(what),
                     .obstacle = std::move(obstacle),
                     .overrides = std::move(overrides),
                     .inputs = std::move(inputs),
                     .aim = aim});
  };
  scene::Overrides small = hoses_of(scene, kSmallVolume);
  for (const hydraulics::VolumeDef& volume : scene.hydraulics.volumes) {
    if (!volume.fixed && volume.rigid_volume > 0) small.push_back(set(volume.name + ".rigid_volume", kSmallVolume));
  }
  add("volume_1e-6_m3", "every hose and rigid block holds 1 cm3; inputs full, reversed, 0",
      small.empty() ? "no hose and no rigid volume" : "", small, there_and_back);
  add("bulk_70e6_Pa", "bulk modulus of the oil 70e6 Pa; inputs full, reversed, 0", "",
      {kOilWithModulus, set("hydraulics.oil_bulk_modulus", kSoftOil)}, there_and_back);
  add("bulk_2e9_Pa", "bulk modulus of the oil 2e9 Pa without air; inputs full, reversed, 0", "",
      {kOilWithModulus, set("hydraulics.oil_bulk_modulus", kHardOil), "hydraulics.entrained_air=0"}, there_and_back);
  std::vector<InputPoint> reversing;
  for (int i = 0; i < 12; ++i) reversing.push_back({0.2 + 0.2 * i, i % 2 == 0 ? 1.0 : -1.0});
  add("orifice_through_zero", "orifices turbulent down to 1 Pa, inputs reversed every 0.2 s", no_inputs,
      {"hydraulics.orifice_transition=1"}, reversing);
  const scene::Overrides fast = parts.of_driven("step_response", 1e-3);
  add("valve_closes_in_1_ms", "valves of 1 ms close at full flow", fast.empty() ? "no valve with a step response" : "",
      fast, {{0.2, 1}, {1.5, 0}, {2, -1}, {2.5, 0}});
  scene::Overrides dry = parts.all("anti_cavitation_flow", 1e-9);
  append(dry, {"hydraulics.start=table13", kOilWithModulus, "hydraulics.entrained_air=0.0005"});
  add("cavitation_and_back",
      "from 1 bar with 0.05 % of air, without anti-cavitation valves: the load draws the rod sides empty, then full "
      "input",
      parts.without_ports(), dry, {{1, 1}, {2.5, 0}}, Aim::cavitation);
  scene::Overrides closed = parts.all("standby_pressure", 400e5);
  for (const auto& component : scene.hydraulics.components) {
    // the margin above a load-sensing pressure is read where there is one
    const bool has_margin = hydraulics::find_field(*component, "set_pressure") != nullptr &&
                            !hydraulics::member_of<std::string>(*component, "ls_port").empty();
    if (has_margin) closed.push_back(set(component->name + ".set_pressure", 400e5));
  }
  for (const auto& component : scene.hydraulics.components) {
    if (component->type_name() == "bleed") closed.push_back(set(component->name + ".nominal_flow", 1e-9));
  }
  const std::string no_pump = parts.without("set_pressure");
  add("pump_on_closed_port", "a pump set to 400 bar, bleeds shut, all valves closed: the relief valve takes its flow",
      no_pump, closed, {}, Aim::relief);
  scene::Overrides chatter = closed;
  for (const auto& component : scene.hydraulics.components) {
    if (component->type_name() != "relief_valve") continue;
    chatter.push_back(set(component->name + ".step_response", 1e-3));
    chatter.push_back(set(component->name + ".opening_pressure_rise", 1e4));
  }
  append(chatter, hoses_of(scene, kSmallVolume));
  add("relief_chatter", "the same with a relief valve of 1 ms and 0.1 bar on hoses of 1 cm3, inputs reversed", no_pump,
      chatter, there_and_back, Aim::relief);
}

void add_coupling(const Parts& parts, Cases& cases) {
  const std::string no_ports = parts.without_ports(), no_inputs = parts.without_inputs();
  const std::vector<InputPoint> lift = {{0.2, 1}, {1.2, 0}};
  const auto add = [&](ExtremeCase one) {
    one.group = CaseGroup::coupling;
    one.obstacle = no_ports.empty() ? no_inputs : no_ports;
    if (one.inputs.empty() && !one.alternates) one.inputs = lift;
    cases.push_back(std::move(one));
  };
  for (const double stiffness : {0.01, 0.1, 1.0, 10.0, 100.0}) {
    add({.name = fmt::format("stiffness_{:g}", stiffness),
         .what = fmt::format("K H^2 W of {:g}, by the step, then by stiffer oil", stiffness),
         .stiffness = stiffness});
  }
  // the bound of the error comes with the machine's omega_H
  const auto late = [&](StepIndex delay, StepIndex lost) {
    ExtremeCase one{.name = delay > 0 ? fmt::format("delay_{}", delay) : fmt::format("lost_{}", lost),
                    .what = delay > 0 ? fmt::format("every sample comes {} steps late", delay)
                                      : fmt::format("{} samples in a row are lost of every {}", lost, kLossPeriod),
                    .overrides = {"session.mode=free_running"},
                    .delay = delay,
                    .lost = lost,
                    .compared_with = ComparedWith::on_time};
    add(std::move(one));
  };
  for (const StepIndex delay : {1, 2, 5, 10}) late(delay, 0);
  for (const StepIndex lost : {1, 10, 20, 50}) late(0, lost);
  ExtremeCase hold{.name = "hold_10_s",
                   .what = "no step for 10 s of wall time in mid-motion; nothing may change",
                   .hold_at = 0.7,
                   .compared_with = ComparedWith::same,
                   .seeks_edge = false};
  hold.bounds.requires_same = true;
  add(std::move(hold));
  add({.name = "full_range_every_step",
       .what = "all inputs from one end to the other at every step",
       .alternates = true});
}

// Why a run at a late time is not the same as at time 0; empty: it is.
std::string obstacle_of_late_times(const multibody::MechanicsDef& mechanics) {
  if (!mechanics.motions.empty()) return "its motions are laws of the session's time";
  const auto& forces = mechanics.point_forces;
  const auto& torques = mechanics.point_torques;
  const bool has_table =
      std::any_of(forces.begin(), forces.end(), [](const auto& load) { return !load.force_table.empty(); }) ||
      std::any_of(torques.begin(), torques.end(), [](const auto& load) { return !load.torque_table.empty(); });
  return has_table ? "its forces over time are laws of the session's time" : "";
}

void add_numbers(const scene::Scene& scene, const Parts& parts, Cases& cases) {
  const std::int64_t H = scene.session.step_duration().ns;
  // whole exchanges of all sides
  const std::int64_t unit = H * scene.session.exchange_every * static_cast<std::int64_t>(scene.flexible_every());
  const std::vector<InputPoint> inputs =
      parts.without_inputs().empty() ? std::vector<InputPoint>{{0.2, 1}, {1.2, 0}} : std::vector<InputPoint>{};
  const std::string obstacle = obstacle_of_late_times(scene.mechanics);
  const auto late = [&](const char* name, const char* what, std::int64_t begin_ns) {
    ExtremeCase one{.name = name,
                    .group = CaseGroup::numbers,
                    .what = what,
                    .obstacle = obstacle,
                    .duration = 2,
                    .inputs = inputs,
                    .begin_ns = begin_ns / unit * unit,
                    .compared_with = ComparedWith::same,
                    .seeks_edge = false};
    one.bounds.requires_same = true;
    cases.push_back(std::move(one));
  };
  late("step_2^32", "the steps around number 2^32; all values as from step 0", kLateStep * H - 1'000'000'000);
  late("time_2^62_ns", "the last steps before 2^62 ns; all values as from step 0", kLateTime - 2 * 1'000'000'000);
  const auto step = [&](const char* name, const char* what, double H_s, double duration) {
    cases.push_back({.name = name,
                     .group = CaseGroup::numbers,
                     .what = what,
                     .duration = duration,
                     .overrides = {set("session.step", H_s)},
                     .inputs = inputs,
                     .seeks_edge = false});
  };
  step("step_10_us", "a communication step of 10 us", scene::kMinStep, 0.5);
  step("step_20_ms", "a communication step of 20 ms", scene::kMaxStep, 3);
}

}  // namespace

std::vector<ExtremeCase> extreme_cases(const scene::Scene& scene) {
  const Parts parts(scene);
  Cases cases;
  add_machine(scene, parts, cases);
  add_hydraulics(scene, parts, cases);
  add_coupling(parts, cases);
  add_numbers(scene, parts, cases);
  return cases;
}

std::string lack_of_effect(const ExtremeCase& one, const scene::SceneOptions& options, const scene::Scene& scene) {
  const bool delays = one.delay > 0 || one.lost > 0;
  if (one.overrides.empty() || delays) return "";
  scene::SceneOptions changed = options;
  changed.overrides.insert(changed.overrides.end(), one.overrides.begin(), one.overrides.end());
  try {
    if (scene::load_scene(changed).expanded_text != scene.expanded_text) return "";
  } catch (const scene::LoadError&) {
    return "";  // the case's own run reports it
  }
  return "it changes nothing: the scene has these settings";
}

std::string_view to_text(CaseGroup group) noexcept {
  switch (group) {
    case CaseGroup::machine:
      return "machine";
    case CaseGroup::hydraulics:
      return "hydraulics";
    case CaseGroup::coupling:
      return "coupling";
    case CaseGroup::numbers:
      return "numbers";
  }
  return "";
}

const multibody::ShapeDef* ground_shape(const scene::Scene& scene, const multibody::ContactPairDef& pair) {
  const multibody::ShapeDef* on_ground = nullptr;
  int found = 0;
  for (const multibody::ShapeDef& shape : scene.mechanics.shapes) {
    if (shape.name != pair.shape_a && shape.name != pair.shape_b) continue;
    if (shape.body != "Ground") continue;
    on_ground = &shape;
    ++found;
  }
  return found == 1 ? on_ground : nullptr;
}

double raw_at(std::span<const InputPoint> points, double t) noexcept {
  double raw = 0;
  for (const InputPoint& point : points) {
    if (point.at <= t) raw = point.raw;
  }
  return raw;
}

scene::Overrides hoses_of(const scene::Scene& scene, double content) {
  scene::Overrides overrides;
  for (const auto& component : scene.hydraulics.components) {
    const auto* hose = dynamic_cast<const hydraulics::HoseDef*>(component.get());
    if (hose == nullptr) continue;
    const double area = 0.25 * std::numbers::pi * hose->diameter * hose->diameter;
    overrides.push_back(set(hose->name + ".length", content / area));
  }
  return overrides;
}

scene::Overrides stiffer_by(const scene::Scene& scene, double factor) {
  scene::Overrides overrides = {kOilWithModulus,
                                set("hydraulics.oil_bulk_modulus", factor * scene.hydraulics.oil_bulk_modulus),
                                "hydraulics.entrained_air=0"};
  for (const scene::ParameterInfo& one : scene::parameters(scene)) {
    const bool is_wall = one.path.ends_with(".bulk_modulus") || one.path.ends_with(".maximum_bulk_modulus");
    if (is_wall) overrides.push_back(set(one.path, factor * one.value));
  }
  return overrides;
}

}  // namespace slew::analysis
