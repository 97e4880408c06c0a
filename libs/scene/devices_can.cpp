// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <map>

#include "core/suggestion.h"
#include "devices/dbc.h"
#include "devices/j1939.h"
#include "scene/device_readers.h"

namespace slew::scene {
namespace {

constexpr std::size_t kCanBytes = 8, kCanFdBytes = 64;

template <typename Def>
void add_bus_fields(std::vector<Field>& fields) {
  using devices::CanOpenDef, devices::J1939UnitDef;
  static constexpr std::string_view kProtocols[] = {"plain", "j1939", "canopen"};
  fields.push_back(field<&Def::bus, &CanBusDef::interface>("interface", {.doc = "interface of Linux, as can0"}));
  fields.push_back(field<&Def::bus, &CanBusDef::database>(
      "database", {.doc = "DBC file in the scene's folder with the messages of the signals"}));
  fields.push_back(field<&Def::bus, &CanBusDef::definition>(
      "definition", {.doc = "these messages as a DBC text; filled from a database"}));
  fields.push_back(field<&Def::bus, &CanBusDef::protocol>(
      "protocol", {.choices = kProtocols,
                   .doc = "j1939: messages by their parameter group from any source; codes for 'not available' and "
                          "'error' are no values; canopen: the messages are pdos"}));
  const std::span<const Field> network = devices::canopen_fields();
  fields.push_back(lent<&Def::bus, &CanBusDef::canopen, &CanOpenDef::own_node>(network, "own_node"));
  fields.push_back(lent<&Def::bus, &CanBusDef::canopen, &CanOpenDef::own_heartbeat>(network, "own_heartbeat"));
  fields.push_back(lent<&Def::bus, &CanBusDef::canopen, &CanOpenDef::sync>(network, "sync"));
  const std::span<const Field> unit = devices::j1939_unit_fields();
  const auto add = [&]<auto Member>(std::string_view key) {
    fields.push_back(lent<&Def::bus, &CanBusDef::unit, Member>(unit, key));
  };
  add.template operator()<&J1939UnitDef::address>("address");
  add.template operator()<&J1939UnitDef::has_arbitrary_address>("arbitrary_address");
  add.template operator()<&J1939UnitDef::identity>("identity");
  add.template operator()<&J1939UnitDef::manufacturer>("manufacturer");
  add.template operator()<&J1939UnitDef::function>("function");
  add.template operator()<&J1939UnitDef::function_instance>("function_instance");
  add.template operator()<&J1939UnitDef::ecu_instance>("ecu_instance");
  add.template operator()<&J1939UnitDef::vehicle_system>("vehicle_system");
  add.template operator()<&J1939UnitDef::vehicle_system_instance>("vehicle_system_instance");
  add.template operator()<&J1939UnitDef::industry_group>("industry_group");
}

std::vector<Field> make_can_pdo_fields() {
  using devices::PdoDef;
  const std::span<const Field> rows = devices::pdo_fields();
  return {
      field<&PdoDef::name>("name", {.presence = Presence::required, .doc = "name, as signals state it"}),
      lent<&PdoDef::node>(rows, "node"),
      lent<&PdoDef::number>(rows, "number"),
      lent<&PdoDef::cob_id>(rows, "cob_id"),
      lent<&PdoDef::is_synchronous>(rows, "synchronous"),
  };
}

std::vector<Field> make_can_object_fields() {
  using devices::PdoObjectDef;
  const std::span<const Field> rows = devices::pdo_object_fields();
  return {
      field<&CanObjectDef::pdo>("pdo", {.presence = Presence::required, .doc = "name of the PDO that it is in"}),
      field<&CanObjectDef::object, &PdoObjectDef::name>(
          "name", {.doc = "name, as signals state it; without one these bits are not used"}),
      lent<&CanObjectDef::object, &PdoObjectDef::type>(rows, "as"),
      lent<&CanObjectDef::object, &PdoObjectDef::bits>(rows, "bits"),
      lent<&CanObjectDef::object, &PdoObjectDef::scale>(rows, "scale"),
      lent<&CanObjectDef::object, &PdoObjectDef::offset>(rows, "offset"),
      lent<&CanObjectDef::object, &PdoObjectDef::unit>(rows, "unit"),
  };
}

std::vector<Field> make_can_in_fields() {
  std::vector<Field> fields = {
      field<&CanInDef::path>(
          "path", {.doc = "file of 'candump -l' in the scene's folder, played once in place of an interface"}),
      field<&CanInDef::timeout>("timeout",
                                {.dimension = Dimension::time,
                                 .range = kSilenceRange,
                                 .doc = "time without a value of a signal after which inputs go to neutral"}),
  };
  add_bus_fields<CanInDef>(fields);
  add_enable_fields<CanInDef>(fields, "signal that must not be 0 before an input leaves neutral, as Panel.Enable");
  return fields;
}

std::vector<Field> make_can_out_fields() {
  std::vector<Field> fields = {
      field<&CanOutDef::every>("every", {.dimension = Dimension::time,
                                         .range = kOftenRange,
                                         .doc = "shortest session time between two frames of a message"}),
  };
  add_bus_fields<CanOutDef>(fields);
  return fields;
}

constexpr Field kCanSignalFields[] = {
    field<&CanSignalDef::signal>(
        "signal", {.presence = Presence::required, .doc = "message and signal of the database, as Panel.Lift"}),
    field<&CanSignalDef::input>(
        "input", {.reference = "input", .doc = "received: input that the value moves (-1 to 1, digital 0 or 1)"}),
    field<&CanSignalDef::variable>("variable", {.doc = "sent: variable of the session, as Cyl_Lift.force, in SI"}),
    field<&CanSignalDef::output>("output", {.reference = "output", .doc = "sent: output of the scene"}),
    field<&CanSignalDef::gain>("gain",
                               {.doc = "received: input = gain * value; sent: value = gain * variable or output"}),
};

// The message of "Message.Signal"; null and a problem: there is none.
const devices::CanMessage* find_message_of(const std::string& device, CanProtocol protocol,
                                           std::span<const devices::CanMessage> messages, const std::string& name,
                                           Problems& problems) {
  std::vector<std::string> names;
  for (const devices::CanMessage& message : messages) {
    for (const devices::CanSignal& signal : message.signals) names.push_back(message.name + "." + signal.name);
    for (const std::string_view axis : devices::joystick_axes(message))
      names.push_back(fmt::format("{}.{}", message.name, axis));
    if (std::find(names.begin(), names.end(), name) != names.end()) return &message;
  }
  const bool is_pdo = protocol == CanProtocol::canopen;
  problems.push_back({fmt::format("{}.signals.{}", device, name),
                      fmt::format("{} '{}'", is_pdo ? "no PDO has an object" : "the database has no signal", name),
                      is_pdo ? "PDO and object, as Panel.lift" : "message and signal, as Panel.Lift",
                      closest(name, {names.begin(), names.end()})});
  return nullptr;
}

// Messages of J1939 that need no database; those of the database's names come from there.
void add_built_in(const CanBusDef& bus, std::vector<devices::CanMessage>& messages) {
  if (bus.protocol != CanProtocol::j1939) return;
  for (devices::CanMessage& message : std::vector{devices::eec1(), devices::bjm1()}) {
    const auto is_same = [&](const devices::CanMessage& other) { return other.name == message.name; };
    if (std::none_of(messages.begin(), messages.end(), is_same)) messages.push_back(std::move(message));
  }
}

void write_definition(const std::string& device, CanBusDef& bus, std::span<const devices::CanMessage> messages,
                      Problems& problems) {
  std::vector<devices::CanMessage> used;
  for (const CanSignalDef& signal : bus.signals) {
    const devices::CanMessage* const message = find_message_of(device, bus.protocol, messages, signal.signal, problems);
    const auto is_same = [&](const devices::CanMessage& other) {
      return message != nullptr && other.name == message->name;
    };
    if (message != nullptr && std::none_of(used.begin(), used.end(), is_same)) used.push_back(*message);
  }
  bus.definition = devices::write_dbc(used);
}

// The direction of a PDO as its node sees it.
devices::PdoDirection direction_of(const devices::PdoDef& pdo, const CanBusDef& bus, CanFlow flow) {
  const bool is_own = pdo.node == bus.canopen.own_node;
  return (flow == CanFlow::sent) == is_own ? devices::PdoDirection::transmit : devices::PdoDirection::receive;
}

std::vector<devices::CanMessage> pdo_messages(const CanBusDef& bus, CanFlow flow, Problems& problems) {
  std::vector<devices::CanMessage> messages;
  for (const devices::PdoDef& row : bus.pdos) {
    devices::PdoDef pdo = row;
    pdo.direction = direction_of(pdo, bus, flow);
    for (const CanObjectDef& object : bus.objects)
      if (object.pdo == pdo.name) pdo.objects.push_back(object.object);
    const std::size_t before = problems.size();
    validate(pdo, problems);
    if (problems.size() == before) messages.push_back(build(pdo));
  }
  return messages;
}

void check_pdos(const std::string& name, const CanBusDef& bus, CanFlow flow, Problems& problems) {
  std::vector<std::string_view> names;
  std::map<std::uint32_t, std::string> identifiers;
  for (std::size_t i = 0; i < bus.pdos.size(); ++i) {
    const devices::PdoDef& pdo = bus.pdos[i];
    const std::string path = fmt::format("{}.pdos[{}]", name, i);
    if (std::find(names.begin(), names.end(), pdo.name) != names.end())
      problems.push_back({path + ".name", fmt::format("'{}' is in the list twice", pdo.name), "a name of its own", ""});
    names.emplace_back(pdo.name);
    if (pdo.is_synchronous && flow == CanFlow::received) {
      problems.push_back(
          {path + ".synchronous", "a received PDO is used when it arrives", "no synchronous: its node decides", ""});
    }
    const auto id = pdo.cob_id != 0
                        ? static_cast<std::uint32_t>(pdo.cob_id)
                        : devices::pdo_cob_id(direction_of(pdo, bus, flow), static_cast<unsigned>(pdo.number),
                                              static_cast<unsigned>(pdo.node));
    const auto [first, is_new] = identifiers.emplace(id, pdo.name);
    if (!is_new) {
      problems.push_back({path, fmt::format("identifier 0x{:03X} is that of {}", id, first->second),
                          "another number, node or cob_id", ""});
    }
  }
  for (std::size_t i = 0; i < bus.objects.size(); ++i) {
    const std::string& pdo = bus.objects[i].pdo;
    if (std::find(names.begin(), names.end(), pdo) != names.end()) continue;
    problems.push_back({fmt::format("{}.objects[{}].pdo", name, i), fmt::format("there is no PDO '{}'", pdo),
                        "a name in pdos", closest(pdo, names)});
  }
}

// Keys of a protocol that the bus does not have.
void check_protocol(const std::string& name, const CanBusDef& bus, Problems& problems) {
  const auto refuse = [&](bool is_stated, const char* key, const char* protocol) {
    if (!is_stated) return;
    problems.push_back({fmt::format("{}.{}", name, key), fmt::format("'{}' is of protocol {}", key, protocol),
                        fmt::format("protocol: {}", protocol), ""});
  };
  if (bus.protocol != CanProtocol::canopen) {
    refuse(!bus.pdos.empty(), "pdos", "canopen");
    refuse(!bus.objects.empty(), "objects", "canopen");
    refuse(!bus.canopen.nodes.empty(), "nodes", "canopen");
    refuse(bus.canopen.own_node != 0, "own_node", "canopen");
    refuse(bus.canopen.sync != 0, "sync", "canopen");
  }
  if (bus.protocol != CanProtocol::j1939) refuse(bus.unit.claims(), "address", "j1939");
  if (bus.protocol == CanProtocol::canopen && !(bus.database.empty() && bus.definition.empty())) {
    problems.push_back({name + (bus.database.empty() ? ".definition" : ".database"),
                        "the messages of CANopen are PDOs by layout", "pdos and objects", ""});
  }
}

// A message is one frame: longer ones of J1939 need its transport protocol.
void check_lengths(const std::string& name, const CanBusDef& bus, std::span<const devices::CanMessage> messages,
                   Problems& problems) {
  const bool is_j1939 = bus.protocol == CanProtocol::j1939;
  const std::size_t most = is_j1939 ? kCanBytes : kCanFdBytes;
  for (const devices::CanMessage& message : messages) {
    if (message.bytes <= most) continue;
    problems.push_back({name + (bus.database.empty() ? ".definition" : ".database"),
                        fmt::format("message {} has {} bytes", message.name, message.bytes),
                        is_j1939 ? "at most 8, since longer messages of J1939 come in several frames (transport "
                                   "protocol), which are not supported"
                                 : "at most 64, as a frame has",
                        ""});
  }
}

// The messages, if they are sound and have all signals.
std::optional<std::vector<devices::CanMessage>> read_messages(const std::string& name, CanBusDef& bus, CanFlow flow,
                                                              Problems& problems) {
  const std::size_t before = problems.size();
  check_protocol(name, bus, problems);
  if (problems.size() > before) return std::nullopt;
  if (bus.signals.empty()) problems.push_back({name, "the device has no signals", "signals", ""});
  const bool is_canopen = bus.protocol == CanProtocol::canopen;
  if (is_canopen) {
    validate(name, bus.canopen, problems);
    check_pdos(name, bus, flow, problems);
  } else if (bus.definition.empty() && bus.database.empty() && bus.protocol == CanProtocol::j1939) {
    std::vector<devices::CanMessage> messages;
    add_built_in(bus, messages);
    write_definition(name, bus, messages, problems);
  } else if (bus.definition.empty()) {
    problems.push_back({name, "the signals have no definition", "database: a DBC file in the scene's folder", ""});
  }
  if (problems.size() > before) return std::nullopt;
  Problems found;
  std::vector<devices::CanMessage> messages = can_messages(bus, flow, found);
  for (const Problem& problem : found) {
    if (is_canopen) {
      problems.push_back({name + ".pdos." + problem.path, problem.what, problem.expected, problem.suggestion});
    } else {
      problems.push_back(
          {name + ".definition", problem.path + ": " + problem.what, problem.expected, problem.suggestion});
    }
  }
  if (!found.empty()) return std::nullopt;
  check_lengths(name, bus, messages, problems);
  for (const CanSignalDef& signal : bus.signals)
    static_cast<void>(find_message_of(name, bus.protocol, messages, signal.signal, problems));
  if (problems.size() > before) return std::nullopt;
  return messages;
}

}  // namespace

std::span<const Field> can_in_fields() {
  static const std::vector<Field> fields = make_can_in_fields();
  return fields;
}
std::span<const Field> can_out_fields() {
  static const std::vector<Field> fields = make_can_out_fields();
  return fields;
}
std::span<const Field> can_signal_fields() noexcept {
  return kCanSignalFields;
}
std::span<const Field> can_pdo_fields() {
  static const std::vector<Field> fields = make_can_pdo_fields();
  return fields;
}
std::span<const Field> can_object_fields() {
  static const std::vector<Field> fields = make_can_object_fields();
  return fields;
}

std::vector<devices::CanMessage> can_messages(const CanBusDef& bus, CanFlow flow, Problems& problems) {
  if (bus.protocol == CanProtocol::canopen) return pdo_messages(bus, flow, problems);
  return devices::read_dbc(bus.definition, "definition", problems).messages;
}

void read_database(const std::string& device, CanBusDef& bus, const std::string& path, Problems& problems) {
  Problems found;
  devices::CanDatabase database = devices::load_dbc(path, found);
  for (const Problem& problem : found)
    problems.push_back(
        {device + ".database", problem.path + ": " + problem.what, problem.expected, problem.suggestion});
  if (!found.empty()) return;
  add_built_in(bus, database.messages);
  write_definition(device, bus, database.messages, problems);
}

void read_can_in(CanInDef& def, InputUse& use, Problems& problems) {
  if (def.bus.interface.empty() == def.path.empty()) {
    problems.push_back({def.name, "the bus is not identified, or twice", "one of interface and path", ""});
  }
  read_enable(def.name, def.enable, def.timeout, problems);
  const auto messages = read_messages(def.name, def.bus, CanFlow::received, problems);
  if (!messages) return;
  bool has_input = false, has_dead_man = def.enable.dead_man.empty();
  for (const CanSignalDef& signal : def.bus.signals) {
    const std::string path = fmt::format("{}.signals.{}", def.name, signal.signal);
    if (!signal.variable.empty() || !signal.output.empty()) {
      problems.push_back({path, "a received signal takes nothing from the session", "input", ""});
    }
    has_dead_man = has_dead_man || signal.signal == def.enable.dead_man;
    if (signal.input.empty()) continue;
    has_input = true;
    if (const InputDef* const input = use.find(signal.input)) use.use(path, def.name, *input);
  }
  if (!has_input) problems.push_back({def.name, "the device moves nothing", "a signal with an input", ""});
  if (!has_dead_man) {
    problems.push_back({def.name + ".dead_man", fmt::format("'{}' is not among the signals", def.enable.dead_man),
                        "a signal of the list", ""});
  }
}

void read_can_out(CanOutDef& def, Problems& problems) {
  if (def.bus.interface.empty()) problems.push_back({def.name, "the bus is not identified", "interface", ""});
  const auto messages = read_messages(def.name, def.bus, CanFlow::sent, problems);
  if (!messages) return;
  for (const devices::CanMessage& message : *messages) check_overlaps(def.name + ".signals", message, problems);
  std::map<std::string, int> uses;
  for (const CanSignalDef& signal : def.bus.signals) {
    const std::string path = fmt::format("{}.signals.{}", def.name, signal.signal);
    if (!signal.input.empty()) problems.push_back({path, "a sent signal moves nothing", "variable or output", ""});
    if (signal.variable.empty() == signal.output.empty()) {
      problems.push_back({path, "the signal has no source, or two", "one of variable and output", ""});
    }
    const bool is_axis = std::any_of(messages->begin(), messages->end(), [&](const devices::CanMessage& message) {
      return signal.signal.starts_with(message.name + ".") &&
             devices::find_joystick_axis(message, std::string_view(signal.signal).substr(message.name.size() + 1));
    });
    if (is_axis)
      problems.push_back({path, "an axis of several signals is only received", "its position and its states", ""});
    if (++uses[signal.signal] == 2) problems.push_back({path, "the signal is in the list twice", "once", ""});
  }
}

}  // namespace slew::scene
