// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "core/suggestion.h"
#include "devices/dbc.h"
#include "scene/device_readers.h"

namespace slew::scene {
namespace {

template <typename Def>
void add_bus_fields(std::vector<Field>& fields) {
  static constexpr std::string_view kProtocols[] = {"plain", "j1939"};
  fields.push_back(field<&Def::bus, &CanBusDef::interface>("interface", {.doc = "interface of Linux, as can0"}));
  fields.push_back(field<&Def::bus, &CanBusDef::database>(
      "database", {.doc = "DBC file in the scene's folder with the messages of the signals"}));
  fields.push_back(field<&Def::bus, &CanBusDef::definition>(
      "definition",
      {.doc = "these messages as a DBC text, in place of a file; with a database it is filled from there"}));
  fields.push_back(field<&Def::bus, &CanBusDef::protocol>(
      "protocol", {.choices = kProtocols,
                   .doc = "j1939: messages are found by their parameter group from any source, and codes for 'not "
                          "available' and 'error' are no values"}));
}

std::vector<Field> make_can_in_fields() {
  std::vector<Field> fields = {
      field<&CanInDef::path>("path", {.doc = "file of 'candump -l' in place of an interface, which is played once"}),
      field<&CanInDef::timeout>("timeout", {.dimension = Dimension::time,
                                            .range = kSilenceRange,
                                            .doc = "time without a value of a signal after which the inputs go to "
                                                   "neutral"}),
  };
  add_bus_fields<CanInDef>(fields);
  add_enable_fields<CanInDef>(fields, "signal that must not be 0 before an input leaves neutral, as Panel.Enable");
  return fields;
}

std::vector<Field> make_can_out_fields() {
  std::vector<Field> fields = {
      field<&CanOutDef::every>("every", {.dimension = Dimension::time,
                                         .range = kOftenRange,
                                         .doc = "shortest time of the session between two frames of a message"}),
  };
  add_bus_fields<CanOutDef>(fields);
  return fields;
}

constexpr Field kCanSignalFields[] = {
    field<&CanSignalDef::signal>(
        "signal", {.presence = Presence::required, .doc = "message and signal of the database, as Panel.Lift"}),
    field<&CanSignalDef::input>(
        "input", {.reference = "input", .doc = "received: input that the value moves, -1 to 1, digital 0 or 1"}),
    field<&CanSignalDef::variable>("variable", {.doc = "sent: variable of the session, as Cyl_Lift.force, in SI"}),
    field<&CanSignalDef::output>("output", {.reference = "output", .doc = "sent: output of the scene"}),
    field<&CanSignalDef::gain>("gain",
                               {.doc = "received: input = gain * value; sent: value = gain * variable or output"}),
};

// The message of "Message.Signal"; null and a problem: there is none.
const devices::CanMessage* find_signal(const std::string& device, const devices::CanDatabase& database,
                                       const std::string& name, Problems& problems) {
  std::vector<std::string> names;
  for (const devices::CanMessage& message : database.messages) {
    for (const devices::CanSignal& signal : message.signals) {
      names.push_back(message.name + "." + signal.name);
      if (names.back() == name) return &message;
    }
  }
  problems.push_back({fmt::format("{}.signals.{}", device, name), fmt::format("the database has no signal '{}'", name),
                      "message and signal, as Panel.Lift", closest(name, {names.begin(), names.end()})});
  return nullptr;
}

// The messages of the definition, if they are sound and have all signals.
std::optional<std::vector<devices::CanMessage>> read_definition(const std::string& name, const CanBusDef& bus,
                                                                Problems& problems) {
  const std::size_t before = problems.size();
  if (bus.signals.empty()) problems.push_back({name, "the device has no signals", "signals", ""});
  if (bus.definition.empty()) {
    problems.push_back({name, "the signals have no definition", "database: a DBC file in the scene's folder", ""});
  }
  if (problems.size() > before) return std::nullopt;
  Problems found;
  const devices::CanDatabase database = devices::read_dbc(bus.definition, "definition", found);
  for (const Problem& problem : found)
    problems.push_back(
        {name + ".definition", problem.path + ": " + problem.what, problem.expected, problem.suggestion});
  for (const CanSignalDef& signal : bus.signals)
    static_cast<void>(find_signal(name, database, signal.signal, problems));
  if (problems.size() > before) return std::nullopt;
  return database.messages;
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

void read_database(const std::string& device, CanBusDef& bus, const std::string& path, Problems& problems) {
  Problems found;
  const devices::CanDatabase database = devices::load_dbc(path, found);
  for (const Problem& problem : found)
    problems.push_back(
        {device + ".database", problem.path + ": " + problem.what, problem.expected, problem.suggestion});
  if (!found.empty()) return;
  std::vector<devices::CanMessage> used;
  for (const CanSignalDef& signal : bus.signals) {
    const devices::CanMessage* const message = find_signal(device, database, signal.signal, problems);
    const auto is_same = [&](const devices::CanMessage& other) {
      return message != nullptr && other.name == message->name;
    };
    if (message != nullptr && std::none_of(used.begin(), used.end(), is_same)) used.push_back(*message);
  }
  bus.definition = devices::write_dbc(used);
}

void read_can_in(CanInDef& def, InputUse& use, Problems& problems) {
  if (def.bus.interface.empty() == def.path.empty()) {
    problems.push_back({def.name, "the bus is not identified, or twice", "one of interface and path", ""});
  }
  read_enable(def.name, def.enable, def.timeout, problems);
  const auto messages = read_definition(def.name, def.bus, problems);
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
  const auto messages = read_definition(def.name, def.bus, problems);
  if (!messages) return;
  for (const devices::CanMessage& message : *messages) check_overlaps(def.name + ".signals", message, problems);
  std::map<std::string, int> uses;
  for (const CanSignalDef& signal : def.bus.signals) {
    const std::string path = fmt::format("{}.signals.{}", def.name, signal.signal);
    if (!signal.input.empty()) problems.push_back({path, "a sent signal moves nothing", "variable or output", ""});
    if (signal.variable.empty() == signal.output.empty()) {
      problems.push_back({path, "the signal has no source, or two", "one of variable and output", ""});
    }
    if (++uses[signal.signal] == 2) problems.push_back({path, "the signal is in the list twice", "once", ""});
  }
}

}  // namespace slew::scene
