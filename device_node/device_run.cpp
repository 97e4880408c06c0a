#include "device_node/device_run.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "core/display.h"
#include "core/failure.h"
#include "core/printable.h"
#include "core/suggestion.h"
#include "device_node/input_driver.h"
#include "device_node/shown_device.h"
#include "devices/packet.h"
#include "node/driver.h"
#include "node/open_transport.h"
#include "observer/observer.h"
#include "scene/scene.h"

namespace slew::device_node {
namespace {

constexpr SimDuration kLongestRound = milliseconds(20);
constexpr int kInputRoundMs = 1;  // with an input device: blocks of variables are taken this late at most
constexpr SimDuration kLongestRepeat = milliseconds(50);
constexpr std::int64_t kAliveIntervalNs = 500'000'000;
constexpr SimDuration kDirectoryTime = milliseconds(30'000);

template <typename Defs>
auto find_named(const Defs& defs, const std::string& name) -> decltype(&defs.front()) {
  const auto found = std::find_if(defs.begin(), defs.end(), [&](const auto& def) { return def.name == name; });
  return found == defs.end() ? nullptr : &*found;
}

class DeviceRun final : public observer::Receiver {
 public:
  DeviceRun(const DeviceOptions& options, const std::function<void(const std::string&)>& report)
      : options_(options), report_(report) {}

  Json run() {
    join();
    const scene::Scene scene = read_scene();
    check_variables(scene);
    open(scene);
    while (!is_over() && !observer_->is_stopped()) do_round();
    const bool has_session = !is_over();
    if (driver_ && has_session) driver_->release(observer_->view().step(), monotonic_ns());
    report_notices();
    return summary();
  }

  // ---- messages of the session
  void take_directory(const wire::VariableDirectory& directory) override {
    directories_.push_back(directory);
    if (driver_) driver_->take(directory);
    if (shown_) shown_->feed().take(directory);
  }
  void take_block(const wire::VariableBlock& block, std::span<const std::byte>, double time) override {
    if (driver_) driver_->take(block, monotonic_ns());
    if (shown_) shown_->feed().take(block, time);
  }
  void take_lease(const wire::ControllerLease& lease) override {
    if (driver_) driver_->take(lease);
  }

 private:
  [[nodiscard]] bool is_over() const { return observer_->view().is_over(); }

  void show_alive() {
    if (!options_.is_supervised || monotonic_ns() < next_alive_ns_) return;
    next_alive_ns_ = monotonic_ns() + kAliveIntervalNs;
    report_(std::string(kAliveLine));
  }

  // True when `done` within the time; signs of life go on meanwhile.
  template <typename Done>
  bool wait_for(const Done& done, SimDuration at_most) {
    const std::int64_t end_ns = monotonic_ns() + at_most.ns;
    while (!done()) {
      show_alive();
      if (observer_->is_stopped() || monotonic_ns() > end_ns) return false;
      observer_->wait_for(done, kLongestRound);
    }
    return true;
  }

  void stop_if_requested() const {
    if (const int stop = node::stop_requested.load(); stop != 0)
      throw Failure(static_cast<ExitCode>(stop), "interrupted before the device took part");
  }

  void join() {
    observer_ = std::make_unique<observer::Observer>(node::open_transport(wire::Role::controller, options_.session),
                                                     observer::ObserverOptions{.session = options_.session.session,
                                                                               .choice = observer::Choice::first,
                                                                               .receiver = this,
                                                                               .stop = &node::stop_requested});
    const SimDuration longest = duration_of_seconds(options_.session_timeout);
    const auto is_found = [&] {
      return observer_->view().has_session() && !observer_->view().session().scene_text.empty();
    };
    if (wait_for(is_found, longest)) return;
    stop_if_requested();
    throw Failure(ExitCode::failed,
                  fmt::format("no session '{}' was found within {}; the device was not started; start "
                              "it first, and compare its name, --domain, --interface, --peer and "
                              "--keys",
                              options_.session.session, seconds_text(longest)));
  }

  [[nodiscard]] scene::Scene read_scene() const {
    const wire::SessionDescription& session = observer_->view().session();
    scene::Scene scene = scene::load_text(session.scene_text, session.scene_name);
    if (!options_.file.empty()) scene = with_devices(scene, options_.file);
    return scene;
  }

  void open(const scene::Scene& scene) {
    const Reach reach = options_.is_insecure ? Reach::network : Reach::this_machine;
    const std::string& name = options_.device;
    if (const auto* stick = find_named(scene.devices.joysticks, name)) {
      drive(scene, open_joystick(*stick, scene.inputs), stick->enable);
      type_ = "joystick";
    } else if (const auto* rig = find_named(scene.devices.udp_ins, name)) {
      drive(scene, open_udp_in(*rig, reach), rig->enable);
      type_ = "udp_in";
    } else if (const auto* dash = find_named(scene.devices.udp_outs, name)) {
      shown_ = open_udp_out(*dash, scene.outputs, reach);
      type_ = "udp_out";
    } else if (const auto* panel = find_named(scene.devices.can_ins, name)) {
      drive(scene, open_can_in(*panel), panel->enable);
      type_ = "can_in";
    } else if (const auto* cluster = find_named(scene.devices.can_outs, name)) {
      shown_ = open_can_out(*cluster, scene.outputs);
      type_ = "can_out";
    } else {
      refuse_name(scene);
    }
    for (const wire::VariableDirectory& directory : directories_) {
      if (driver_) driver_->take(directory);
      if (shown_) shown_->feed().take(directory);
    }
  }

  [[noreturn]] void refuse_name(const scene::Scene& scene) const {
    const std::vector<std::string> names = scene.devices.names();
    const std::string meant = closest(options_.device, {names.begin(), names.end()});
    std::string all;
    for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
    throw Failure(ExitCode::bad_input,
                  fmt::format("{} has no device '{}'; nothing was started; {}",
                              options_.file.empty() ? "the scene of the session" : options_.file, options_.device,
                              !meant.empty() ? fmt::format("did you mean '{}'?", meant)
                              : all.empty()  ? "add a section 'devices', or name a file with --devices"
                                             : "devices: " + all));
  }

  void drive(const scene::Scene& scene, std::unique_ptr<InputDevice> device, const devices::EnableChainDef& enable) {
    device_ = std::move(device);
    const SimDuration timeout = duration_of_seconds(scene.session.controller_timeout);
    const SimDuration repeat{std::min(kLongestRepeat.ns, timeout.ns / 4)};
    driver_.emplace(options_.device, device_->inputs(), enable, repeat, [this](const wire::ControllerInput& input) {
      wire::ControllerInput message = input;
      message.session = options_.session.session;
      if (!observer_->send(message).is_ok()) ++unsent_inputs_;
    });
  }

  // Names and units of all variables that the device needs; only their nodes have them.
  void check_variables(const scene::Scene& scene) {
    scene::DevicesDef own;
    scene::OutputsDef outputs;
    if (const auto* stick = find_named(scene.devices.joysticks, options_.device)) own.joysticks = {*stick};
    if (const auto* rig = find_named(scene.devices.udp_ins, options_.device)) own.udp_ins = {*rig};
    if (const auto* panel = find_named(scene.devices.can_ins, options_.device)) own.can_ins = {*panel};
    const auto add_output = [&](const std::string& name) {
      if (const auto* lamp = find_named(scene.outputs.switched, name)) outputs.switched.push_back(*lamp);
      if (const auto* gauge = find_named(scene.outputs.analog, name)) outputs.analog.push_back(*gauge);
    };
    if (const auto* dash = find_named(scene.devices.udp_outs, options_.device)) {
      own.udp_outs = {*dash};
      for (const devices::LayoutFieldDef& f : dash->layout.fields) add_output(f.output);
    }
    if (const auto* cluster = find_named(scene.devices.can_outs, options_.device)) {
      own.can_outs = {*cluster};
      for (const scene::CanSignalDef& signal : cluster->bus.signals) add_output(signal.output);
    }
    const std::vector<scene::NamedVariable> needed = variables_of(own, outputs);
    if (needed.empty()) return;
    const auto has_names = [&] { return observer_->view().has_whole_directory() || is_over(); };
    if (!wait_for(has_names, kDirectoryTime)) {
      stop_if_requested();
      throw Failure(ExitCode::failed,
                    "the session has not published the names of its variables within 30 s; the device "
                    "was not started; see 'slewring sessions'");
    }
    if (is_over()) return;
    for (const scene::NamedVariable& one : needed) {
      const observer::VariableView* const found = observer_->view().find(one.variable);
      if (found == nullptr) refuse_variable(one);
      if (scene::is_same_dimension(one.unit, found->unit)) continue;
      throw Failure(ExitCode::bad_input,
                    fmt::format("{}: '{}' is in {}, not in {}; the device was not started; state a "
                                "quantity of the same dimension",
                                one.path, one.variable, found->unit, one.unit));
    }
  }

  [[noreturn]] void refuse_variable(const scene::NamedVariable& one) const {
    std::vector<std::string_view> names;
    for (const observer::VariableView* variable : observer_->view().variables()) names.emplace_back(variable->name);
    const std::string meant = closest(one.variable, names);
    throw Failure(ExitCode::bad_input,
                  fmt::format("{}: the session publishes no variable '{}'; the device was not started; {}", one.path,
                              one.variable,
                              meant.empty() ? "'slewring variables SCENE' lists them, and recording.variables chooses "
                                              "among them"
                                            : fmt::format("did you mean '{}'?", meant)));
  }

  void do_round() {
    if (shown_) {
      observer_->wait_for([&] { return is_over(); }, kLongestRound);
      shown_->look_after(monotonic_ns());
    } else {
      pollfd request{device_->descriptor(), POLLIN, 0};
      ::poll(&request, request.fd >= 0 ? 1 : 0, kInputRoundMs);
      const std::int64_t now_ns = monotonic_ns();
      const bool is_running = observer_->view().session().header.phase == wire::Phase::running;
      // a recording begins with the session
      const bool is_new = (is_running || request.fd >= 0) && device_->take(now_ns);
      if (is_running) driver_->drive(*device_, is_new, observer_->view().step(), now_ns);
      observer_->drain();
    }
    show_alive();
    report_notices();
  }

  void report_notices() {
    if (shown_) {
      for (const std::string& notice : shown_->take_notices()) report_(notice);
      return;
    }
    for (const std::string& notice : device_->take_notices()) report_(notice);
    for (const std::string& notice : driver_->take_notices()) report_(notice);
  }

  [[nodiscard]] Json summary() const {
    Json json = {{"device", options_.device}, {"type", type_}};
    if (shown_) json["packets"] = shown_->counts();
    if (device_) {
      json[type_ == "joystick" ? "events" : type_ == "can_in" ? "frames" : "packets"] = device_->counts();
      json["inputs"] = driver_->counts();
      json["inputs"]["unsent"] = unsent_inputs_;
    }
    return json;
  }

  const DeviceOptions& options_;
  const std::function<void(const std::string&)>& report_;
  std::unique_ptr<observer::Observer> observer_;
  std::string type_;
  std::unique_ptr<InputDevice> device_;
  std::optional<InputDriver> driver_;
  std::unique_ptr<ShownDevice> shown_;
  std::vector<wire::VariableDirectory> directories_;  // of the session, so far
  std::uint64_t unsent_inputs_ = 0;
  std::int64_t next_alive_ns_ = 0;
};

std::string counted_text(const Json& counts, std::string_view key, std::string_view what) {
  const Json* const number = counts.find(key);
  if (number == nullptr || !number->is_number() || number->integer() == 0) return "";
  return fmt::format(", {} {}", number->integer(), what);
}

}  // namespace

Json run_device(const DeviceOptions& options, const std::function<void(const std::string&)>& report) {
  return DeviceRun(options, report).run();
}

std::string summary_text(const Json& summary) {
  const Json* const packets = summary.find("packets");
  const Json* const inputs = summary.find("inputs");
  std::string text;
  if (inputs == nullptr && packets != nullptr) {
    text = fmt::format("{} packets sent", packets->at("sent").integer());
    text += counted_text(*packets, "unsent", "not taken by the system");
    text += counted_text(*packets, "not_finite", "not sent since a value was not finite");
    text += counted_text(*packets, "incomplete_steps", "steps incomplete");
    return text;
  }
  if (inputs == nullptr) return "";
  if (packets != nullptr) {
    text = fmt::format("{} packets used", packets->at("used").integer());
    text += counted_text(*packets, "lost", "lost");
    const Json& refused = packets->at("refused");
    text += counted_text(refused, kStrangerCause, "of senders that are not in from");
    for (std::size_t i = 1; i < static_cast<std::size_t>(devices::PacketFault::number_of_faults); ++i) {
      const std::string_view cause = text_of(static_cast<devices::PacketFault>(i));
      text += counted_text(refused, cause, fmt::format("refused: {}", cause));
    }
  } else if (const Json* const frames = summary.find("frames")) {
    text = fmt::format("{} frames used", frames->at("used").integer());
    text += counted_text(*frames, "too_short", "too short");
    text += counted_text(*frames, "other_identifiers", "of other identifiers");
    for (const char* state : {"not available", "error", "out of range", "not finite"})
      text += counted_text(frames->at("without_value"), state, std::string("values ") + state);
  } else {
    text = fmt::format("{} reports", summary.at("events").at("reports").integer());
    text += counted_text(summary.at("events"), "dropped", "times events dropped by the kernel");
  }
  text += fmt::format("; {} values written", inputs->at("written").integer());
  text += counted_text(*inputs, "without_lease", "without a lease");
  text += counted_text(*inputs, "unsent", "not sent");
  text += counted_text(*inputs, "silences", "times silent and at neutral");
  text += counted_text(*inputs, "enable_losses", "times disabled");
  const Json& latency = inputs->at("latency");
  if (latency.at("count").integer() == 0) return text;
  return text + fmt::format("; {} from an event to the first sample that used it, {} p99, {} max",
                            duration_text(latency.at("p50").number()), duration_text(latency.at("p99").number()),
                            duration_text(latency.at("max").number()));
}

}  // namespace slew::device_node
