#include "scene/devices.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "core/suggestion.h"
#include "devices/dbc.h"
#include "devices/udp_address.h"
#include "scene/defs.h"
#include "scene/number.h"
#include "scene/units.h"

namespace slew::scene {
namespace {

constexpr Range kOftenRange{.min = 0.0005, .max = 10, .min_is_open = false, .max_is_open = false};
constexpr Range kSilenceRange{.min = 0.002, .max = 60, .min_is_open = false, .max_is_open = false};
constexpr Range kJoystickBlockRange{.min = 0, .max = 15, .min_is_open = false, .max_is_open = false};
constexpr std::size_t kMaxConditions = 8;

// A row of a library's table for a member of ours that holds its Def.
template <auto... Path>
Field lent(std::span<const Field> fields, std::string_view key) {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.key == key; });
  FieldOptions options = *found;
  options.presence = Presence::optional;
  return field<Path...>(key, options);
}

template <typename Def>
void add_enable_fields(std::vector<Field>& fields, std::string_view dead_man) {
  const std::span<const Field> chain = devices::enable_chain_fields();
  fields.push_back(field<&Def::enable, &devices::EnableChainDef::dead_man>("dead_man", {.doc = dead_man}));
  fields.push_back(field<&Def::enable, &devices::EnableChainDef::conditions>(
      "conditions", {.doc = "conditions on variables that must be met before an input leaves neutral, as "
                            "'Vol_MainPump.pressure > 20 bar'; needs dead_man"}));
  fields.push_back(lent<&Def::enable, &devices::EnableChainDef::neutral_band>(chain, "neutral_band"));
}

template <typename Def>
void add_layout_fields(std::vector<Field>& fields) {
  const std::span<const Field> layout = devices::layout_fields();
  fields.push_back(lent<&Def::layout, &devices::LayoutDef::byte_order>(layout, "byte_order"));
  fields.push_back(lent<&Def::layout, &devices::LayoutDef::packing>(layout, "packing"));
  fields.push_back(lent<&Def::layout, &devices::LayoutDef::size>(layout, "size"));
}

std::vector<Field> make_joystick_fields() {
  std::vector<Field> fields = {
      field<&JoystickDef::path>("path", {.doc = "device file, as /dev/input/event5 or a link in /dev/input/by-id; or a "
                                                "file of recorded events, which is played once"}),
      field<&JoystickDef::match>("match", {.doc = "name of the device, or a pattern with * and ?; the first one of "
                                                  "/dev/input that fits is taken, also one that is plugged in later"}),
      field<&JoystickDef::block>(
          "block", {.range = kJoystickBlockRange, .doc = "block of the inputs that its axes and buttons move"}),
  };
  add_enable_fields<JoystickDef>(fields, "button that must be pressed before an input leaves neutral, as BTN_THUMB");
  return fields;
}

std::vector<Field> make_udp_in_fields() {
  std::vector<Field> fields = {
      field<&UdpInDef::listen>("listen", {.presence = Presence::required,
                                          .doc = "address and port that packets are received on, as 127.0.0.1:5005"}),
      field<&UdpInDef::from>("from", {.doc = "addresses of the senders that are accepted; default 127.0.0.1 alone"}),
      field<&UdpInDef::timeout>("timeout", {.dimension = Dimension::time,
                                            .range = kSilenceRange,
                                            .doc = "silence after which the inputs go to neutral"}),
  };
  add_layout_fields<UdpInDef>(fields);
  fields.push_back(lent<&UdpInDef::layout, &devices::LayoutDef::most_lost>(devices::layout_fields(), "most_lost"));
  add_enable_fields<UdpInDef>(fields, "field of the layout that must not be 0 before an input leaves neutral");
  return fields;
}

std::vector<Field> make_udp_out_fields() {
  std::vector<Field> fields = {
      field<&UdpOutDef::send>("send", {.presence = Presence::required,
                                       .doc = "address and port that packets are sent to, as 127.0.0.1:5006"}),
      field<&UdpOutDef::every>("every", {.dimension = Dimension::time,
                                         .range = kOftenRange,
                                         .doc = "shortest time of the session between two packets"}),
  };
  add_layout_fields<UdpOutDef>(fields);
  return fields;
}

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

std::vector<Field> make_switched_fields() {
  using devices::SwitchedOutputDef;
  const std::span<const Field> rows = devices::switched_output_fields();
  return {
      field<&SwitchedDef::condition>("condition", {.presence = Presence::required,
                                                   .doc = "variable, > >= < or <=, and a quantity, as "
                                                          "'Vol_MainPump.pressure > 250 bar'"}),
      field<&SwitchedDef::hysteresis>("hysteresis", {.doc = "distance from the threshold at which the output goes off, "
                                                            "a quantity as '5 bar'; without it 0"}),
      lent<&SwitchedDef::output, &SwitchedOutputDef::delay>(rows, "delay"),
      lent<&SwitchedDef::output, &SwitchedOutputDef::least_on>(rows, "least_on"),
      lent<&SwitchedDef::output, &SwitchedOutputDef::pulse_on>(rows, "pulse_on"),
      lent<&SwitchedDef::output, &SwitchedOutputDef::pulse_off>(rows, "pulse_off"),
  };
}

std::vector<Field> make_analog_fields() {
  using devices::AnalogOutputDef;
  const std::span<const Field> rows = devices::analog_output_fields();
  return {
      field<&AnalogDef::output, &AnalogOutputDef::variable>(
          "variable", {.presence = Presence::required, .doc = "variable of the session, as Vol_MainPump.pressure"}),
      field<&AnalogDef::low>("low", {.presence = Presence::required, .doc = "value at low_output, as '0 bar'"}),
      field<&AnalogDef::high>("high", {.presence = Presence::required, .doc = "value at high_output, as '300 bar'"}),
      lent<&AnalogDef::output, &AnalogOutputDef::low_output>(rows, "low_output"),
      lent<&AnalogDef::output, &AnalogOutputDef::high_output>(rows, "high_output"),
      lent<&AnalogDef::output, &AnalogOutputDef::smoothing>(rows, "smoothing"),
  };
}

// ---- quantities -----------------------------------------------------------------------------------------------

const char* const kAnyQuantity = "a quantity with its unit such as '250 bar', or a bare number in SI";

// A difference of the variable: degC has an offset, which a difference has not.
std::optional<AnyQuantity> read_difference(const std::string& path, const std::string& text, Problems& problems) {
  std::optional<AnyQuantity> difference = read_any_quantity(path, text, problems);
  if (!difference) return std::nullopt;
  UnitSystem units;
  const Unit* const unit = difference->unit.empty() ? nullptr : units.find(difference->unit);
  if ((unit != nullptr && unit->offset != 0) || difference->value < 0) {
    problems.push_back({path, fmt::format("'{}' is no distance", text), "at least 0, in a unit as K or bar", ""});
    return std::nullopt;
  }
  return difference;
}

// ---- inputs ---------------------------------------------------------------------------------------------------

class InputUse {
 public:
  InputUse(std::span<const InputDef> inputs, Problems& problems) : inputs_(inputs), problems_(problems) {}

  void use(const std::string& path, const std::string& device, const InputDef& input) {
    if (input.controller == ControllerMode::lockstep) {
      problems_.push_back({path,
                           fmt::format("input {} waits for a controller in step, and a device is not", input.name),
                           fmt::format("{}.controller: sampled", input.name), ""});
    }
    const auto [user, is_new] = users_.emplace(input.name, device);
    if (is_new) return;
    problems_.push_back({path, fmt::format("input {} is moved by {} already", input.name, user->second),
                         "one device for an input, once", ""});
  }

  void use_channel(const std::string& path, const JoystickDef& stick, std::int64_t channel, InputType type) {
    const auto is_there = [&](const InputDef& input) {
      return input.block == stick.block && input.type == type && input.channel == channel;
    };
    const auto found = std::find_if(inputs_.begin(), inputs_.end(), is_there);
    if (found != inputs_.end()) return use(path, stick.name, *found);
    const char* const kind = type == InputType::analog ? "analog" : "digital";
    std::string others;
    for (const InputDef& input : inputs_) {
      if (input.block != stick.block || input.type != type) continue;
      others += fmt::format("{}{} ({})", others.empty() ? "" : ", ", input.channel, input.name);
    }
    problems_.push_back({path, fmt::format("no {} input has block {} and channel {}", kind, stick.block, channel),
                         others.empty() ? fmt::format("a {} input of block {}", kind, stick.block) : others, ""});
  }

  [[nodiscard]] const InputDef* find(const std::string& name) const {
    const auto found = std::find_if(inputs_.begin(), inputs_.end(), [&](const InputDef& i) { return i.name == name; });
    return found == inputs_.end() ? nullptr : &*found;
  }

 private:
  std::span<const InputDef> inputs_;
  Problems& problems_;
  std::map<std::string, std::string> users_;
};

// ---- devices --------------------------------------------------------------------------------------------------

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

void read_enable(const std::string& name, devices::EnableChainDef& enable, double timeout, Problems& problems) {
  enable.name = name;
  enable.devices = {name};
  enable.device_timeout = timeout;
  if (enable.dead_man.empty() && !enable.conditions.empty()) {
    problems.push_back({name + ".conditions", "conditions enable nothing without a dead-man input", "dead_man", ""});
  }
  if (enable.conditions.size() > kMaxConditions) {
    problems.push_back({name + ".conditions", fmt::format("there are {} conditions", enable.conditions.size()),
                        fmt::format("at most {}", kMaxConditions), ""});
  }
  for (const std::string& condition : enable.conditions)
    static_cast<void>(read_condition(name + ".conditions", condition, problems));
}

void read_joystick(JoystickDef& def, InputUse& use, Problems& problems) {
  def.stick.name = def.name;
  // events come when something moves: a stick that is there is fresh
  read_enable(def.name, def.enable, devices::EnableChainDef().device_timeout, problems);
  if (def.path.empty() == def.match.empty()) {
    problems.push_back({def.name, "the device is not identified, or twice", "one of path and match", ""});
  }
  const std::size_t before = problems.size();
  validate(def.stick, problems);
  if (!def.enable.dead_man.empty() && !devices::button_code(def.enable.dead_man)) {
    problems.push_back({def.name + ".dead_man", fmt::format("there is no button '{}'", def.enable.dead_man),
                        "a name of the kernel, as BTN_THUMB", closest(def.enable.dead_man, devices::button_names())});
  }
  if (problems.size() > before) return;
  for (const devices::AxisDef& axis : def.stick.axes)
    use.use_channel(fmt::format("{}.axes.{}.channel", def.name, axis.code), def, axis.channel, InputType::analog);
  for (const devices::ButtonDef& button : def.stick.buttons)
    use.use_channel(fmt::format("{}.buttons.{}.channel", def.name, button.code), def, button.channel,
                    InputType::digital);
}

// Problems of the layout; without any, the layout.
std::optional<devices::ByteLayout> read_layout(const std::string& name, devices::LayoutDef& def, Problems& problems) {
  def.name = name;
  const std::size_t before = problems.size();
  validate(def, problems);
  if (problems.size() > before) return std::nullopt;
  return build(def);
}

bool check_address(const std::string& path, const std::string& text, Problems& problems) {
  if (devices::parse_udp_address(text)) return true;
  problems.push_back({path, fmt::format("'{}' is no address", text), "IPv4 address and port, as 127.0.0.1:5005", ""});
  return false;
}

void read_udp_in(UdpInDef& def, InputUse& use, Problems& problems) {
  const bool has_address = check_address(def.name + ".listen", def.listen, problems);
  for (const std::string& host : def.from) {
    if (devices::parse_host(host)) continue;
    problems.push_back({def.name + ".from", fmt::format("'{}' is no address", host), "IPv4, as 127.0.0.1", ""});
  }
  if (def.from.empty()) {
    problems.push_back({def.name + ".from", "every packet would be refused", "addresses of the senders", ""});
  }
  read_enable(def.name, def.enable, def.timeout, problems);
  const auto layout = read_layout(def.name, def.layout, problems);
  if (!layout || !has_address) return;
  bool has_input = false, has_dead_man = def.enable.dead_man.empty();
  for (const devices::PlacedField& placed : layout->fields) {
    const devices::LayoutFieldDef& f = placed.def;
    const std::string path = fmt::format("{}.{}", def.name, f.name);
    if (!f.variable.empty() || !f.output.empty()) {
      problems.push_back({path, "a received field takes nothing from the session", "input", ""});
    }
    has_dead_man = has_dead_man || (placed.has_value && f.name == def.enable.dead_man);
    if (f.input.empty()) continue;
    has_input = true;
    if (!placed.has_value) {
      problems.push_back({path + ".input", "a sequence, a checksum or a divided integer has no value", "no input", ""});
    } else if (const InputDef* const input = use.find(f.input)) {
      use.use(path + ".input", def.name, *input);
    }
  }
  if (!has_input) problems.push_back({def.name, "the device moves nothing", "a field with an input", ""});
  if (!has_dead_man) {
    problems.push_back({def.name + ".dead_man", fmt::format("there is no field '{}'", def.enable.dead_man),
                        "a field of the layout that has a value", ""});
  }
}

void read_udp_out(UdpOutDef& def, Problems& problems) {
  check_address(def.name + ".send", def.send, problems);
  const auto layout = read_layout(def.name, def.layout, problems);
  if (!layout) return;
  bool shows_something = false;
  for (const devices::PlacedField& placed : layout->fields) {
    const devices::LayoutFieldDef& f = placed.def;
    const std::string path = fmt::format("{}.{}", def.name, f.name);
    const bool is_used = !f.variable.empty() || !f.output.empty();
    shows_something = shows_something || is_used;
    if (!f.input.empty()) problems.push_back({path + ".input", "a sent field moves nothing", "variable or output", ""});
    if (!f.variable.empty() && !f.output.empty()) {
      problems.push_back({path, "the field has two sources", "variable or output", ""});
    }
    if (is_used && !placed.has_value) {
      problems.push_back(
          {path, "a sequence, a checksum or a divided integer has no value", "no variable or output", ""});
    }
  }
  if (!shows_something) {
    problems.push_back({def.name, "the device shows nothing", "a field with a variable or an output", ""});
  }
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

void check_listeners(const DevicesDef& devices, Problems& problems) {
  std::map<std::string, std::string> users;
  for (const UdpInDef& device : devices.udp_ins) {
    const auto [first, is_new] = users.emplace(device.listen, device.name);
    if (is_new) continue;
    problems.push_back({device.name + ".listen", fmt::format("{} is taken by {}", device.listen, first->second),
                        "an address or a port of its own", ""});
  }
}

}  // namespace

std::vector<std::string> DevicesDef::names() const {
  std::vector<std::string> names;
  for (const JoystickDef& device : joysticks) names.push_back(device.name);
  for (const UdpInDef& device : udp_ins) names.push_back(device.name);
  for (const UdpOutDef& device : udp_outs) names.push_back(device.name);
  for (const CanInDef& device : can_ins) names.push_back(device.name);
  for (const CanOutDef& device : can_outs) names.push_back(device.name);
  return names;
}

std::span<const Field> joystick_fields() {
  static const std::vector<Field> fields = make_joystick_fields();
  return fields;
}
std::span<const Field> udp_in_fields() {
  static const std::vector<Field> fields = make_udp_in_fields();
  return fields;
}
std::span<const Field> udp_out_fields() {
  static const std::vector<Field> fields = make_udp_out_fields();
  return fields;
}
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
std::span<const Field> switched_fields() {
  static const std::vector<Field> fields = make_switched_fields();
  return fields;
}
std::span<const Field> analog_fields() {
  static const std::vector<Field> fields = make_analog_fields();
  return fields;
}

std::optional<AnyQuantity> read_any_quantity(std::string_view path, std::string_view text, Problems& problems) {
  const NumberText number = split_number(text);
  if (!number.is_number) {
    problems.push_back({std::string(path),
                        number.problem.what.empty() ? fmt::format("'{}' is no quantity", text) : number.problem.what,
                        number.problem.expected.empty() ? kAnyQuantity : number.problem.expected, ""});
    return std::nullopt;
  }
  AnyQuantity quantity{static_cast<double>(number.value), std::string(number.rest)};
  if (!quantity.unit.empty()) {
    UnitSystem units;
    const Unit* const unit = units.find(quantity.unit);
    if (unit == nullptr) {
      problems.push_back({std::string(path), fmt::format("there is no unit '{}'", quantity.unit), kAnyQuantity, ""});
      return std::nullopt;
    }
    quantity.value = static_cast<double>(number.value * unit->scale + unit->offset);
  }
  if (std::isfinite(quantity.value)) return quantity;
  problems.push_back({std::string(path), fmt::format("'{}' is beyond what a number can hold", text), kAnyQuantity, ""});
  return std::nullopt;
}

std::optional<Condition> read_condition(std::string_view path, std::string_view text, Problems& problems) {
  const auto parts = devices::parse_condition(path, text, problems);
  if (!parts) return std::nullopt;
  const auto threshold = read_any_quantity(path, parts->quantity, problems);
  if (!threshold) return std::nullopt;
  return Condition{parts->variable, parts->comparison, *threshold};
}

bool is_same_dimension(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty()) return true;
  UnitSystem units;
  // the nodes' "1" is no text of UDUNITS' own
  const auto find = [&](const std::string& text) { return text == "1" ? Unit() : *units.find(text); };
  for (const std::string& text : {a, b}) {
    if (text != "1" && units.find(text) == nullptr) return false;
  }
  const Unit of_a = find(a), of_b = find(b);
  return of_a.exponent == of_b.exponent && !of_a.has_other_base && !of_b.has_other_base;
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

void read_outputs(OutputsDef& outputs, Problems& problems) {
  for (SwitchedDef& def : outputs.switched) {
    def.output.name = def.name;
    if (const auto condition = read_condition(def.name + ".condition", def.condition, problems)) {
      def.output.variable = condition->variable;
      def.output.comparison = condition->comparison;
      def.output.threshold = condition->threshold.value;
      if (def.hysteresis.empty()) {
        def.output.hysteresis = 0;
      } else if (const auto distance = read_difference(def.name + ".hysteresis", def.hysteresis, problems)) {
        def.output.hysteresis = distance->value;
        if (!is_same_dimension(distance->unit, condition->threshold.unit)) {
          problems.push_back(
              {def.name + ".hysteresis",
               fmt::format("'{}' is no distance from a threshold in {}", def.hysteresis, condition->threshold.unit),
               "a quantity of the same dimension", ""});
        }
      }
    }
    validate(def.output, problems);
  }
  for (AnalogDef& def : outputs.analog) {
    def.output.name = def.name;
    const auto low = read_any_quantity(def.name + ".low", def.low, problems);
    const auto high = read_any_quantity(def.name + ".high", def.high, problems);
    if (!low || !high) continue;
    def.output.low = low->value;
    def.output.high = high->value;
    if (!is_same_dimension(low->unit, high->unit)) {
      problems.push_back({def.name + ".high", fmt::format("'{}' and '{}' differ in dimension", def.low, def.high),
                          "two quantities of the variable", ""});
    }
    validate(def.output, problems);
  }
}

void read_devices(DevicesDef& devices, std::span<const InputDef> inputs, Problems& problems) {
  InputUse use(inputs, problems);
  for (JoystickDef& device : devices.joysticks) read_joystick(device, use, problems);
  for (UdpInDef& device : devices.udp_ins) read_udp_in(device, use, problems);
  for (UdpOutDef& device : devices.udp_outs) read_udp_out(device, problems);
  for (CanInDef& device : devices.can_ins) read_can_in(device, use, problems);
  for (CanOutDef& device : devices.can_outs) read_can_out(device, problems);
  check_listeners(devices, problems);
  const std::vector<std::string> names = devices.names();
  if (names.size() <= kMaxDevices) return;
  problems.push_back({names[kMaxDevices], fmt::format("there are {} devices", names.size()),
                      fmt::format("at most {}", kMaxDevices), ""});
}

std::vector<NamedVariable> variables_of(const DevicesDef& devices, const OutputsDef& outputs) {
  std::vector<NamedVariable> all;
  const auto add_conditions = [&](const devices::EnableChainDef& enable) {
    Problems ignored;
    for (const std::string& text : enable.conditions) {
      if (const auto condition = read_condition("", text, ignored))
        all.push_back({enable.name + ".conditions", condition->variable, condition->threshold.unit});
    }
  };
  for (const JoystickDef& device : devices.joysticks) add_conditions(device.enable);
  for (const UdpInDef& device : devices.udp_ins) add_conditions(device.enable);
  for (const CanInDef& device : devices.can_ins) add_conditions(device.enable);
  for (const CanOutDef& device : devices.can_outs) {
    for (const CanSignalDef& signal : device.bus.signals) {
      if (!signal.variable.empty())
        all.push_back({fmt::format("{}.signals.{}", device.name, signal.signal), signal.variable});
    }
  }
  for (const UdpOutDef& device : devices.udp_outs) {
    for (const devices::LayoutFieldDef& f : device.layout.fields) {
      if (!f.variable.empty()) all.push_back({fmt::format("{}.{}.variable", device.name, f.name), f.variable});
    }
  }
  Problems ignored;
  for (const SwitchedDef& output : outputs.switched) {
    const auto condition = read_condition("", output.condition, ignored);
    all.push_back({output.name + ".condition", output.output.variable, condition ? condition->threshold.unit : ""});
  }
  for (const AnalogDef& output : outputs.analog) {
    const auto high = read_any_quantity("", output.high, ignored);
    all.push_back({output.name + ".variable", output.output.variable, high ? high->unit : ""});
  }
  return all;
}

}  // namespace slew::scene
