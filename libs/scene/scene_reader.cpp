// SPDX-License-Identifier: Apache-2.0
#include "scene/scene_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "core/printable.h"
#include "core/suggestion.h"
#include "multibody/build/validate.h"
#include "multibody/formulations/element_speeds.h"
#include "multibody/model/model.h"
#include "scene/assets.h"
#include "scene/canonical.h"
#include "scene/element_reader.h"
#include "scene/element_table.h"
#include "scene/field_reader.h"
#include "scene/flexible_bodies.h"
#include "scene/graphics.h"
#include "scene/instruments.h"
#include "scene/mesh_assets.h"
#include "scene/names.h"
#include "scene/parameters.h"
#include "scene/place_map.h"
#include "scene/ports.h"
#include "scene/recorded_files.h"
#include "scene/script.h"
#include "scene/script_reader.h"
#include "scene/sections.h"
#include "scene/sensors.h"
#include "scene/start_reader.h"
#include "scene/table_file.h"
#include "scene/units.h"
#include "scene/unsettled_start.h"
#include "scene/without_effect.h"

namespace slew::scene {
namespace {

constexpr std::string_view kMechanicsSections[] = {"mechanics", "bodies",   "joints",    "forces",  "dummies",
                                                   "shapes",    "contacts", "frictions", "motions", "gears"};
constexpr std::string_view kHydraulicsSections[] = {"hydraulics", "volumes", "components", "curves"};

// Reads the expanded tree into a Scene: elements by their tables, then the rules between them, domain by domain. The
// physics libraries check a domain only if all its values were read, so that there are no follow-up errors.
class SceneReader {
 public:
  SceneReader(const Node& root, LoadContext load_context, Report& report)
      : root_(root), load_context_(std::move(load_context)), report_(report) {}

  Scene read(const std::string& default_name) {
    check_top_level();
    read_texts(default_name);
    const std::size_t problems = report_.size();
    names_.declare_all(root_, report_);
    has_sound_names_ = report_.size() == problems;
    elements_.read_section("session");
    check_problems([&](Problems& errors, Problems& warnings) { validate(scene_.session, errors, warnings); });
    const bool mechanics_is_sound = read_mechanics();
    const bool hydraulics_is_sound = read_hydraulics();
    if (mechanics_is_sound && hydraulics_is_sound) {
      check_problems([&](Problems& errors, Problems&) {
        make_ports(scene_, errors);
        if (lacks_files()) return;
        if (errors.empty()) multibody::validate_rows(scene_.mechanics, row_names(scene_), errors);
        if (errors.empty()) {
          for (const PortDef& port : scene_.ports) scene_.mechanics.held_forces.push_back(port.force);
        }
        if (errors.empty() && !scene_.ports.empty()) check_start(scene_, errors);
      });
    }
    read_sensors(mechanics_is_sound);
    read_inputs();
    read_recorded();
    read_devices_and_outputs();
    read_graphics();
    if (const Node::Entry* script = root_.find("script")) {
      read_script(script->value, script->mark, load_context_, names_, scene_, context_);
    }
    check_content();
    find_changes_behind_the_end();
    if (report_.is_clean() && !lacks_files()) {
      check_problems([&](Problems& errors, Problems&) { check_changes(scene_, errors); });
      check_problems([&](Problems&, Problems& warnings) {
        find_without_effect(scene_, warnings);
        find_start_shapes(scene_, warnings);
        find_unsettled_start(scene_, warnings);
      });
    }
    if (report_.is_clean()) add_assets_of_tables();
    if (report_.is_clean()) {
      check_problems([&](Problems& errors, Problems&) { scene_.expanded_text = canonical_text(scene_, errors); });
    }
    return std::move(scene_);
  }

 private:
  // a run that an option cuts short leaves changes out as its user wants
  void find_changes_behind_the_end() {
    const Node::Entry* session = root_.find("session");
    const Node::Entry* duration = session != nullptr ? session->value.find("duration") : nullptr;
    const double end = scene_.session.duration;
    if (duration == nullptr || !(end > 0) || report_.is_override(duration->mark)) return;
    for (std::size_t i = 0; i < scene_.script.changes.size(); ++i) {
      const ScriptChange& change = scene_.script.changes[i];
      if (first_step_at(change.at, scene_.session.step_duration()) < scene_.session.steps()) continue;
      add_warning(
          {fmt::format("script.parameters[{}]", i),
           fmt::format("the change of {} at {:g} s has no effect: the run ends at {:g} s", change.set, change.at, end),
           "an earlier time, or a longer session.duration", ""});
    }
    check_problems([&](Problems&, Problems& warnings) { find_points_behind_the_end(scene_, end, warnings); });
  }

  void add_problem(const Problem& problem) {
    report_.add(places_.nearest(problem.path, root_.mark), problem.path,
                {problem.what, problem.expected, problem.suggestion});
  }
  void add_warning(const Problem& problem) {
    const Mark mark = places_.nearest(problem.path, root_.mark);
    scene_.warnings.push_back(
        report_.at(mark, problem.path, {problem.what, problem.expected, problem.suggestion}).text());
  }
  template <typename Check>
  void check_problems(const Check& check) {
    Problems errors, warnings;
    check(errors, warnings);
    for (const Problem& problem : errors) add_problem(problem);
    add_warnings(warnings);
  }

  // one line for all elements with the same warning
  void add_warnings(const Problems& warnings) {
    for (auto first = warnings.begin(); first != warnings.end(); ++first) {
      const auto reads_the_same = [first](const Problem& other) {
        return other.what == first->what && other.expected == first->expected;
      };
      if (std::any_of(warnings.begin(), first, reads_the_same)) continue;
      Problem problem = *first;
      std::string others;
      for (auto other = std::next(first); other != warnings.end(); ++other) {
        if (reads_the_same(*other)) others += (others.empty() ? "" : ", ") + other->path;
      }
      if (!others.empty()) problem.what += " (and " + others + ")";
      add_warning(problem);
    }
  }

  void check_top_level() {
    report_duplicates(root_, "", report_);
    const auto& keys = top_level_keys();
    for (const Node::Entry& entry : root_.entries) {
      const bool is_known = entry.key == kStartKey || entry.key == kPayloadKey || entry.key == kWithoutKey;
      if (!is_known && std::find(keys.begin(), keys.end(), entry.key) == keys.end()) {
        std::vector<std::string_view> known = keys;
        known.insert(known.end(), language_keys().begin(), language_keys().end());
        known.push_back(kWithoutKey);
        report_.add(entry.mark, entry.key, {"unknown section", "", closest(entry.key, known)});
      }
      places_.add(entry.key, entry.mark);
    }
    for (const std::string_view key : {kIncludeKey, kWithoutKey}) {
      const Node::Entry* entry = root_.find(key);
      if (entry == nullptr) continue;
      report_.add(entry->mark, std::string(key), {"a scene without a folder cannot include a file", "", ""});
    }
  }

  void read_texts(const std::string& default_name) {
    scene_.name = default_name;
    for (const auto& [key, text] : {std::pair("scene", &scene_.name), std::pair("description", &scene_.description)}) {
      const Node::Entry* entry = root_.find(key);
      if (entry == nullptr) continue;
      if (entry->value.kind != Node::Kind::scalar || entry->value.text.empty()) {
        report_.add(entry->value.mark, key, {"is " + describe(entry->value), "a text", ""});
      } else {
        *text = entry->value.text;
      }
    }
    if (scene_.name.size() > kMaxSceneNameLength) {
      const Node::Entry* entry = root_.find("scene");
      report_.add(entry == nullptr ? root_.mark : entry->value.mark, "scene",
                  {fmt::format("the scene's name has {} characters", scene_.name.size()),
                   fmt::format("at most {}", kMaxSceneNameLength), ""});
    }
    // a path or an option, where the name is part of one
    const Node::Entry* name = root_.find("scene");
    if (name != nullptr &&
        (scene_.name.find_first_of("/\\") != std::string::npos || scene_.name.find_first_of(".-") == 0)) {
      report_.add(name->value.mark, "scene",
                  {"'" + scene_.name + "' looks like a path or an option",
                   "a name that does not begin with '.' or '-', without '/' and '\\'", ""});
    }
    if (const Node::Entry* assets = root_.find("assets")) read_assets(assets->value, load_context_, scene_, report_);
  }

  void resolve_references() {
    names_.resolve(references_, report_);
    references_.clear();
  }

  bool read_mechanics() {
    const std::size_t problems = report_.size();
    for (const std::string_view section : kMechanicsSections) elements_.read_section(section);
    if (const Node::Entry* payload = root_.find(kPayloadKey)) read_payload(payload->value, scene_, context_);
    resolve_references();
    if (report_.size() > problems || !has_sound_names_) return false;
    check_problems([&](Problems& errors, Problems& warnings) {
      read_meshes(load_context_, scene_.mechanics, errors);
      read_flexible_bodies(load_context_, scene_, errors, warnings);
      if (lacks_files()) return;
      const Node::Entry* start = root_.find(kStartKey);
      if (start != nullptr && errors.empty()) read_start(start->value, scene_, context_, errors);
      if (report_.size() > problems) return;
      if (errors.empty()) multibody::validate(scene_.mechanics, errors);
      if (errors.empty() && !scene_.other_payloads.empty()) check_payloads(scene_, errors);
      if (errors.empty()) check_motion_ends(errors);
      if (errors.empty() && scene_.session.solution == Solution::split) {
        multibody::check_element_speeds(scene_.mechanics, mechanics_substep(scene_.session, scene_.mechanics), errors);
        multibody::check_contact_rates(scene_.mechanics, mechanics_substep(scene_.session, scene_.mechanics), errors);
      }
      if (errors.empty()) {
        multibody::find_unlikely_inertia(scene_.mechanics, warnings);
        multibody::find_axes_beside_hinges(scene_.mechanics, warnings);
        multibody::find_points_between_nodes(scene_.mechanics, warnings);
        multibody::find_start_changes(scene_.mechanics, warnings);
        multibody::find_unlikely_contacts(scene_.mechanics, warnings);
        multibody::find_overshoots(scene_.mechanics, warnings);
        if (scene_.session.solution == Solution::split) {
          const double substep = mechanics_substep(scene_.session, scene_.mechanics);
          multibody::find_lost_rebounds(scene_.mechanics, substep, warnings);
          multibody::find_short_pulses(scene_.mechanics, substep, warnings);
          multibody::find_fast_motions(scene_.mechanics, substep, warnings);
        }
      }
    });
    if (scene_.session.contact == ContactUse::off) scene_.mechanics.contacts.clear();
    return report_.size() == problems;
  }

  void read_sensors(bool mechanics_is_sound) {
    const std::size_t problems = report_.size();
    elements_.read_section("sensors");
    resolve_references();
    if (report_.size() > problems) return;
    for (measurement::InstrumentDef& def : scene_.instruments) {
      if (def.variable.empty()) continue;
      const std::string path = def.name + ".variable";
      check_variables(path, {def.variable});
      def.place = place_of(path);
    }
    if (report_.size() > problems) return;
    check_problems([&](Problems& errors, Problems&) { check_instruments(scene_, errors); });
    if (!mechanics_is_sound) return;
    check_problems([&](Problems& errors, Problems&) { check_sensors(scene_, errors); });
  }

  // some table or body is empty: rules between elements cannot be checked
  [[nodiscard]] bool lacks_files() const { return scene_.needs_files() && !load_context_.has_assets; }

  void add_assets_of_tables() {
    add_table_assets(scene_);
    if (scene_.assets.size() <= kMaxAssets) return;
    const std::string what = fmt::format("the scene has {} files", scene_.assets.size());
    report_.add(root_.mark, "", {what, fmt::format("at most {}", kMaxAssets), ""});
  }

  // a table with ends: refuse must cover the session's duration, if it is limited
  void check_motion_ends(Problems& errors) const {
    const double duration = scene_.session.duration;
    for (const multibody::MotionDef& motion : scene_.mechanics.motions) {
      if (motion.ends != multibody::TableEnds::refused || motion.points.empty()) continue;
      if (motion.points.back()[0] >= duration) continue;
      errors.push_back({motion.name + ".points",
                        fmt::format("the table ends at {} s and has no values beyond, the session lasts {} s",
                                    motion.points.back()[0], duration),
                        fmt::format("a last time of at least {} s, or other ends", duration), ""});
    }
  }

  bool read_hydraulics() {
    const std::size_t problems = report_.size();
    for (const std::string_view section : kHydraulicsSections) elements_.read_section(section);
    resolve_references();
    if (report_.size() > problems || !has_sound_names_) return false;
    if (!scene_.table_files.empty() && !load_context_.has_assets) return true;
    // a scene without volumes has no circuit to check
    if (scene_.has_hydraulics() || !scene_.hydraulics.components.empty()) {
      check_problems(
          [&](Problems& errors, Problems& warnings) { hydraulics::validate(scene_.hydraulics, errors, warnings); });
    }
    return report_.size() == problems;
  }

  void read_inputs() {
    const std::size_t problems = report_.size();
    elements_.read_section("inputs");
    resolve_references();
    if (report_.size() > problems) return;
    check_problems([&](Problems& errors, Problems&) {
      validate(scene_.inputs, errors);
      for (const InputDef& input : scene_.inputs) {
        check_primitive(input, errors);
        check_controller(input, errors);
      }
    });
  }

  void check_controller(const InputDef& input, Problems& errors) const {
    if (input.controller == ControllerMode::sampled || scene_.session.mode == ExchangeMode::lockstep) return;
    errors.push_back({input.name + ".controller",
                      "a controller cannot be in step with a free-running session, whose nodes do not wait for ticks",
                      "sampled, or session.mode: lockstep", ""});
  }

  void check_primitive(const InputDef& input, Problems& errors) const {
    std::vector<std::string_view> controlled;
    for (const auto& component : scene_.hydraulics.components) {
      if (component->takes_signal()) controlled.push_back(component->name);
    }
    for (const multibody::PointForceDef& load : scene_.mechanics.point_forces) controlled.push_back(load.name);
    for (const multibody::PointTorqueDef& load : scene_.mechanics.point_torques) controlled.push_back(load.name);
    if (std::find(controlled.begin(), controlled.end(), input.primitive) != controlled.end()) return;
    errors.push_back({input.name + ".primitive", "'" + input.primitive + "' takes no control signal",
                      "a component with a control signal, such as a valve, or a point_force or point_torque",
                      closest(input.primitive, controlled)});
  }

  void read_recorded() {
    elements_.read_section("recording");
    elements_.read_section("plots");
    check_variables("recording.variables", scene_.recording.variables);
    scene_.recording.place = place_of("recording.variables");
    for (PlotDef& plot : scene_.plots) {
      check_variables(plot.name + ".variables", plot.variables);
      plot.place = place_of(plot.name + ".variables");
    }
  }

  // "scene.yaml:7:3" of a value that only the built models can check; empty in a scene without a file
  [[nodiscard]] std::string place_of(const std::string& path) const {
    if (!load_context_.has_folder) return {};
    const Diagnostic place = report_.at(places_.nearest(path, root_.mark), path, {});
    if (place.line == 0) return printable(place.file);
    return fmt::format("{}:{}:{}", printable(place.file), place.line, place.column);
  }

  void read_devices_and_outputs() {
    const std::size_t problems = report_.size();
    elements_.read_section("outputs");
    elements_.read_section("devices");
    resolve_references();
    if (report_.size() > problems) return;
    check_problems([&](Problems& errors, Problems&) {
      for (CanInDef& device : scene_.devices.can_ins) read_database_of(device, errors);
      for (CanOutDef& device : scene_.devices.can_outs) read_database_of(device, errors);
      if (load_context_.device_folder) check_recorded_files(scene_.devices, *load_context_.device_folder, errors);
      if (!errors.empty()) return;
      read_outputs(scene_.outputs, errors);
      read_devices(scene_.devices, scene_.inputs, errors);
      const double interval = scene_.session.step * static_cast<double>(scene_.recording.every);
      for (const MotionPlatformDef& device : scene_.devices.platforms)
        check_platform(device, scene_.mechanics.gravity, interval, errors);
    });
    if (report_.size() > problems) return;
    for (const NamedVariable& named : variables_of(scene_.devices, scene_.outputs))
      check_variables(named.path, {named.variable});
  }

  void read_graphics() {
    const std::size_t problems = report_.size();
    elements_.read_section("graphics");
    resolve_references();
    if (report_.size() > problems) return;
    check_problems([&](Problems& errors, Problems&) { check_graphics(load_context_, scene_, errors); });
  }

  template <typename Device>
  void read_database_of(Device& device, Problems& errors) const {
    const std::string& file = device.bus.database;
    if (!load_context_.device_folder || file.empty()) return;
    const LoadContext folder{true, *load_context_.device_folder};
    if (const auto refusal = folder.refusal_of(file)) {
      errors.push_back({device.name + ".database", refusal->what, refusal->expected, refusal->suggestion});
      return;
    }
    read_database(device.name, device.bus, folder.path_of(file), errors);
  }

  // The part before the first dot names an element or a section; only its node has the element's quantities.
  void check_variables(const std::string& path, const std::vector<std::string>& variables) {
    std::vector<std::string_view> owners = names_.names_of("");
    for (const SingleTable& table : single_tables()) owners.push_back(table.section);
    for (const std::string& variable : variables) {
      const std::size_t dot = variable.find('.');
      const std::string_view element = std::string_view(variable).substr(0, dot);
      if (dot == std::string::npos && element.find('*') == std::string_view::npos) {
        add_problem({path, "'" + variable + "' is not the name of a variable",
                     "Element.quantity or a pattern such as 'Cyl_*.force'", ""});
      } else if (std::none_of(owners.begin(), owners.end(),
                              [&](std::string_view name) { return fits_pattern(name, element); })) {
        add_problem({path, "no element '" + std::string(element) + "'", "", closest(element, owners)});
      }
    }
  }

  void check_content() {
    if (!report_.is_clean() || root_.find("bodies") != nullptr || root_.find("volumes") != nullptr) return;
    report_.add(root_.mark, "", {"the scene holds nothing to simulate", "a section 'bodies' or 'volumes'", ""});
  }

  const Node& root_;
  LoadContext load_context_;
  Report& report_;
  Scene scene_;
  NameTable names_;
  bool has_sound_names_ = true;
  PlaceMap places_;
  std::vector<Reference> references_;
  UnitSystem units_;
  // the text of a session or a recording contains every key (canonical_text())
  ReadContext context_{units_,
                       report_,
                       places_,
                       references_,
                       &load_context_,
                       &scene_.table_files,
                       load_context_.has_folder ? &scene_.warnings : nullptr};
  ElementReader elements_{root_, load_context_, scene_, context_};
};

}  // namespace

Scene read_scene(const Node& root, LoadContext load_context, Report& report, const std::string& default_name) {
  return SceneReader(root, std::move(load_context), report).read(default_name);
}

}  // namespace slew::scene
