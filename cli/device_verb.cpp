// SPDX-License-Identifier: Apache-2.0
// `slewring device list|monitor|calibrate|layout|run`: joysticks, packets and motion platforms, with and without a
// session.
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>

#include "cli/terminal.h"
#include "cli/verbs.h"
#include "core/failure.h"
#include "core/json.h"
#include "core/printable.h"
#include "core/report_table.h"
#include "core/suggestion.h"
#include "core/text_output.h"
#include "device_node/device_options.h"
#include "device_node/event_source.h"
#include "device_node/input_device.h"
#include "devices/layout_header.h"
#include "node/driver.h"
#include "program/add_scene_options.h"
#include "scene/recorded_files.h"
#include "scene/scene.h"
#include "scene/scene_options.h"
#include "session/survey.h"

namespace slew::cli {
namespace {

using device_node::EventSource;
using device_node::InputDevice;

constexpr int kRoundMs = 5;

struct DeviceOptions {
  std::string scene, device;
  std::string output = "-";
  double duration = 0;  // s; 0: until Ctrl-C
  double every = 0.1;   // s
  std::optional<double> ends_time;
  bool is_simulink = false;
  bool is_insecure = false;
  bool is_json = false;
  device_node::DeviceOptions run;
};

void print_line(const std::string& line) {
  fmt::print("{}\n", printable(line));
  std::fflush(stdout);
}

ExitCode stop_code() {
  return static_cast<ExitCode>(node::stop_requested.load());
}

// ---- list -----------------------------------------------------------------------------------------------------

struct Row {
  std::string name, type, detail;
};

std::vector<Row> devices_of(const scene::Scene& scene) {
  std::vector<Row> rows;
  for (const scene::JoystickDef& device : scene.devices.joysticks)
    rows.push_back({device.name, "joystick", device.path.empty() ? "named '" + device.match + "'" : device.path});
  for (const scene::UdpInDef& device : scene.devices.udp_ins)
    rows.push_back({device.name, "udp_in", "listens on " + device.listen});
  for (const scene::UdpOutDef& device : scene.devices.udp_outs)
    rows.push_back({device.name, "udp_out", "sends to " + device.send});
  for (const scene::CanInDef& device : scene.devices.can_ins)
    rows.push_back({device.name, "can_in", device.bus.interface.empty() ? device.path : device.bus.interface});
  for (const scene::CanOutDef& device : scene.devices.can_outs)
    rows.push_back({device.name, "can_out", device.bus.interface});
  for (const scene::MotionPlatformDef& device : scene.devices.platforms)
    rows.push_back({device.name, "motion_platform", device.body + ", sends to " + device.send});
  return rows;
}

ExitCode list(const DeviceOptions& options) {
  std::vector<Row> rows;
  if (!options.scene.empty()) rows = devices_of(scene::load_file(options.scene));
  if (options.scene.empty()) {
    for (const device_node::FoundDevice& device : device_node::find_input_devices())
      rows.push_back({device.path, "input", device.obstacle.empty() ? device.name : device.obstacle});
  }
  if (options.is_json) {
    Json all = Json::array();
    for (const Row& row : rows) all.push_back({{"name", row.name}, {"type", row.type}, {"detail", row.detail}});
    fmt::print("{}\n", all.dump(2));
    return ExitCode::ok;
  }
  if (rows.empty()) {
    print_line(options.scene.empty() ? "no input devices: /dev/input has none, or this user may not see them"
                                     : "the scene has no devices");
    return ExitCode::ok;
  }
  ReportTable table({"device", "type", ""});
  for (const Row& row : rows) table.add({row.name, row.type, row.detail});
  print_table(table);
  return ExitCode::ok;
}

// ---- monitor --------------------------------------------------------------------------------------------------

std::unique_ptr<EventSource> open_now(const std::string& path) {
  std::string reason;
  auto source = device_node::open_events(path, reason);
  if (source == nullptr) {
    throw Failure(ExitCode::bad_input,
                  reason + "; nothing was read; 'slewring device list' shows the devices of this machine");
  }
  return source;
}

// All that a source has, with the ranges that it states; channels count up.
devices::StickDef whole_stick(const EventSource& source) {
  devices::StickDef def{.name = "Device"};
  for (const devices::AxisRange& range : source.axes()) {
    if (range.minimum >= range.maximum) continue;
    const std::int64_t centre = (std::int64_t{range.minimum} + range.maximum) / 2;
    def.axes.push_back({.code = range.code,
                        .channel = static_cast<std::int64_t>(def.axes.size()),
                        .lowest = range.minimum,
                        .centre = centre,
                        .highest = range.maximum});
  }
  // channels of a block are 64; a keyboard has more keys
  for (const std::string& button : source.buttons()) {
    const auto channel = static_cast<std::int64_t>(def.axes.size() + def.buttons.size());
    if (channel > 63 || !devices::button_code(button)) continue;
    def.buttons.push_back({.code = button, .channel = channel});
  }
  if (def.axes.empty() && def.buttons.empty()) {
    throw Failure(ExitCode::bad_input,
                  "the device has neither axes nor buttons; nothing was read; choose another of "
                  "'slewring device list'");
  }
  return def;
}

// A scene that has the device's inputs, for a device without one.
std::unique_ptr<InputDevice> open_path(const std::string& path) {
  const auto source = open_now(path);
  scene::JoystickDef def;
  def.name = "Device";
  def.path = path;
  def.stick = whole_stick(*source);
  std::vector<scene::InputDef> inputs;
  const auto add = [&](scene::InputType type, std::int64_t channel) {
    scene::InputDef& input = inputs.emplace_back();
    input.type = type;
    input.channel = channel;
  };
  for (const devices::AxisDef& axis : def.stick.axes) add(scene::InputType::analog, axis.channel);
  for (const devices::ButtonDef& button : def.stick.buttons) add(scene::InputType::digital, button.channel);
  return device_node::open_joystick(def, inputs);
}

template <typename Def>
const Def* find_device(const std::vector<Def>& defs, const std::string& name) {
  const auto found = std::find_if(defs.begin(), defs.end(), [&](const Def& def) { return def.name == name; });
  return found == defs.end() ? nullptr : &*found;
}

[[noreturn]] void refuse_device(const scene::Scene& scene, const std::string& name, const char* kinds) {
  const std::vector<std::string> names = scene.devices.names();
  const std::string meant = closest(name, {names.begin(), names.end()});
  throw Failure(ExitCode::bad_input,
                fmt::format("the scene has no {} '{}'; nothing was done; {}", kinds, name,
                            meant.empty() || meant == name ? "'slewring device list SCENE' shows its devices"
                                                           : fmt::format("did you mean '{}'?", meant)));
}

// The receiver of what a device sends, in the place of the other side.
std::unique_ptr<InputDevice> open_receiver(const std::string& name, const std::string& address,
                                           const devices::LayoutDef& layout, device_node::Reach reach) {
  scene::UdpInDef def{.name = name, .listen = address, .layout = layout, .enable = {}};
  def.layout.most_lost = 1'000'000;  // as many as a layout may have: gaps are shown, not refused
  return device_node::open_udp_in(def, reach);
}

std::unique_ptr<InputDevice> open_of_scene(const DeviceOptions& options) {
  scene::Scene scene = scene::load_file(options.scene);
  place_recorded_files(scene.devices, std::filesystem::path(options.scene).parent_path().string());
  if (const auto* stick = find_device(scene.devices.joysticks, options.device))
    return device_node::open_joystick(*stick, scene.inputs);
  const auto reach = options.is_insecure ? device_node::Reach::network : device_node::Reach::this_machine;
  if (const auto* rig = find_device(scene.devices.udp_ins, options.device))
    return device_node::open_udp_in(*rig, reach);
  if (const auto* panel = find_device(scene.devices.can_ins, options.device))
    return device_node::open_can_in(*panel, device_node::BusPart::listens);
  if (const auto* dash = find_device(scene.devices.udp_outs, options.device))
    return open_receiver(dash->name, dash->send, dash->layout, reach);
  if (const auto* seat = find_device(scene.devices.platforms, options.device))
    return open_receiver(seat->name, seat->send, seat->layout, reach);
  refuse_device(scene, options.device, "joystick, udp_in, udp_out, can_in or motion_platform");
}

ExitCode monitor(const DeviceOptions& options) {
  node::install_signal_handlers();
  const auto device = options.scene.empty() ? open_path(options.device) : open_of_scene(options);
  const std::int64_t end_ns =
      options.duration > 0 ? monotonic_ns() + duration_of_seconds(options.duration).ns : INT64_MAX;
  std::string shown;
  std::int64_t next_ns = 0;
  while (node::stop_requested.load() == 0 && monotonic_ns() < end_ns) {
    pollfd request{device->descriptor(), POLLIN, 0};
    ::poll(&request, request.fd >= 0 ? 1 : 0, kRoundMs);
    const std::int64_t now_ns = monotonic_ns();
    device->take(now_ns);
    for (const std::string& notice : device->take_notices()) print_line(notice);
    const std::string text = device->text();
    if (now_ns < next_ns || text == shown) continue;
    next_ns = now_ns + duration_of_seconds(options.every).ns;
    shown = text;
    print_line(text);
  }
  return stop_code();
}

// ---- calibrate ------------------------------------------------------------------------------------------------

// True for Enter. recorded: the motion comes from a file, which has an end of its own.
bool has_pressed_enter(bool is_recorded) {
  pollfd request{STDIN_FILENO, POLLIN, 0};
  if (::poll(&request, 1, 0) != 1) return false;
  char keys[64];
  const ssize_t got = read(STDIN_FILENO, keys, sizeof keys);
  if (got > 0) return true;
  if (is_recorded || (got < 0 && (errno == EINTR || errno == EAGAIN))) return false;
  throw Failure(ExitCode::bad_input,
                "standard input is at its end, and no Enter can come; nothing was written; calibrate in a terminal, or "
                "state the time for moving the axes with --ends-time");
}

void print_axes(const std::vector<devices::AxisDef>& axes) {
  print_line("axes:");
  for (const devices::AxisDef& axis : axes) {
    print_line(fmt::format("  - {{code: {}, channel: {}, lowest: {}, centre: {}, highest: {}, dead_zone: {:.3f}}}",
                           axis.code, axis.channel, axis.lowest, axis.centre, axis.highest, axis.dead_zone));
  }
}

// Problems of a phase as lines on standard error.
void print_problems(const Problems& problems) {
  for (const Problem& problem : problems) {
    std::fprintf(stderr, "%s: %s%s%s\n", problem.path.c_str(), problem.what.c_str(),
                 problem.expected.empty() ? "" : "; expected ", problem.expected.c_str());
  }
}

ExitCode calibrate(const DeviceOptions& options) {
  node::install_signal_handlers();
  const auto source = open_now(options.device);
  const devices::Stick stick = build_stick(whole_stick(*source));
  std::vector<devices::AxisRange> ranges;
  for (const devices::AxisDef& axis : stick.def.axes)
    ranges.push_back({axis.code, static_cast<std::int32_t>(axis.lowest), static_cast<std::int32_t>(axis.highest)});
  Problems problems;
  devices::Calibration calibration = begin_calibration({}, ranges, problems);
  if (!problems.empty() || ranges.empty()) {
    print_problems(problems);
    throw Failure(ExitCode::bad_input, "the device has no axis to calibrate; nothing was written");
  }
  devices::StickState state = initial_state(stick);
  connect(state);
  static_cast<void>(source->read_state(stick, state));
  const auto show = [](const char* text) { std::fprintf(stderr, "%s\n", text); };
  show("leave the device untouched");
  std::vector<devices::InputEvent> events;
  std::int64_t before_ns = monotonic_ns(), ends_ns = 0;
  auto shown = devices::CalibrationPhase::rest;
  while (calibration.phase != devices::CalibrationPhase::done) {
    if (node::stop_requested.load() != 0) return stop_code();
    pollfd request{source->descriptor(), POLLIN, 0};
    ::poll(&request, request.fd >= 0 ? 1 : 0, kRoundMs);
    const std::int64_t now_ns = monotonic_ns();
    events.clear();
    // a recording that is over leaves its last state
    const bool is_over = !source->take(now_ns, events), is_recorded = source->descriptor() < 0;
    if (is_over && !is_recorded) {
      throw Failure(ExitCode::failed, "the device has left; nothing was written; connect it and begin again");
    }
    take_events(stick, state, events);
    if (state.phase == devices::StickPhase::awaiting_state) static_cast<void>(source->read_state(stick, state));
    // a recording has no counts before its first report
    if (is_recorded && state.reports == 0) {
      if (is_over) throw Failure(ExitCode::bad_input, "the recorded events have no whole report; nothing was written");
      before_ns = now_ns;
      continue;
    }
    add_counts(calibration, state.axes, static_cast<double>(now_ns - before_ns) * 1e-9);
    before_ns = now_ns;
    if (calibration.phase != shown) {
      shown = calibration.phase;
      if (shown == devices::CalibrationPhase::ends) {
        ends_ns = now_ns;
        show(options.ends_time || is_recorded ? "move every axis to its ends"
                                              : "move every axis to its ends, then press Enter");
      } else if (shown == devices::CalibrationPhase::rest_again) {
        show("leave the device untouched");
      }
    }
    if (calibration.phase != devices::CalibrationPhase::ends) continue;
    const bool is_time = options.ends_time ? now_ns - ends_ns >= duration_of_seconds(*options.ends_time).ns
                                           : has_pressed_enter(is_recorded);
    if (!is_time && !is_over) continue;
    problems.clear();
    end_of_ends(calibration, problems);
    print_problems(problems);
    if (!problems.empty() && (options.ends_time || is_over)) {
      throw Failure(ExitCode::bad_input, "not all axes were moved; nothing was written; begin again");
    }
  }
  print_axes(results(calibration));
  return ExitCode::ok;
}

// ---- layout and run -------------------------------------------------------------------------------------------

ExitCode write_layout(const DeviceOptions& options) {
  const scene::Scene scene = scene::load_file(options.scene);
  const devices::LayoutDef* def = nullptr;
  if (const auto* rig = find_device(scene.devices.udp_ins, options.device)) def = &rig->layout;
  if (const auto* dash = find_device(scene.devices.udp_outs, options.device)) def = &dash->layout;
  if (const auto* seat = find_device(scene.devices.platforms, options.device)) def = &seat->layout;
  if (def == nullptr) refuse_device(scene, options.device, "udp_in, udp_out or motion_platform");
  const devices::ByteLayout layout = build(*def);
  write_text(options.output, options.is_simulink ? simulink_note(layout) : c_header(layout));
  return ExitCode::ok;
}

ExitCode run_one(DeviceOptions options) {
  node::install_signal_handlers();
  if (options.run.session.session.empty()) {
    options.run.session.session = session::find_session(options.run.session, session::Access::look)->session_name();
  }
  options.run.device = options.device;
  const Json summary = device_node::run_device(options.run, [&](const std::string& line) {
    std::FILE* const out = options.is_json ? stderr : stdout;
    fmt::print(out, "{}\n", printable(line));
    std::fflush(out);
  });
  fmt::print("{}\n", options.is_json ? summary.dump(2) : device_node::summary_text(summary));
  return stop_code();
}

}  // namespace

void add_device(options::Command& program) {
  options::Command verb =
      program.command("device", "joysticks, packets and platforms of a scene, with and without a session");
  verb.require_command();
  const auto options = std::make_shared<DeviceOptions>();  // lives as long as the command line's callbacks

  options::Command listing = verb.command("list", "input devices of this machine, or the devices of a scene");
  program::add_scene_file(listing, "scene", options->scene);
  listing.flag("--json", options->is_json, "print JSON and nothing else");
  listing.footer("Examples:\n  slewring device list\n  slewring device list crane.yaml");
  listing.action([options] { return list(*options); });

  options::Command monitoring = verb.command("monitor", "print what a device gives, as it changes");
  monitoring
      .option(
          "device", options->device,
          "path of an input device or of recorded events; with --scene a name: what it receives, or what udp_out and "
          "motion_platform send to an address of this machine")
      .value_name("DEVICE")
      .required();
  program::add_scene_file(monitoring, "--scene", options->scene, "scene file with the device");
  monitoring.option("--duration", options->duration, "seconds; 0: until Ctrl-C").between(0.0, 1e9).value_name("S");
  monitoring.option("--every", options->every, "shortest time between two lines")
      .between(0.0, 60.0)
      .value_name("S")
      .show_default();
  monitoring.flag("--insecure-devices", options->is_insecure, "receive UDP from beyond this machine");
  monitoring.footer(
      "Examples:\n"
      "  slewring device monitor /dev/input/event5\n"
      "  slewring device monitor Rig --scene crane.yaml");
  monitoring.action([options] { return monitor(*options); });

  options::Command calibrating =
      verb.command("calibrate", "find centre, ends and dead zone of all axes; prints them for the scene");
  calibrating.option("device", options->device, "path of an input device or of recorded events")
      .value_name("PATH")
      .required();
  calibrating.option("--ends-time", options->ends_time, "seconds for moving the axes to their ends, in place of Enter")
      .between(0.1, 3600.0)
      .value_name("S");
  calibrating.footer("Example:\n  slewring device calibrate /dev/input/event5");
  calibrating.action([options] { return calibrate(*options); });

  options::Command layout = verb.command("layout", "write the C header of a device's packets, or a note for Simulink");
  program::add_scene_file(layout, "scene", options->scene).required();
  layout.option("device", options->device, "name of a udp_in, udp_out or motion_platform device")
      .value_name("DEVICE")
      .required();
  layout.flag("--simulink", options->is_simulink, "the parameters of Simulink's blocks in place of a C header");
  layout.option("-o,--output", options->output, "file; - is standard output").value_name("FILE").show_default();
  layout.footer(
      "Examples:\n"
      "  slewring device layout crane.yaml Rig -o rig.h\n"
      "  slewring device layout crane.yaml Rig --simulink -o rig.md");
  layout.action([options] { return write_layout(*options); });

  options::Command running = verb.command("run", "run one device against a session that runs already");
  running.option("device", options->device, "name of the device").value_name("DEVICE").required();
  device_node::add_device_options(running, options->run);
  running.find("--session").description("name of the session; without it the only one that runs");
  running.flag("--json", options->is_json, "print the counts at the end as JSON and nothing else");
  running.footer("Example:\n  slewring device run Rig --devices rig.yaml --session truck_crane");
  running.action([options] { return run_one(*options); });

  verb.footer(
      "'slewring run SCENE' starts the devices of its scene by itself.\n\n"
      "Examples:\n"
      "  slewring device list\n"
      "  slewring device calibrate /dev/input/event5\n"
      "  slewring device monitor Rig --scene crane.yaml\n"
      "  slewring device run Rig --devices rig.yaml --session truck_crane");
}

}  // namespace slew::cli
