// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "core/suggestion.h"
#include "multibody/build/validate.h"
#include "multibody/forces/element_speeds.h"
#include "multibody/model/model.h"
#include "scene/assets.h"
#include "scene/canonical.h"
#include "scene/edited_scene.h"
#include "scene/element_table.h"
#include "scene/expand.h"
#include "scene/field_reader.h"
#include "scene/flexible_bodies.h"
#include "scene/graphics.h"
#include "scene/instruments.h"
#include "scene/mesh_assets.h"
#include "scene/mesh_inertia.h"
#include "scene/names.h"
#include "scene/parameters.h"
#include "scene/place_map.h"
#include "scene/ports.h"
#include "scene/scene.h"
#include "scene/script_reader.h"
#include "scene/sections.h"
#include "scene/sensors.h"
#include "scene/source.h"
#include "scene/start_reader.h"
#include "scene/table_file.h"
#include "scene/units.h"
#include "scene/without_effect.h"
#include "scene/yaml_tree.h"

namespace slew::scene {
namespace {

constexpr std::string_view kMechanicsSections[] = {"mechanics", "bodies",   "joints",    "forces",  "dummies",
                                                   "shapes",    "contacts", "frictions", "motions", "gears"};
constexpr std::string_view kHydraulicsSections[] = {"hydraulics", "volumes", "components", "curves"};
constexpr std::string_view kTypeKey[] = {"type"};
constexpr std::size_t kMaxListRows = 1024;

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
    read_section("session");
    check_problems([&](Problems& errors, Problems& warnings) { validate(scene_.session, errors, warnings); });
    const bool mechanics_is_sound = read_mechanics();
    const bool hydraulics_is_sound = read_hydraulics();
    if (mechanics_is_sound && hydraulics_is_sound) {
      check_problems([&](Problems& errors, Problems&) {
        make_ports(scene_, errors);
        if (lacks_files()) return;
        if (errors.empty()) multibody::validate_rows(scene_.mechanics, row_names(scene_), errors);
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
      check_problems([&](Problems&, Problems& warnings) { find_without_effect(scene_, warnings); });
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
      if (change.at < end) continue;
      add_warning(
          {fmt::format("script.parameters[{}]", i),
           fmt::format("the change of {} at {:g} s has no effect: the run ends at {:g} s", change.set, change.at, end),
           "an earlier time, or a longer session.duration", ""});
    }
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
      const auto says_the_same = [first](const Problem& other) {
        return other.what == first->what && other.expected == first->expected;
      };
      if (std::any_of(warnings.begin(), first, says_the_same)) continue;
      Problem problem = *first;
      std::string others;
      for (auto other = std::next(first); other != warnings.end(); ++other) {
        if (says_the_same(*other)) others += (others.empty() ? "" : ", ") + other->path;
      }
      if (!others.empty()) problem.what += " (and " + others + ")";
      add_warning(problem);
    }
  }

  void check_top_level() {
    report_duplicates(root_, "", report_);
    const auto& keys = top_level_keys();
    for (const Node::Entry& entry : root_.entries) {
      const bool is_known = entry.key == kStartKey || entry.key == kPayloadKey;
      if (!is_known && std::find(keys.begin(), keys.end(), entry.key) == keys.end()) {
        std::vector<std::string_view> known = keys;
        known.insert(known.end(), language_keys().begin(), language_keys().end());
        report_.add(entry.mark, entry.key, {"unknown section", "", closest(entry.key, known)});
      }
      places_.add(entry.key, entry.mark);
    }
    if (const Node::Entry* include = root_.find("include")) {
      report_.add(include->mark, "include", {"a scene without a folder cannot include a file", "", ""});
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

  bool is_map(const Node::Entry& section) {
    if (section.value.kind == Node::Kind::map) return true;
    report_.add(section.value.mark, section.key, {"is " + describe(section.value), "a map", ""});
    return false;
  }

  // A section that is one map of fields, or one of elements.
  void read_section(std::string_view name) {
    const Node::Entry* section = root_.find(name);
    if (section == nullptr || !is_map(*section)) return;
    for (const SingleTable& table : single_tables()) {
      if (table.section != name) continue;
      read_fields(section->value, table.fields, table.def(scene_), section->key, section->mark, {}, context_);
      return;
    }
    report_duplicates(section->value, "", report_);
    for (const Node::Entry& element : section->value.entries) read_element(name, element);
  }

  void read_element(std::string_view section, const Node::Entry& element) {
    places_.add(element.key, element.mark);
    if (element.value.kind != Node::Kind::map) {
      report_.add(element.value.mark, element.key, {"is " + describe(element.value), "a map", ""});
      return;
    }
    const ElementTable* table = table_of(section, element);
    if (table == nullptr) return;
    void* def = table->append(scene_, element.key);
    if (section == "bodies" && takes_from_mesh(element.value)) {
      read_mesh_body(element, table->fields, load_context_, *static_cast<multibody::BodyDef*>(def), scene_, context_);
      return;
    }
    if (section == "bodies" && !table->is_default) return read_flexible_body(element, *table, def);
    std::vector<std::string_view> other_keys;
    if (!table->type.empty()) other_keys.push_back(kTypeKey[0]);
    for (const ListTable& list : table->lists) other_keys.push_back(list.key);
    read_fields(element.value, table->fields, def, element.key, element.mark, other_keys, context_);
    for (const ListTable& list : table->lists) read_list(element, list, def);
  }

  void read_list(const Node::Entry& element, const ListTable& list, void* def) {
    const Node::Entry* entry = element.value.find(list.key);
    if (entry == nullptr) return;
    const std::string path = fmt::format("{}.{}", element.key, list.key);
    places_.add(path, entry->value.mark);
    if (entry->value.kind != Node::Kind::sequence) {
      report_.add(entry->value.mark, path, {"is " + describe(entry->value), "a list of maps", ""});
      return;
    }
    if (entry->value.items.size() > kMaxListRows) {
      report_.add(
          entry->value.mark, path,
          {fmt::format("has {} entries", entry->value.items.size()), fmt::format("at most {}", kMaxListRows), ""});
      return;
    }
    for (std::size_t i = 0; i < entry->value.items.size(); ++i) {
      const Node& item = entry->value.items[i];
      const std::string row_path = fmt::format("{}[{}]", path, i);
      if (item.kind != Node::Kind::map) {
        report_.add(item.mark, row_path, {"is " + describe(item), "a map", ""});
        continue;
      }
      // problems that are found later name a row by its first field
      const Node::Entry* name = item.find(list.fields.front().key);
      const bool is_named = name != nullptr && name->value.kind == Node::Kind::scalar;
      if (is_named) {
        places_.add(fmt::format("{}.{}", path, name->value.text), item.mark);
        places_.add(fmt::format("{}.{}", element.key, name->value.text), item.mark);
      }
      read_fields(item, list.fields, list.append(def), row_path, item.mark, {}, context_);
    }
  }

  // The keys of a rigid body may stay, so that one line makes it flexible and back. They are read, and differences from
  // the files give a warning (flexible_bodies.h); those of a mesh are skipped.
  void read_flexible_body(const Node::Entry& element, const ElementTable& table, void* def) {
    std::vector<Field> fields(table.fields.begin(), table.fields.end());
    std::vector<std::string_view> other_keys = {"type"};
    const bool has_mesh = takes_from_mesh(element.value);
    for (const ElementTable& rigid : element_tables()) {
      if (rigid.section != "bodies" || !rigid.is_default) continue;
      for (Field field : rigid.fields) {
        if (std::any_of(fields.begin(), fields.end(), [&](const Field& own) { return own.key == field.key; })) continue;
        field.presence = Presence::optional;
        if (has_mesh) {
          other_keys.push_back(field.key);
        } else {
          fields.push_back(field);
        }
      }
    }
    refuse_keys_of_other_type(element, table, other_keys);
    if (has_mesh) {
      for (const Field& field : mesh_inertia_fields()) other_keys.push_back(field.key);
    }
    read_fields(element.value, fields, def, element.key, element.mark, other_keys, context_);
  }

  // refuses keys of modes in a body of segments, and vice versa
  void refuse_keys_of_other_type(const Node::Entry& element, const ElementTable& table,
                                 std::vector<std::string_view>& passed_over) {
    const bool is_segmented = table.type == "segmented";
    const ValueProblem problem =
        is_segmented ? ValueProblem{"a segmented body has no modes: it bends by the beams between its segments",
                                    "no such key, or type flexible", ""}
                     : ValueProblem{"a flexible body has no segments: it bends by the modes of its files",
                                    "no such key, or type segmented", ""};
    for (const std::string_view key :
         {"flex_modes", "flex_frequency_limit", "modal_coordinates", "modal_rates", "segments"}) {
      const Node::Entry* found = element.value.find(key);
      if (found == nullptr || is_segmented == (key == "segments")) continue;
      passed_over.push_back(key);
      report_.add(found->mark, element.key + "." + std::string(key), problem);
    }
  }

  // The table of the element's type; null after a reported problem.
  const ElementTable* table_of(std::string_view section, const Node::Entry& element) {
    if (const ElementTable* table = find_element_table(section, element.value)) return table;
    std::vector<std::string_view> types;
    const Node::Entry* type = element.value.find("type");
    for (const ElementTable& table : element_tables()) {
      if (table.section == section) types.push_back(table.type);
    }
    std::string list;
    for (const std::string_view name : types)
      list += (list.empty() ? "" : name == types.back() ? " or " : ", ") + std::string(name);
    if (type == nullptr) {
      report_.add(element.mark, element.key, {"the key 'type' is missing", list, ""});
    } else {
      const bool is_word = type->value.kind == Node::Kind::scalar;
      report_.add(type->value.mark, element.key + ".type",
                  {"is " + describe(type->value), list, is_word ? closest(type->value.text, types) : ""});
    }
    return nullptr;
  }

  void resolve_references() {
    names_.resolve(references_, report_);
    references_.clear();
  }

  bool read_mechanics() {
    const std::size_t problems = report_.size();
    for (const std::string_view section : kMechanicsSections) read_section(section);
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
        multibody::find_start_changes(scene_.mechanics, warnings);
        multibody::find_unlikely_contacts(scene_.mechanics, warnings);
        if (scene_.session.solution == Solution::split) {
          multibody::find_lost_rebounds(scene_.mechanics, mechanics_substep(scene_.session, scene_.mechanics),
                                        warnings);
        }
      }
    });
    if (scene_.session.contact == ContactUse::off) scene_.mechanics.contacts.clear();
    return report_.size() == problems;
  }

  void read_sensors(bool mechanics_is_sound) {
    const std::size_t problems = report_.size();
    read_section("sensors");
    resolve_references();
    if (report_.size() > problems) return;
    for (const measurement::InstrumentDef& def : scene_.instruments) {
      if (!def.variable.empty()) check_variables(def.name + ".variable", {def.variable});
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
    for (const std::string_view section : kHydraulicsSections) read_section(section);
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
    read_section("inputs");
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
    read_section("recording");
    read_section("plots");
    check_variables("recording.variables", scene_.recording.variables);
    for (const PlotDef& plot : scene_.plots) check_variables(plot.name + ".variables", plot.variables);
  }

  void read_devices_and_outputs() {
    const std::size_t problems = report_.size();
    read_section("outputs");
    read_section("devices");
    resolve_references();
    if (report_.size() > problems) return;
    check_problems([&](Problems& errors, Problems&) {
      for (CanInDef& device : scene_.devices.can_ins) read_database_of(device, errors);
      for (CanOutDef& device : scene_.devices.can_outs) read_database_of(device, errors);
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
    read_section("graphics");
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
};

Scene read_tree(Node root, LoadContext load_context, const std::string& name, const Overrides& overrides,
                Report& report) {
  std::vector<std::string> warnings;
  // the text of a session or a recording is expanded already
  std::vector<ParameterText> parameter_texts;
  if (!expand(root, overrides, report, load_context.has_folder ? &warnings : nullptr, parameter_texts)) {
    report.fail(kMaxReportedProblems);
  }
  Scene scene = SceneReader(root, std::move(load_context), report).read(name);
  if (!report.is_clean()) report.fail(kMaxReportedProblems);
  scene.parameter_texts = std::move(parameter_texts);
  scene.warnings.insert(scene.warnings.begin(), warnings.begin(), warnings.end());
  return scene;
}

std::string line_of(const std::string& text, std::size_t at) {
  const std::size_t before = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
  const std::size_t begin = before == std::string::npos ? 0 : before + 1;
  return text.substr(begin, text.find('\n', at) - begin);
}

[[noreturn]] void refuse_expansion(const Scene& scene, std::string what) {
  throw LoadError(
      {{.file = scene.name,
        .path = "",
        .what = "the scene as published to the nodes does not read back as the same scene: " + std::move(what),
        .expected = "the same scene; report it as a fault of this program, with the file",
        .suggestion = ""}},
      0);
}

// Every node reads the expanded text, which must therefore give the same scene.
void read_back(const Scene& scene) {
  std::string again;
  try {
    again = load_text(scene.expanded_text, scene.name).expanded_text;
  } catch (const LoadError& error) {
    refuse_expansion(scene, error.what());
  }
  if (again == scene.expanded_text) return;
  const auto differs =
      std::mismatch(again.begin(), again.end(), scene.expanded_text.begin(), scene.expanded_text.end());
  refuse_expansion(scene, fmt::format("'{}' became '{}'",
                                      line_of(scene.expanded_text,
                                              static_cast<std::size_t>(differs.second - scene.expanded_text.begin())),
                                      line_of(again, static_cast<std::size_t>(differs.first - again.begin()))));
}

}  // namespace

namespace {

// text: null: that of the file.
Scene load_from(const std::string& path, const std::string* text, const Overrides& overrides) {
  return guarded(path, [&] {
    Report report;
    std::optional<Node> root = read_with_includes(path, report, Includes::with_prefix, text);
    if (!root) report.fail(kMaxReportedProblems);
    const std::filesystem::path file(path);
    LoadContext load_context{true, file.parent_path().string()};
    load_context.device_folder = load_context.folder;
    Scene scene = read_tree(std::move(*root), std::move(load_context), file.stem().string(), overrides, report);
    read_back(scene);
    return scene;
  });
}

}  // namespace

Scene load_file(const std::string& path, const Overrides& overrides) {
  return load_from(path, nullptr, overrides);
}

Scene load_edited(const std::string& path, const std::string& text, const Overrides& overrides) {
  return load_from(path, &text, overrides);
}

Scene load_text(std::string text, const std::string& name, const Overrides& overrides,
                const std::optional<std::string>& files, ScriptFile script) {
  return guarded(name, [&] {
    Report report;
    const std::optional<SourceText> source = check_source(std::move(text), report.add_source(name), report);
    std::optional<Node> root = source ? parse_yaml(*source, report) : std::nullopt;
    if (!root) report.fail(kMaxReportedProblems);
    LoadContext load_context;
    load_context.has_assets = files.has_value();
    load_context.asset_folder = files.value_or("");
    load_context.reads_script = script == ScriptFile::read;
    return read_tree(std::move(*root), std::move(load_context), name, overrides, report);
  });
}

Scene with_devices(const Scene& scene, const std::string& file) {
  return guarded(file, [&] {
    Report report;
    const std::optional<SourceText> source = check_source(scene.expanded_text, report.add_source(scene.name), report);
    std::optional<Node> root = source ? parse_yaml(*source, report) : std::nullopt;
    const std::optional<Node> added = read_with_includes(file, report);
    if (!root || !added) report.fail(kMaxReportedProblems);
    constexpr std::string_view kSections[] = {"devices", "outputs"};
    for (const std::string_view section : kSections) {
      std::erase_if(root->entries, [&](const Node::Entry& entry) { return entry.key == section; });
    }
    report_duplicates(*added, "", report);
    for (const Node::Entry& entry : added->entries) {
      if (std::find(std::begin(kSections), std::end(kSections), entry.key) == std::end(kSections)) {
        report.add(entry.mark, entry.key, {"is no section of a file of devices", "devices or outputs", ""});
      } else {
        root->entries.push_back(entry);
      }
    }
    if (!report.is_clean()) report.fail(kMaxReportedProblems);
    LoadContext load_context;
    load_context.reads_script = false;
    load_context.device_folder = std::filesystem::path(file).parent_path().string();
    return read_tree(std::move(*root), std::move(load_context), scene.name, {}, report);
  });
}

Status check_is_split(const Scene& scene) {
  if (scene.session.solution == Solution::split) return Status::ok();
  return Status::error(ExitCode::bad_input,
                       "the scene's session.solution is monolithic: its physics is one system in one process and no "
                       "node can take a part of it; run it with 'slewring run SCENE --monolithic', or set "
                       "session.solution to split");
}

}  // namespace slew::scene
