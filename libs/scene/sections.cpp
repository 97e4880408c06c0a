// SPDX-License-Identifier: Apache-2.0
#include "scene/sections.h"

#include <algorithm>
#include <string>
#include <utility>

#include "measurement/instruments.h"
#include "multibody/constraints/gear_fields.h"
#include "multibody/joints/joint_fields.h"
#include "multibody/model/field_tables.h"
#include "multibody/motions/motion_fields.h"
#include "sensors/sensors.h"

namespace slew::scene {
namespace {

void add_mechanics(std::vector<ElementTable>& tables) {
  for (const multibody::Section& section : multibody::sections()) {
    for (const multibody::ElementType& type : section.types) {
      tables.push_back({.section = section.name,
                        .type = type.name,
                        .kind = type.kind,
                        .doc = type.doc,
                        .fields = type.fields,
                        .append = [append = type.append](
                                      Scene& scene, const std::string& name) { return append(scene.mechanics, name); },
                        .is_default = type.is_default});
    }
  }
}

template <typename Def>
void* append_named(std::vector<Def>& defs, const std::string& name) {
  Def& def = defs.emplace_back();
  def.name = name;
  return &def;
}

void add_hydraulics(std::vector<ElementTable>& tables) {
  tables.push_back(
      {.section = "volumes",
       .type = "",
       .kind = "volume",
       .doc = "pressure node",
       .fields = hydraulics::kVolumeFields,
       .append = [](Scene& scene, const std::string& name) { return append_named(scene.hydraulics.volumes, name); }});
  for (const hydraulics::ComponentType& type : hydraulics::component_types()) {
    tables.push_back({.section = "components",
                      .type = type.name,
                      .kind = "component",
                      .doc = type.doc,
                      .fields = type.fields,
                      .append = [make = type.make_def](Scene& scene, const std::string& name) {
                        auto& def = scene.hydraulics.components.emplace_back(make());
                        def->name = name;
                        return def->address();
                      }});
  }
  tables.push_back(
      {.section = "curves",
       .type = "",
       .kind = "curve",
       .doc = "function given by points",
       .fields = hydraulics::kCurveFields,
       .append = [](Scene& scene, const std::string& name) { return append_named(scene.hydraulics.curves, name); }});
}

void* append_input(Scene& scene, const std::string& name, InputType type) {
  InputDef& input = scene.inputs.emplace_back();
  input.name = name;
  input.type = type;
  return &input;
}

void* append_sensor(Scene& scene, const std::string& name, sensors::SensorType type) {
  sensors::SensorDef& sensor = scene.sensors.emplace_back();
  sensor.name = name;
  sensor.type = type;
  return &sensor;
}

void add_sensors(std::vector<ElementTable>& tables) {
  const std::span<const sensors::SensorTypeRow> types = sensors::sensor_types();
  for (std::size_t i = 0; i < types.size(); ++i) {
    tables.push_back({.section = "sensors",
                      .type = types[i].name,
                      .kind = "sensor",
                      .doc = types[i].doc,
                      .fields = types[i].fields,
                      .append = [type = static_cast<sensors::SensorType>(i)](Scene& scene, const std::string& name) {
                        return append_sensor(scene, name, type);
                      }});
  }
  const std::span<const measurement::InstrumentTypeRow> instruments = measurement::instrument_types();
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    tables.push_back({.section = "sensors",
                      .type = instruments[i].name,
                      .kind = "sensor",
                      .doc = instruments[i].doc,
                      .fields = instruments[i].fields,
                      .append = [type = static_cast<measurement::InstrumentType>(i)](Scene& scene,
                                                                                     const std::string& name) -> void* {
                        auto& def = *static_cast<measurement::InstrumentDef*>(append_named(scene.instruments, name));
                        def.type = type;
                        return &def;
                      }});
  }
}

// ---- devices --------------------------------------------------------------------------------------------------

template <auto First, auto... Rest>
constexpr ListTable list(std::string_view key, std::string_view doc, std::span<const Field> fields) {
  using Class = typename detail::MemberOf<decltype(First)>::class_type;
  ListTable table{.key = key, .doc = doc, .fields = fields};
  table.append = [](void* def) -> void* {
    return &detail::member_at<First, Rest...>(*static_cast<Class*>(def)).emplace_back();
  };
  table.rows = [](void* def) {
    std::vector<void*> rows;
    for (auto& row : detail::member_at<First, Rest...>(*static_cast<Class*>(def))) rows.push_back(&row);
    return rows;
  };
  return table;
}

std::span<const ListTable> joystick_lists() {
  static const ListTable lists[] = {
      list<&JoystickDef::stick, &devices::StickDef::axes>("axes", "axis", devices::axis_fields()),
      list<&JoystickDef::stick, &devices::StickDef::buttons>("buttons", "button", devices::button_fields())};
  return lists;
}

template <typename Def>
std::span<const ListTable> layout_lists() {
  static const ListTable lists[] = {list<&Def::layout, &devices::LayoutDef::fields>(
      "fields", "field of the packet, in its order", devices::layout_field_fields())};
  return lists;
}

template <typename Def>
std::span<const ListTable> signal_lists() {
  static const ListTable lists[] = {
      list<&Def::bus, &CanBusDef::signals>("signals", "signal of a message", can_signal_fields()),
      list<&Def::bus, &CanBusDef::canopen, &devices::CanOpenDef::nodes>(
          "nodes", "canopen: node that is started and watched", devices::canopen_node_fields()),
      list<&Def::bus, &CanBusDef::pdos>(
          "pdos", "canopen: PDO; can_in receives TPDOs of nodes and RPDOs of own_node, can_out sends the others",
          can_pdo_fields()),
      list<&Def::bus, &CanBusDef::objects>("objects", "canopen: object of a PDO, in its order", can_object_fields())};
  return lists;
}

void add_devices(std::vector<ElementTable>& tables) {
  tables.push_back(
      {.section = "devices",
       .type = "joystick",
       .kind = "device",
       .doc = "joystick, gamepad or pedals, of which axes and buttons move the inputs of a block",
       .fields = joystick_fields(),
       .append = [](Scene& scene, const std::string& name) { return append_named(scene.devices.joysticks, name); },
       .lists = joystick_lists()});
  tables.push_back(
      {.section = "devices",
       .type = "udp_in",
       .kind = "device",
       .doc = "packets of one layout that are received and move inputs",
       .fields = udp_in_fields(),
       .append = [](Scene& scene, const std::string& name) { return append_named(scene.devices.udp_ins, name); },
       .lists = layout_lists<UdpInDef>()});
  tables.push_back(
      {.section = "devices",
       .type = "udp_out",
       .kind = "device",
       .doc = "packets of one layout that are sent, with variables and outputs",
       .fields = udp_out_fields(),
       .append = [](Scene& scene, const std::string& name) { return append_named(scene.devices.udp_outs, name); },
       .lists = layout_lists<UdpOutDef>()});
  tables.push_back(
      {.section = "devices",
       .type = "can_in",
       .kind = "device",
       .doc = "signals of messages on CAN that are received and move inputs",
       .fields = can_in_fields(),
       .append = [](Scene& scene, const std::string& name) { return append_named(scene.devices.can_ins, name); },
       .lists = signal_lists<CanInDef>()});
  tables.push_back(
      {.section = "devices",
       .type = "can_out",
       .kind = "device",
       .doc = "messages on CAN that are sent, with variables and outputs",
       .fields = can_out_fields(),
       .append = [](Scene& scene, const std::string& name) { return append_named(scene.devices.can_outs, name); },
       .lists = signal_lists<CanOutDef>()});
  tables.push_back(
      {.section = "devices",
       .type = "motion_platform",
       .kind = "device",
       .doc = "hexapod under a driver's seat that follows a body's point: classical washout, legs by UDP",
       .fields = motion_platform_fields(),
       .append = [](Scene& scene, const std::string& name) { return append_named(scene.devices.platforms, name); },
       .lists = layout_lists<MotionPlatformDef>()});
  tables.push_back(
      {.section = "outputs",
       .type = "switched",
       .kind = "output",
       .doc = "lamp, buzzer or contact: 1 while a condition holds, else 0",
       .fields = switched_fields(),
       .append = [](Scene& scene, const std::string& name) { return append_named(scene.outputs.switched, name); }});
  tables.push_back(
      {.section = "outputs",
       .type = "analog",
       .kind = "output",
       .doc = "gauge, current or voltage: a variable's range as one of the output",
       .fields = analog_fields(),
       .append = [](Scene& scene, const std::string& name) { return append_named(scene.outputs.analog, name); }});
}

void add_own(std::vector<ElementTable>& tables) {
  tables.push_back(
      {.section = "inputs",
       .type = kInputTypeChoices[0],
       .kind = "input",
       .doc = "axis of a joystick, raw value -1 to 1",
       .fields = input_fields(),
       .append = [](Scene& scene, const std::string& name) { return append_input(scene, name, InputType::analog); }});
  tables.push_back(
      {.section = "inputs",
       .type = kInputTypeChoices[1],
       .kind = "input",
       .doc = "button, raw value 0 or 1",
       .fields = input_fields(),
       .append = [](Scene& scene, const std::string& name) { return append_input(scene, name, InputType::digital); }});
  tables.push_back(
      {.section = "graphics",
       .type = "",
       .kind = "graphic",
       .doc = "mesh for the eye, which no physics reads",
       .fields = graphic_fields(),
       .append = [](Scene& scene, const std::string& name) { return append_named(scene.graphics, name); }});
  tables.push_back({.section = "plots",
                    .type = "",
                    .kind = "plot",
                    .doc = "curves over time, with a heading and a panel per unit",
                    .fields = plot_fields(),
                    .append = [](Scene& scene, const std::string& name) { return append_named(scene.plots, name); }});
}

std::vector<ElementTable> make_element_tables() {
  std::vector<ElementTable> tables;
  add_mechanics(tables);
  add_hydraulics(tables);
  add_sensors(tables);
  add_own(tables);
  add_devices(tables);
  return tables;
}

std::vector<SingleTable> make_single_tables() {
  return {
      {"session", "how a session runs", session_fields(), [](Scene& scene) -> void* { return &scene.session; }},
      {"mechanics", "settings of the mechanics", multibody::mechanics_fields(),
       [](Scene& scene) -> void* { return &scene.mechanics; }},
      {"hydraulics", "oil, solver and start state", hydraulics::kHydraulicsFields,
       [](Scene& scene) -> void* { return &scene.hydraulics; }},
      {"recording", "which variables are published and stored", recording_fields(),
       [](Scene& scene) -> void* { return &scene.recording; }},
  };
}

const ElementTable& table_of(std::string_view section, std::string_view type) {
  const auto& tables = element_tables();
  return *std::find_if(tables.begin(), tables.end(),
                       [&](const ElementTable& table) { return table.section == section && table.type == type; });
}

ElementRef ref(const ElementTable& table, std::string_view name, void* def) {
  return {name, table.section, table.is_default ? std::string_view() : table.type, table.kind, table.fields,
          def,  table.lists};
}

template <typename Defs>
void collect(std::vector<ElementRef>& refs, const ElementTable& table, Defs& defs) {
  for (auto& def : defs) refs.push_back(ref(table, def.name, &def));
}

// kinds of forces beyond spring-dampers
void collect_kinds(std::vector<ElementRef>& refs, std::string_view section, multibody::MechanicsDef& mechanics) {
  multibody::for_each_force_type(mechanics, [&](auto, const auto& type, auto& defs) {
    if (type.section == section) collect(refs, table_of(section, type.name), defs);
  });
}

void collect_mechanics(std::vector<ElementRef>& refs, multibody::MechanicsDef& mechanics) {
  // in the order of JointType
  const std::span<const multibody::ElementType> joint_types = multibody::joint_types();
  for (multibody::BodyDef& body : mechanics.bodies) {
    const multibody::ElementType& type = multibody::sections()[0].types[static_cast<std::size_t>(body.type)];
    refs.push_back(ref(table_of("bodies", type.name), body.name, &body));
  }
  for (multibody::JointDef& joint : mechanics.joints) {
    refs.push_back(ref(table_of("joints", joint_types[static_cast<std::size_t>(joint.type)].name), joint.name, &joint));
  }
  collect(refs, table_of("forces", "translational"), mechanics.translational_forces);
  collect(refs, table_of("forces", "rotational"), mechanics.rotational_forces);
  collect_kinds(refs, "forces", mechanics);
  collect(refs, table_of("dummies", "body_to_body_force"), mechanics.force_dummies);
  collect(refs, table_of("dummies", "static"), mechanics.static_dummies);
  collect_kinds(refs, "dummies", mechanics);
  collect(refs, table_of("dummies", "part"), mechanics.part_dummies);
  collect(refs, table_of("dummies", "constraint"), mechanics.constraint_dummies);
  // values of `type:` in the order of contact::ShapeType
  constexpr std::string_view kShapeTypes[] = {"sphere", "box",          "cylinder",    "capsule",
                                              "plane",  "height_field", "convex_mesh", "triangle_mesh"};
  for (multibody::ShapeDef& shape : mechanics.shapes) {
    refs.push_back(ref(table_of("shapes", kShapeTypes[static_cast<int>(shape.type)]), shape.name, &shape));
  }
  collect(refs, table_of("contacts", ""), mechanics.contacts);
  collect(refs, table_of("frictions", ""), mechanics.frictions);
  for (multibody::MotionDef& motion : mechanics.motions) {
    const std::size_t type = multibody::motion_type_index(motion);
    refs.push_back(ref(table_of("motions", multibody::motion_types()[type].name), motion.name, &motion));
  }
  for (multibody::GearDef& gear : mechanics.gears) {
    const auto type = static_cast<std::size_t>(gear.kind);
    refs.push_back(ref(table_of("gears", multibody::gear_types()[type].name), gear.name, &gear));
  }
}

}  // namespace

// built at the first use: constant afterwards
const std::vector<ElementTable>& element_tables() {
  static const std::vector<ElementTable> tables = make_element_tables();
  return tables;
}

const std::vector<SingleTable>& single_tables() {
  static const std::vector<SingleTable> tables = make_single_tables();
  return tables;
}

const std::vector<std::string_view>& element_sections() {
  static const std::vector<std::string_view> names = {
      "bodies",  "joints",     "forces", "dummies", "shapes", "contacts", "frictions", "motions", "gears",
      "volumes", "components", "curves", "sensors", "inputs", "outputs",  "devices",   "plots",   "graphics"};
  return names;
}

const std::vector<std::string_view>& top_level_keys() {
  static const std::vector<std::string_view> keys = {
      "scene",   "description", "include",  "assets",    "session", "mechanics", "bodies",     "joints",  "forces",
      "dummies", "shapes",      "contacts", "frictions", "motions", "gears",     "hydraulics", "volumes", "components",
      "curves",  "sensors",     "inputs",   "outputs",   "devices", "script",    "recording",  "plots",   "graphics"};
  return keys;
}

std::vector<ElementRef> elements(Scene& scene) {
  std::vector<ElementRef> refs;
  collect_mechanics(refs, scene.mechanics);
  collect(refs, table_of("volumes", ""), scene.hydraulics.volumes);
  for (const auto& component : scene.hydraulics.components) {
    refs.push_back(ref(table_of("components", component->type_name()), component->name, component->address()));
  }
  collect(refs, table_of("curves", ""), scene.hydraulics.curves);
  for (sensors::SensorDef& sensor : scene.sensors) {
    refs.push_back(ref(table_of("sensors", sensors::sensor_types()[static_cast<std::size_t>(sensor.type)].name),
                       sensor.name, &sensor));
  }
  for (measurement::InstrumentDef& def : scene.instruments) {
    refs.push_back(ref(table_of("sensors", measurement::instrument_types()[static_cast<std::size_t>(def.type)].name),
                       def.name, &def));
  }
  for (InputDef& input : scene.inputs) {
    refs.push_back(ref(table_of("inputs", kInputTypeChoices[static_cast<int>(input.type)]), input.name, &input));
  }
  collect(refs, table_of("outputs", "switched"), scene.outputs.switched);
  collect(refs, table_of("outputs", "analog"), scene.outputs.analog);
  collect(refs, table_of("devices", "joystick"), scene.devices.joysticks);
  collect(refs, table_of("devices", "udp_in"), scene.devices.udp_ins);
  collect(refs, table_of("devices", "udp_out"), scene.devices.udp_outs);
  collect(refs, table_of("devices", "can_in"), scene.devices.can_ins);
  collect(refs, table_of("devices", "can_out"), scene.devices.can_outs);
  collect(refs, table_of("devices", "motion_platform"), scene.devices.platforms);
  collect(refs, table_of("plots", ""), scene.plots);
  collect(refs, table_of("graphics", ""), scene.graphics);
  return refs;
}

std::vector<ElementRef> single_sections(Scene& scene) {
  std::vector<ElementRef> refs;
  for (const SingleTable& table : single_tables()) {
    refs.push_back({table.section, table.section, "", "", table.fields, table.def(scene)});
  }
  return refs;
}

}  // namespace slew::scene
